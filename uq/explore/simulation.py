"""One row of a model as a Dataset, without a study."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from uq.contract import Model
from uq.execution.single_row import run_alone
from uq.files.interrupts import in_background
from uq.files.netcdf_files import refuse_tricks
from uq.result import result_file
from uq.result.one_row import Row, run_row

MOST_SHOWN = 6
"""Quantities in a picture of a motion."""


def simulate(
    model: str | Model,
    parameters: Mapping[str, float] | None = None,
    settings: Mapping[str, Any] | None = None,
    seed: int = 0,
    trajectory: bool = True,
) -> xr.Dataset:
    """Run a model once, at its nominal values except those given.

    Parameters
    ----------
    model : str or Model
        A model, or the name of an installed one.
    parameters : dict of str to float, optional
        In the units of the model.
    settings : dict, optional
        Numerical settings by name.
    seed : int
        0 to 2^64 - 1, for models that draw random numbers.
    trajectory : bool
        Whether to compute the time history as well.

    Returns
    -------
    xarray.Dataset
        One row of outputs and its status, all parameters, and, if the model has one,
        ``trajectory`` (time, quantity) with the unit of each quantity.

    Raises
    ------
    InputError
        When a name is unknown or a value is not admissible.

    Examples
    --------
    >>> uq.simulate("linear", {"x1": 0.25})["y"].item()  # x1 + 2 x2 + 3 x3 + 4 x4
    4.75
    """
    given = dict(parameters or {}), dict(settings or {}), seed
    row = run_alone(model, *given) if isinstance(model, str) else run_row(model, *given)
    return dataset(row, trajectory)


def dataset(row: Row, trajectory: bool = True) -> xr.Dataset:
    """Return a row as `simulate` does."""
    ds = result_file.build_rows(
        row.model, row.settings, row.values, row.columns, row.status, row.failures
    )
    return with_trajectory(ds, row) if trajectory else ds


def with_trajectory(ds: xr.Dataset, row: Row) -> xr.Dataset:
    """Return a Dataset with the time history of a row, if its model gives one."""
    if row.model.simulate is None:
        return ds
    return ds.assign(trajectory=in_background(lambda: _trajectory(row)))


def holds_trajectory(path: Path) -> bool:
    """Return whether a file is a netCDF file of what `simulate` returns with a trajectory."""
    try:
        refuse_tricks(path)
        with xr.open_dataset(path, engine="netcdf4", decode_timedelta=False) as ds:
            roles = [variable.attrs.get("role") for variable in ds.data_vars.values()]
            return "trajectory" in roles and "schema_version" in ds.attrs
    except result_file.UNREADABLE:
        return False


def _trajectory(row: Row) -> xr.DataArray:
    assert row.model.simulate is not None
    params = row.model.parameters(**row.values)
    history = row.model.simulate(params, row.settings, seed=row.seed)
    names = list(history.quantities)
    units, meanings, series = zip(*history.quantities.values(), strict=True)
    nowhere = (np.nan, np.nan)
    shown = history.shown or tuple(names[:MOST_SHOWN])
    return xr.DataArray(
        np.stack(series, axis=1),
        dims=("time", "quantity"),
        coords={
            "time": ("time", history.time, {"units": "s", "long_name": "time"}),
            "quantity": names,
            "units": ("quantity", list(units)),  # "unit" is that of the row in its sample
            "meaning": ("quantity", list(meanings)),
            "lower_stop": ("quantity", [history.stops.get(name, nowhere)[0] for name in names]),
            "upper_stop": ("quantity", [history.stops.get(name, nowhere)[1] for name in names]),
            "turns": ("quantity", [int(name in history.angles) for name in names]),
            "shown": ("quantity", [shown.index(name) if name in shown else -1 for name in names]),
        },
        attrs={"role": "trajectory", "long_name": "time history", "period": history.period},
    )
