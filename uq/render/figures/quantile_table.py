"""The table of quantiles of an output, and tables as files: CSV and LaTeX."""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from uq.assess.statistic import Statistic
from uq.assess.summary import Summary, summarise
from uq.files.whole_files import whole
from uq.render.figures.elements_plot import display_unit
from uq.render.figures.words import place_in_words
from uq.result.result import AnyResult, Result
from uq.stats.estimate import rounded_text
from uq.text.numbers import capitalized
from uq.text.units import readable

if TYPE_CHECKING:
    import pandas as pd

_SPECIAL = str.maketrans({sign: rf"\{sign}" for sign in "%&#_$"})


def quantile_table(
    result: AnyResult, output: str, *, summary: Summary | None = None
) -> "pd.DataFrame":
    """Return a table of the quantiles of an output, with their 95 % intervals, rounded.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result.
    output : str
        An output other than a category.
    summary : Summary, optional
        What `uq.assess.summary.summarise` returns, if already computed.

    Returns
    -------
    pandas.DataFrame
        One line per element and quantile, in text; the meaning and unit are in the heading.
    """
    import pandas as pd

    result = Result.of(result)
    chosen = result.independent.named_elements(output)
    outputs = (summary or summarise(result)).outputs
    by_element = [(each, outputs[each.name].parts["quantiles"]) for each in chosen]
    values = [
        statistic.estimate.finite.value for _, quantiles in by_element for statistic in quantiles
    ]
    unit = display_unit(chosen[0].units, np.array(values))
    in_unit = f" [{unit.name}]" if unit.name not in ("", "1") else ""
    meaning = f"{capitalized(readable(chosen[0].meaning))}{in_unit}"
    lines = [
        (place_in_words(result, element), *_quantile(statistic, unit.size))
        for element, quantiles in by_element
        for statistic in quantiles
    ]
    table = pd.DataFrame(lines, columns=["of", "quantile", meaning, "95 % interval"])
    return table if len(chosen) > 1 else table.drop(columns="of")


def _quantile(statistic: Statistic, per: float) -> tuple[str, str, str]:
    value, ends = rounded_text(statistic.estimate, per)
    value = value if np.isfinite(statistic.estimate.value) else statistic.words(per)
    return f"{100 * float(statistic.key[-1]):g} %", value, ends


def write_table(table: "pd.DataFrame", path: Path) -> list[Path]:
    """Write a table as CSV and as LaTeX, and return the paths.

    Parameters
    ----------
    table : pandas.DataFrame
    path : Path
        Path without a suffix.
    """
    texts = {"csv": table.to_csv(index=False), "tex": _latex(table)}
    files = [path.with_name(f"{path.name}.{end}") for end in texts]
    for file, text in zip(files, texts.values(), strict=True):
        with whole(file) as part:
            part.write_text(text, encoding="utf-8")
    return files


def _latex(table: "pd.DataFrame") -> str:
    r"""Return a table in LaTeX, for the package booktabs."""

    def line(cells: list[str]) -> str:
        return " & ".join(str(cell).translate(_SPECIAL) for cell in cells) + r" \\"

    rules = [rf"\{rule}rule" for rule in ("top", "mid", "bottom")]
    columns = f"@{{}}l{'r' * (len(table.columns) - 1)}@{{}}"
    body = [line(cells) for cells in table.to_numpy().tolist()]
    lines = [rules[0], line(list(table.columns)), rules[1], *body, rules[2]]
    return "\n".join([rf"\begin{{tabular}}{{{columns}}}", *lines, r"\end{tabular}", ""])
