"""What a report says of convergence: estimates as rows came in, and the other errors."""

from typing import NamedTuple, cast

import pandas as pd
import xarray as xr

from uq.analysis.convergence import enough, running_estimates
from uq.drawing.convergence_plot import convergence, index_convergence
from uq.drawing.index_plot import subject
from uq.errors import InputError
from uq.report.cells import Cell, Table, without_empty_columns
from uq.report.outcomes import Outcome
from uq.report.pictures import Picture, picture
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


def convergence_of(ds: xr.Dataset, found: list[Outcome]) -> Convergence:
    """Return what is known of the convergence of a result.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    found : list of Outcome
        Its outputs.

    Returns
    -------
    Convergence
    """
    if not found:
        return Convergence(None, [], "there is no output with numbers", [])
    errors = enough(ds)
    told = [one for one in found if one.name in errors.index]
    lines = ((one, cast(pd.Series, errors.loc[one.name])) for one in told)
    rows = [_row(one, line) for one, line in lines if line[["sampling", "own"]].notna().any()]
    header = ("output", "unit", "estimate", "half-width of its interval", "error of the rows")
    table = without_empty_columns(Table("Error of sampling", header, rows)) if rows else None
    warnings = [
        f"{one.name}: {words}" for one in told if (words := str(errors.loc[one.name, "warning"]))
    ]
    try:
        running = running_estimates(ds)
    except InputError as refused:
        return Convergence(table, warnings, str(refused), [])
    return Convergence(table, warnings, "", _pictures(ds, found, running))


def _row(one: Outcome, errors: pd.Series) -> tuple[Cell, ...]:
    cells = []
    for error in (float(errors["sampling"]), float(errors["own"])):
        known = error == error
        cells.append(Cell(number(error / one.unit.seconds), key=error) if known else Cell("-"))
    return one.label, one.unit_cell, Cell(str(errors["estimate"])), *cells


def _pictures(ds: xr.Dataset, found: list[Outcome], running: pd.DataFrame) -> list[Picture]:
    names = dict.fromkeys(one.name.partition("[")[0] for one in found)
    drawn = []
    for name in names:
        if (figure := convergence(ds, name, running)) is not None:
            drawn.append(picture(figure, f"Convergence of {name}: {ds[name].attrs['long_name']}"))
    for target in running["output"].unique():
        figure = index_convergence(ds, target, running, subject(ds, target))
        if figure is not None:
            drawn.append(picture(figure, f"Convergence of the total indices of {target}"))
    return drawn
