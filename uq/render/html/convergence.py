"""Convergence in a report: running estimates, and the errors of the rows themselves."""

from typing import Any, cast

import pandas as pd

from uq.assess.convergence import enough
from uq.assess.findings import Findings
from uq.errors import InputError
from uq.render.html.cells import Cell, HtmlTable, without_empty_columns
from uq.render.html.outcomes import Outcome
from uq.render.html.pictures import pictures
from uq.text.keys import key_of
from uq.text.numbers import number


def convergence_of(findings: Findings, outcomes: list[Outcome]) -> dict[str, Any]:
    """Return the convergence of a result: errors, warnings and figures.

    Parameters
    ----------
    findings : Findings
    outcomes : list of Outcome
        Its outputs.

    Returns
    -------
    dict
        ``table``: the sampling error and the solver error of the rows, or None; ``warnings``;
        ``refused``: the reason why there are no running estimates, or ""; ``pictures``.
    """
    nothing: dict[str, Any] = {"table": None, "warnings": [], "pictures": []}
    if not outcomes:
        return nothing | {"refused": "there is no numeric output"}
    try:
        errors = enough(findings.result)
    except InputError as refused:
        return nothing | {"refused": str(refused)}
    lines = [
        (outcome, cast(pd.Series, errors.loc[outcome.name]))
        for outcome in outcomes
        if outcome.name in errors.index
    ]
    rows = [
        _row(outcome, line) for outcome, line in lines if line[["sampling", "own"]].notna().any()
    ]
    header = ("output", "unit", "estimate", "half-width of the interval", "error of the rows")
    return {
        "table": without_empty_columns(HtmlTable("Sampling error", header, rows)) if rows else None,
        "warnings": [
            f"{outcome.name}: {line['warning']}" for outcome, line in lines if line["warning"]
        ],
        "refused": findings.running.attrs.get("refused", ""),
        "pictures": list(pictures(findings, "convergence")),
    }


def _row(outcome: Outcome, errors: pd.Series) -> tuple[Cell, ...]:
    cells = (
        Cell(number(error / outcome.unit.size), key=error, traced=traced)
        if error == error
        else Cell("-")
        for name in ("sampling", "own")
        for error in [float(errors[name])]
        for traced in [key_of("outputs", outcome.name, f"{name}_error", verb="convergence")]
    )
    return (
        Cell(outcome.name, outcome.place),
        outcome.unit_cell,
        Cell(str(errors["estimate"])),
        *cells,
    )
