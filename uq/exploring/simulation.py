"""One row of a model, without a study."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from uq.contract import Model
from uq.errors import InputError
from uq.inputs.values import fault_lines, parameter_problem, read_settings
from uq.interrupts import in_background
from uq.rows import results
from uq.rows.evaluate import evaluate
from uq.study.registry import find_model


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
    model = find_model(model) if isinstance(model, str) else model
    given, chosen = dict(parameters or {}), dict(settings or {})
    problems = {name: parameter_problem(model, name, value) for name, value in given.items()}
    frozen, wrong = read_settings(model, chosen)
    if faults := fault_lines("", given, problems) + fault_lines("setting ", chosen, wrong):
        raise InputError(*faults)

    values = model.nominal | {name: float(value) for name, value in given.items()}
    x = np.array([[values[name] for name in model.parameter_names]])
    chunk = in_background(lambda: evaluate(model, frozen, x, np.array([seed], dtype=np.uint64)))
    failures = {label: text for label, (_, text) in chunk.failures.items()}
    ds = results.build_rows(model, frozen, values, chunk.columns, chunk.status, failures)
    if not trajectory or model.simulate is None:
        return ds
    return ds.assign(trajectory=in_background(lambda: _trajectory(model, frozen, values, seed)))


def holds_trajectory(path: Path) -> bool:
    """Return whether a file is a netCDF file of what `simulate` returns with a trajectory."""
    try:
        with xr.open_dataset(path, engine="netcdf4", decode_timedelta=False) as ds:
            roles = [variable.attrs.get("role") for variable in ds.data_vars.values()]
            return "trajectory" in roles and "schema_version" in ds.attrs
    except results.UNREADABLE:
        return False


def _trajectory(
    model: Model, settings: Any, values: Mapping[str, float], seed: int
) -> xr.DataArray:
    assert model.simulate is not None
    history = model.simulate(model.parameters(**values), settings, seed=seed)
    names = list(history.quantities)
    units, meanings, series = zip(*history.quantities.values(), strict=True)
    return xr.DataArray(
        np.stack(series, axis=1),
        dims=("time", "quantity"),
        coords={
            "time": ("time", history.time, {"units": "s", "long_name": "time"}),
            "quantity": names,
            "unit": ("quantity", list(units)),
            "meaning": ("quantity", list(meanings)),
        },
        attrs={"role": "trajectory", "long_name": "time history"},
    )
