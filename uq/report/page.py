"""The content of the page, which the template beside this file lays out."""

import json
import re
import shlex
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import xarray as xr
from markupsafe import Markup, escape

from uq.analysis.findings import Findings
from uq.conclusions.answer import conclude
from uq.conclusions.page import STYLE, regimes
from uq.designs.registry import DESIGNS
from uq.errors import InputError
from uq.literals import plain
from uq.provenance import provenance
from uq.report.convergence import convergence_of
from uq.report.embedded import rows_inside
from uq.report.fleets import fleet_notes, fleet_table
from uq.report.groups import REGIME, groups
from uq.report.headlines import headline
from uq.report.indices import of_output, output_of, sensitivity_of
from uq.report.inputs import fixed_inputs, input_tables
from uq.report.levels import levels_of
from uq.report.outcomes import outcomes, regime_tables, status_table
from uq.report.pictures import pictures
from uq.report.references import references
from uq.rows.elements import study_file_of
from uq.rows.results import failed, open_result
from uq.store.files import check_target, whole

_SHOWN_TEXT = 50_000
"""Characters of the study's text that a page shows: a study may contain data files."""


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
        Result, name of its file -> HTML: `page`, the default, or `uq.report.dossier.dossier`.

    Raises
    ------
    InputError
        When the result cannot be read or the report cannot be written.
    """
    result, path = Path(result), Path(path)
    ds = open_result(result)
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
    return templates().get_template("page.html").render(_content(ds, name), file=name)


def study_text(ds: xr.Dataset) -> dict[str, Any]:
    """Return the text of the study as far as a page shows it, and whether that is cut."""
    text = ds.attrs["study"]
    return {"text": text.expandtabs(4)[:_SHOWN_TEXT], "text_is_cut": len(text) > _SHOWN_TEXT}


@cache
def templates() -> Any:
    """Return jinja's environment of the templates beside this file."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("uq", "report"),
        autoescape=True,
        finalize=lambda value: plain(value) if type(value) is str else value,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters |= {"breakable": _breakable, "inside": _inside, "quoted": shlex.quote}
    return environment


def _breakable(text: str) -> Markup:
    """Return text with places where long names may be broken."""
    return Markup(re.sub(r"([_,\[])(?=\S)", r"\1<wbr>", str(escape(plain(text)))))


def _inside(content: Any) -> Markup:
    """Return plain data as JSON that can stand inside a page."""
    return Markup(json.dumps(content, allow_nan=False).replace("<", "\\u003c"))


def _content(ds: xr.Dataset, file: str) -> dict[str, Any]:
    """Return what the template lays out."""
    findings = Findings(ds)
    answer = conclude(findings)
    summary = findings.summary
    found = outcomes(ds, summary)
    methods = sensitivity_of(findings)
    drawn = list(pictures(findings, "results", without=findings.absent))
    headed = headline(answer, drawn)
    lost = int(failed(ds).sum())
    hashes = ("study_sha256", "study_identity")
    return {
        "attrs": ds.attrs,
        "study": study_file_of(ds),
        "design": DESIGNS[ds.attrs["design"]],
        "summary": summary,
        "answer": headed,
        "groups": list(groups(findings, answer, found, drawn, methods)),
        "regimes_answered": regimes(answer),
        "answer_style": STYLE,
        "inputs": list(input_tables(ds)),
        "inputs_fixed": fixed_inputs(ds),
        "inputs_drawn": list(pictures(findings, "inputs")),
        "status": status_table(ds, summary),
        "failed": lost,
        "regimes": regime_tables(findings),
        "rows_drawn": [
            *(one for one in drawn if output_of(one.of.name) == REGIME),
            *pictures(findings, "rows"),
        ],
        "regime_indices": of_output(methods, REGIME),
        "convergence": convergence_of(findings, found),
        "levels": levels_of(findings),
        "fleets": fleet_table(findings),
        "fleet_notes": fleet_notes(findings),
        "methods": methods,
        "rows_inside": rows_inside(findings, file),
        **study_text(ds),
        "provenance": [name for name in (*provenance(), *hashes) if name in ds.attrs],
        "rerun": int((ds["rerun"].values != 0).sum()) if "rerun" in ds else 0,
        "references": references(ds),
    }
