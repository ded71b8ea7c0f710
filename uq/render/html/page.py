"""The content of the page, which the template beside this file lays out."""

from collections.abc import Callable
from pathlib import Path

from uq.assess.answer.answer import conclude
from uq.assess.findings import Findings
from uq.assess.summary import REGIME
from uq.errors import InputError
from uq.files.whole_files import check_target, whole
from uq.render.html.answer import regimes
from uq.render.html.convergence import convergence_of
from uq.render.html.embedded_rows import rows_inside, why_no_rows
from uq.render.html.fleets import fleet_notes, fleet_table
from uq.render.html.head import headline
from uq.render.html.indices import of_output, sensitivity_of
from uq.render.html.inputs import fixed_inputs, input_tables
from uq.render.html.inspections import inspections_csv
from uq.render.html.layout import laid_out
from uq.render.html.levels import levels_of
from uq.render.html.outcomes import outcomes, regime_tables, status_table
from uq.render.html.output_tables import groups
from uq.render.html.pictures import pictures
from uq.render.html.references import references
from uq.result.commands import named
from uq.result.result import Result
from uq.result.result_file import open_result
from uq.study.provenance import provenance


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
    """Return the report of a result as HTML, the same text each time.

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
    answer = conclude(findings)
    summary = findings.summary
    described = outcomes(result, summary)
    methods = sensitivity_of(findings)
    drawn = list(pictures(findings, "results", without=findings.absent))
    by_regime = list(pictures(findings, "rows"))
    headed = headline(answer, drawn, by_regime)
    lost = int(result.failed.sum())
    hashes = ("study_sha256", "study_identity")
    content = {
        "design": result.design,
        "summary": summary,
        "answer": headed,
        "groups": list(groups(findings, answer, described, drawn, methods)),
        "regimes_answered": regimes(answer),
        "inputs": list(input_tables(result)),
        "inputs_fixed": fixed_inputs(result),
        "inputs_drawn": list(pictures(findings, "inputs")),
        "status": status_table(result, summary),
        "failed": lost,
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
