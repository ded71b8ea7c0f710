"""Convergence in a report: running estimates, and the errors of the rows themselves."""

from typing import NamedTuple, cast

import pandas as pd

from uq.assess.convergence import enough
from uq.assess.findings import Findings
from uq.errors import InputError
from uq.render.html.cells import Cell, HtmlTable, without_empty_columns
from uq.render.html.outcomes import Outcome
from uq.render.html.pictures import Picture, pictures
from uq.text.keys import key_of
from uq.text.numbers import number


class Convergence(NamedTuple):
    """The convergence of the estimates of a result.

    Attributes
    ----------
    table : HtmlTable or None
        The sampling error and the error of the rows themselves.
    warnings : list of str
    refused : str
        Why there are no running estimates, or "".
    pictures : list of Picture
    """

    table: HtmlTable | None
    warnings: list[str]
    refused: str
    pictures: list[Picture]


def convergence_of(findings: Findings, outcomes: list[Outcome]) -> Convergence:
    """Return the convergence of a result.

    Parameters
    ----------
    findings : Findings
    found : list of Outcome
        Its outputs.

    Returns
    -------
    Convergence
    """
    if not outcomes:
        return Convergence(None, [], "there is no numeric output", [])
    try:
        errors = enough(findings.result)
    except InputError as refused:
        return Convergence(None, [], str(refused), [])
    lines = [
        (outcome, cast(pd.Series, errors.loc[outcome.name]))
        for outcome in outcomes
        if outcome.name in errors.index
    ]
    rows = [
        _row(outcome, line) for outcome, line in lines if line[["sampling", "own"]].notna().any()
    ]
    header = ("output", "unit", "estimate", "half-width of the interval", "error of the rows")
    table = without_empty_columns(HtmlTable("Sampling error", header, rows)) if rows else None
    warnings = [f"{outcome.name}: {line['warning']}" for outcome, line in lines if line["warning"]]
    drawn = list(pictures(findings, "convergence"))
    return Convergence(table, warnings, findings.running.attrs.get("refused", ""), drawn)


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
