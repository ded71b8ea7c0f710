"""What a report says of convergence: estimates as rows came in, and the other errors."""

from typing import NamedTuple, cast

import pandas as pd

from uq.analysis.convergence import enough
from uq.analysis.findings import Findings
from uq.report.cells import Cell, Table, without_empty_columns
from uq.report.outcomes import Outcome
from uq.report.pictures import Picture, pictures
from uq.wording import number


class Convergence(NamedTuple):
    """Whether it is enough.

    Attributes
    ----------
    table : Table or None
        The error of sampling beside that of the rows themselves.
    warnings : list of str
    refused : str
        Why nothing is known of fewer rows, or "".
    pictures : list of Picture
    """

    table: Table | None
    warnings: list[str]
    refused: str
    pictures: list[Picture]


def convergence_of(findings: Findings, found: list[Outcome]) -> Convergence:
    """Return what is known of the convergence of a result.

    Parameters
    ----------
    findings : Findings
    found : list of Outcome
        Its outputs.

    Returns
    -------
    Convergence
    """
    if not found:
        return Convergence(None, [], "there is no output with numbers", [])
    errors = enough(findings.ds)
    told = [one for one in found if one.name in errors.index]
    lines = ((one, cast(pd.Series, errors.loc[one.name])) for one in told)
    rows = [_row(one, line) for one, line in lines if line[["sampling", "own"]].notna().any()]
    header = ("output", "unit", "estimate", "half-width of its interval", "error of the rows")
    table = without_empty_columns(Table("Error of sampling", header, rows)) if rows else None
    warnings = [
        f"{one.name}: {words}" for one in told if (words := str(errors.loc[one.name, "warning"]))
    ]
    drawn = [picture for _, picture in pictures(findings, "convergence")]
    return Convergence(table, warnings, findings.not_running, drawn)


def _row(one: Outcome, errors: pd.Series) -> tuple[Cell, ...]:
    cells = []
    for error in (float(errors["sampling"]), float(errors["own"])):
        known = error == error
        cells.append(Cell(number(error / one.unit.seconds), key=error) if known else Cell("-"))
    return one.label, one.unit_cell, Cell(str(errors["estimate"])), *cells
