"""Report of a result as one HTML file: its content, and the templates that lay it out."""

import csv
import io
import json
import re
import shlex
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

from markupsafe import Markup, escape

from uq.assess.answer.answer import conclude
from uq.assess.answer.answer_sentences import Answer
from uq.assess.card import card_of
from uq.assess.findings import Findings
from uq.assess.summary import REGIME
from uq.errors import InputError
from uq.files.whole_files import check_target, whole
from uq.render.html.answer import STYLE, fragment, regimes, warning
from uq.render.html.convergence import convergence_of, fleet_notes, fleet_table, levels_of
from uq.render.html.embedded_rows import rows_inside, why_no_rows
from uq.render.html.first_screen import first_screen
from uq.render.html.indices import of_output, sensitivity_of
from uq.render.html.inputs import fixed_inputs, input_tables
from uq.render.html.outcomes import groups, outcomes, regime_tables, status_table
from uq.render.html.pictures import Picture, pictures
from uq.result.result import Result
from uq.result.result_file import named, open_result
from uq.study.installed_models import find_model
from uq.study.provenance import provenance
from uq.text.literals import plain
from uq.text.numbers import capitalized, printed

_SHOWN_TEXT = 50_000
"""Maximum length of the study's text in a page [characters]: a study may contain data files."""


def laid_out(template: str, result: Result, **content: Any) -> str:
    """Return a page on a result as HTML.

    Parameters
    ----------
    template : str
        Name of a template that extends ``base.html``.
    result : Result
        A result.
    **content
        Content of this template besides title, style and study file.

    Returns
    -------
    str
    """
    text = result.dataset.attrs["study"]
    return (
        templates()
        .get_template(template)
        .render(
            attrs=result.dataset.attrs,
            study=result.study,
            text=text.expandtabs(4)[:_SHOWN_TEXT],
            text_is_cut=len(text) > _SHOWN_TEXT,
            answer_style=STYLE,
            **content,
        )
    )


@cache
def templates() -> Any:
    """Return jinja's environment of the templates beside this file."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("uq.render.html", ""),
        autoescape=True,
        finalize=lambda value: plain(value) if type(value) is str else value,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {
        "breakable": _breakable,
        "inside": _inside,
        "printed": _printed,
        "capitalized": capitalized,
        "quoted": shlex.quote,
        "warning": warning,
    }
    return environment


def _breakable(text: str) -> Markup:
    """Return text as printed, with line-break opportunities in long names."""
    return Markup(re.sub(r"([_,\[])(?=\S)", r"\1<wbr>", str(escape(plain(printed(text))))))


def _printed(text: str) -> str:
    return text if isinstance(text, Markup) else printed(text)


def _inside(content: Any) -> Markup:
    """Return plain data as JSON, escaped for embedding in HTML."""
    return Markup(json.dumps(content, allow_nan=False).replace("<", "\\u003c"))


def references(result: Result) -> tuple[str, ...] | None:
    """Return the references that the model asks to cite, or None if it is not installed."""
    try:
        return find_model(result.dataset.attrs["model"]).references
    except InputError:
        return None


def inspections_csv(result: Result) -> str:
    """Return the inspections in a result as CSV for `uq update`; "" if there are none."""
    inspections = json.loads(result.dataset.attrs.get("inspections", "[]"))
    if not inspections:
        return ""
    text = io.StringIO()
    columns = dict.fromkeys(name for inspection in inspections for name in inspection)
    lines = csv.DictWriter(text, list(columns), lineterminator="\n")
    lines.writeheader()
    lines.writerows(inspections)
    return text.getvalue()


_FIGURE = Markup("<figure{}>{}</figure>")  # the numbers beside it are its caption


def figure_of_subject(answer: Answer, drawn: list[Picture], by_regime: list[Picture]) -> Markup:
    """Return the figure of the subject of a study, and remove it from those drawn.

    Parameters
    ----------
    answer : Answer
    drawn : list of Picture
        The figures of the results.
    by_regime : list of Picture
        Figures of the rows by regime, used if the answer is about regimes.

    Returns
    -------
    Markup
        "" if there is none.
    """
    lead = answer.lead
    figures = [
        (drawn, figure) for figure in drawn if lead is not None and figure.subject == lead.output
    ]
    if answer.regimes_first:
        figures = [*((by_regime, figure) for figure in by_regime), *figures]
    if not figures:
        return Markup()
    among, shown = figures[0]
    among.remove(shown)
    kind = Markup(' class="image"') if shown.is_image else Markup()
    return _FIGURE.format(kind, shown.html)


def write_report(
    result: str | Path,
    path: str | Path,
    lay_out: Callable[[Result, str], str] | None = None,
) -> None:
    """Write the report of a result as one self-contained HTML file.

    Parameters
    ----------
    result : path-like
    path : path-like
        Written completely or not at all.
    lay_out : callable, optional
        Result, name of its file -> HTML: `page`, the default, or
        `uq.render.html.dossier.chapters.dossier`.

    Raises
    ------
    InputError
        When the result cannot be read or the report cannot be written.
    """
    result, path = Path(result), Path(path)
    opened = Result(named(open_result(result), result.name))
    check_target(path, 0)
    if path.exists() and path.samefile(result):
        raise InputError(f"{path}: is the result itself; give the report another name")
    text = (lay_out or page)(opened, result.name)
    with whole(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def page(result: Result, name: str) -> str:
    """Return the report of a result as HTML; the text is reproducible.

    Parameters
    ----------
    result : Result
        A result.
    name : str
        The name of its file.

    Returns
    -------
    str
    """
    findings = Findings(result)
    methods = sensitivity_of(findings)  # before the answer, which then finds its indices computed
    answer = conclude(findings)
    summary = findings.summary
    described = outcomes(result, summary)
    drawn = list(pictures(findings, "results", without=findings.absent))
    by_regime = list(pictures(findings, "rows"))
    figure = figure_of_subject(answer, drawn, by_regime)
    lost = int(result.failed.sum())
    hashes = ("study_sha256", "study_identity")
    content = {
        "design": result.design,
        "summary": summary,
        **first_screen(card_of(findings, answer), answer, figure),
        "sentences": fragment(answer),
        "groups": list(groups(findings, answer, described, drawn, methods)),
        "regimes_answered": regimes(answer),
        "inputs": list(input_tables(result)),
        "inputs_fixed": fixed_inputs(result),
        "inputs_drawn": list(pictures(findings, "inputs")),
        "status": status_table(result, summary),
        "failed_rows": lost,
        "regimes": regime_tables(findings),
        "rows_drawn": [*(figure for figure in drawn if figure.output == REGIME), *by_regime],
        "regime_indices": of_output(methods, REGIME),
        "convergence": convergence_of(findings, described),
        "levels": levels_of(findings),
        "fleets": fleet_table(findings),
        "fleet_notes": fleet_notes(findings),
        "methods": methods,
        "rows_inside": rows_inside(findings, name, answer.quantities),
        "why_no_rows": why_no_rows(findings),
        "provenance": [key for key in (*provenance(), *hashes) if key in result.dataset.attrs],
        "result_file": result.file,
        "inspections": inspections_csv(result),
        "model_option": result.model_option,
        "rerun": int((result.dataset["rerun"].values != 0).sum())
        if "rerun" in result.dataset
        else 0,
        "references": references(result),
    }
    return laid_out("page.html", result, file=name, **content)
