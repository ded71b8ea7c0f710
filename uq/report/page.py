"""The page itself: what is in it, laid out by the template beside this file."""

import re
import shlex
from pathlib import Path
from typing import Any

import xarray as xr
from markupsafe import Markup, escape

from uq.analysis.findings import Findings
from uq.analysis.summary import Summary
from uq.designs.registry import DESIGNS
from uq.errors import InputError
from uq.literals import plain
from uq.provenance import provenance
from uq.report.convergence import convergence_of
from uq.report.headlines import headlines
from uq.report.indices import sensitivity_of
from uq.report.inputs import input_tables
from uq.report.outcomes import (
    outcomes,
    regime_table,
    result_tables,
    status_table,
)
from uq.report.pictures import Picture, pictures
from uq.rows.elements import study_file_of
from uq.rows.results import failed
from uq.rows.variables import outputs_of
from uq.store.files import check_target, whole
from uq.study.registry import find_model

_SHOWN_TEXT = 50_000
"""Characters of a study's text that a page shows: a study may carry whole data files."""


def write_report(result: str | Path, path: str | Path) -> None:
    """Write the report of a result as one HTML file that needs no other.

    Parameters
    ----------
    result : path-like
    path : path-like
        Appears whole or not at all.

    Raises
    ------
    InputError
        When the result cannot be read, or the report not be written there.
    """
    from uq.rows.results import open_result

    result, path = Path(result), Path(path)
    ds = open_result(result)
    check_target(path, 0)
    if path.exists() and path.samefile(result):
        raise InputError(f"{path}: is the result itself; give the report another name")
    text = page(ds, result.name)
    with whole(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


def page(ds: xr.Dataset, name: str) -> str:
    """Return the report of a result as HTML; the same result gives the same text.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    name : str
        What its file is called.

    Returns
    -------
    str
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("uq", "report"),
        autoescape=True,
        finalize=lambda value: plain(value) if type(value) is str else value,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["breakable"] = _breakable
    return environment.get_template("page.html").render(_content(ds, name))


def _breakable(text: str) -> Markup:
    """Return text that may go on in a new line inside of long names."""
    return Markup(re.sub(r"([_,\[])(?=\S)", r"\1<wbr>", str(escape(plain(text)))))


def _content(ds: xr.Dataset, name: str) -> dict[str, Any]:
    """Return what the template lays out."""
    study = study_file_of(ds)
    findings = Findings(ds)
    summary = findings.summary
    found = outcomes(ds, summary)
    methods = sensitivity_of(findings)
    lives = {name for name, output in outputs_of(ds).items() if output.is_lifetime}
    drawn = list(pictures(findings, "results", without=findings.absent))
    lost = int(failed(ds).sum())
    return {
        "title": str(ds.attrs["title"]),
        "study": study.study,
        "facts": _facts(ds, summary),
        "headlines": headlines(summary, lost, found, methods),
        "inputs": list(input_tables(ds)),
        "inputs_drawn": _drawn(findings, "inputs"),
        "status": status_table(ds, summary),
        "failed": lost,
        "max_failed": study.analysis.max_failed,
        "regimes": regime_table(summary) if summary.regimes else None,
        "rows_drawn": _drawn(findings, "rows"),
        "convergence": convergence_of(findings, found),
        "results": list(result_tables(found)),
        "results_drawn": [picture for of, picture in drawn if of.name not in lives],
        "lives": list(result_tables(found, of_lives=True)),
        "lives_drawn": [picture for of, picture in drawn if of.name in lives],
        "notes": summary.notes,
        "methods": methods,
        "text": ds.attrs["study"].expandtabs(4)[:_SHOWN_TEXT],
        "text_is_cut": len(ds.attrs["study"]) > _SHOWN_TEXT,
        "commands": _commands(ds, name, study.study.name, study.design.samples),
        "provenance": _provenance(ds),
        "rerun": int((ds["rerun"].values != 0).sum()) if "rerun" in ds else 0,
        "references": _references(ds),
        "version": str(ds.attrs.get("vibrolife", "")),
    }


def _drawn(findings: Findings, section: str) -> list[Picture]:
    return [picture for _, picture in pictures(findings, section)]


def _facts(ds: xr.Dataset, summary: Summary) -> list[tuple[str, str]]:
    design = ds.attrs["design"]
    rows = f"{summary.samples}"
    if summary.rows_used < summary.samples:
        some = summary.rows_used
        rows += f", statistics from {some} independent ones" if some else ", none independent"
    replicates = f", {ds.attrs['replicates']} replicates" if ds.attrs["replicates"] > 1 else ""
    return [
        ("Model", f"{ds.attrs['model']}, version {ds.attrs['model_version']}"),
        ("Design", f"{design}: {DESIGNS[design].meaning}{replicates}"),
        ("Rows", rows),
        ("Seed", f"{ds.attrs['seed']}"),
        ("Hash", f"SHA-256 {ds.attrs['study_sha256']}"),
    ]


def _commands(ds: xr.Dataset, name: str, study: str, samples: int) -> list[str]:
    more = "" if samples in (0, ds.attrs["samples"]) else f" --samples {ds.attrs['samples']}"
    return [
        f"uq run {study}.toml{more}",
        f"uq verify {shlex.quote(name)}",
    ]


def _provenance(ds: xr.Dataset) -> list[tuple[str, str]]:
    made = [(name, str(ds.attrs[name])) for name in provenance() if name in ds.attrs]
    hashes = ("study_sha256", "study_identity")
    return made + [(name.replace("_", " "), str(ds.attrs[name])) for name in hashes]


def _references(ds: xr.Dataset) -> tuple[str, ...] | None:
    """Return what the model wants to see cited, or None where it is not installed here."""
    try:
        return find_model(ds.attrs["model"]).references
    except InputError:
        return None
