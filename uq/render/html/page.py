"""The content of the page, which the template beside this file lays out."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import xarray as xr

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
from uq.render.html.indices import of_output, output_of, sensitivity_of
from uq.render.html.inputs import fixed_inputs, input_tables
from uq.render.html.inspections import inspections_csv
from uq.render.html.layout import laid_out
from uq.render.html.levels import levels_of
from uq.render.html.outcomes import outcomes, regime_tables, status_table
from uq.render.html.output_tables import groups
from uq.render.html.pictures import pictures
from uq.render.html.references import references
from uq.result.commands import file_of, model_option, named
from uq.result.result_file import failed, open_result
from uq.sampling.designs import DESIGNS
from uq.study.provenance import provenance


def write_report(
    result: str | Path,
    path: str | Path,
    lay_out: Callable[[xr.Dataset, str], str] | None = None,
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
    ds = named(open_result(result), result.name)
    check_target(path, 0)
    if path.exists() and path.samefile(result):
        raise InputError(f"{path}: is the result itself; give the report another name")
    text = (lay_out or page)(ds, result.name)
    with whole(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def page(ds: xr.Dataset, name: str) -> str:
    """Return the report of a result as HTML, the same text each time.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    name : str
        The name of its file.

    Returns
    -------
    str
    """
    return laid_out("page.html", ds, file=name, **_content(ds, name))


def _content(ds: xr.Dataset, file: str) -> dict[str, Any]:
    """Return what the template lays out."""
    findings = Findings(ds)
    answer = conclude(findings)
    summary = findings.summary
    found = outcomes(ds, summary)
    methods = sensitivity_of(findings)
    drawn = list(pictures(findings, "results", without=findings.absent))
    by_regime = list(pictures(findings, "rows"))
    headed = headline(answer, drawn, by_regime)
    lost = int(failed(ds).sum())
    hashes = ("study_sha256", "study_identity")
    return {
        "design": DESIGNS[ds.attrs["design"]],
        "summary": summary,
        "answer": headed,
        "groups": list(groups(findings, answer, found, drawn, methods)),
        "regimes_answered": regimes(answer),
        "inputs": list(input_tables(ds)),
        "inputs_fixed": fixed_inputs(ds),
        "inputs_drawn": list(pictures(findings, "inputs")),
        "status": status_table(ds, summary),
        "failed": lost,
        "regimes": regime_tables(findings),
        "rows_drawn": [
            *(one for one in drawn if output_of(one.of.name) == REGIME),
            *by_regime,
        ],
        "regime_indices": of_output(methods, REGIME),
        "convergence": convergence_of(findings, found),
        "levels": levels_of(findings),
        "fleets": fleet_table(findings),
        "fleet_notes": fleet_notes(findings),
        "methods": methods,
        "rows_inside": rows_inside(findings, file, answer.quantities),
        "why_no_rows": why_no_rows(findings),
        "provenance": [name for name in (*provenance(), *hashes) if name in ds.attrs],
        "result_file": file_of(ds),
        "inspections": inspections_csv(ds),
        "model_option": model_option(ds),
        "rerun": int((ds["rerun"].values != 0).sum()) if "rerun" in ds else 0,
        "references": references(ds),
    }
