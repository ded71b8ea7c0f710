"""Basins of attraction of any model, computed like a study."""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Model
from uq.errors import InputError
from uq.execution import runner, tally
from uq.execution.options import RunOptions
from uq.explore.attractors import STANDARD_ERRORS, Compared, attractors
from uq.explore.grid import Axis, ParameterGrid, grid_of
from uq.files import whole_files
from uq.files.netcdf_files import refuse_tricks
from uq.result import result_file
from uq.result.variables import error_name, outputs_of
from uq.result.workload import Workload
from uq.sampling.named_values import unknown_name
from uq.study.row_sampling import Rows


def basins(
    model: str | Model,
    axes: Mapping[str, Axis],
    fixed: Mapping[str, float] | None = None,
    settings: Mapping[str, Any] | None = None,
    by: Sequence[str] | None = None,
    tolerance: float = 0.01,
    output: str | Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
) -> xr.Dataset:
    """Run a model on a grid of its parameters, and find the attractor on which each point settles.

    Parameters
    ----------
    model : str or Model
        The name of an installed model, ``"package.module:ATTRIBUTE"``, or a model; one that is not
        installed runs in this process.
    axes : dict of str to tuple
        Parameter -> (first value, last value, number of values), evenly spaced, in the parameter's
        unit.
    fixed : dict of str to float, optional
        Other parameters with values that are not nominal.
    settings : dict, optional
        Numerical settings by name.
    by : sequence of str, optional
        Outputs that distinguish attractors, in addition to categories; by default all but the
        errors of others. Extremes of a chaotic response scatter: use its means instead.
    tolerance : float
        Values of an output are alike if they differ by at most this share of its largest magnitude
        on the grid, plus four standard errors if the model has them, as ``<output>_error``.
    output : str or Path, optional
        NetCDF file to write; if it contains these same basins, they are read instead.
    workers, scheduler
        As in `uq.run`.

    Returns
    -------
    xarray.Dataset
        Outputs, ``status`` and ``attractor`` on the grid, whose dimensions are the parameters.
        Attractors are numbered from the most frequent, 0; -1 marks a failed row. Two rows share an
        attractor if their categories are equal and, for each output, a chain of rows with like
        values connects them. Dimension ``basin`` has the ``share`` of rows of each attractor, and
        the values of its first row as ``representative_<name>``. For a table, use
        ``ds.drop_dims(list(axes)).to_dataframe()``.

    Raises
    ------
    InputError
        When a name is unknown, a value is not admissible, or `output` contains something else.
    RunError
        When there is no result: workers die, a disk is full.
    """
    grid = grid_of(model, axes, fixed or {}, settings or {})
    compared = _compared_outputs(grid.model, by)
    if not tolerance >= 0:
        raise InputError(f"tolerance must not be negative: {tolerance!r}")
    if not grid.reference and (workers or scheduler is not None):
        raise InputError(
            f"model '{grid.model.name}' is not installed, and workers would not find it: "
            "give it as 'package.module:ATTRIBUTE'"
        )
    model_choices = grid.model.choices_of(grid.settings)
    rows = [
        grid.model.name,
        grid.model.version,
        [*grid.axes.items()],
        grid.constants,
        model_choices,
    ]
    choices = json.dumps([rows, compared, float(tolerance)])
    identity = hashlib.sha256(choices.encode()).hexdigest()
    finish = partial(_finish, grid, compared, float(tolerance), identity)
    workload = Workload(
        grid.model, grid.reference, grid.settings, grid.rows, 1, block=grid.block, finish=finish
    )
    options = RunOptions(workers if grid.reference else 0, scheduler)
    if output is None:
        return runner.carry_out(workload, options)
    path = Path(output)
    if path.is_file():
        return _reused(path, identity)
    whole_files.check_target(path, tally.row_bytes(workload) * workload.total)
    ds = runner.carry_out(workload, options)
    whole_files.write(ds, path)
    return ds


def _compared_outputs(model: Model, by: Sequence[str] | None) -> tuple[str, ...]:
    names = tuple(model.outputs)
    if by is None:
        errors = set(map(error_name, names))
        return tuple(name for name in names if name not in errors)
    if unknown := [name for name in by if name not in names]:
        raise InputError(*(f"by: {unknown_name('output', name, model, names)}" for name in unknown))
    return tuple(name for name in names if name in by or model.outputs[name].is_category)


def _reused(path: Path, identity: str) -> xr.Dataset:
    try:
        refuse_tricks(path)
        ds = xr.load_dataset(path, engine="netcdf4", decode_timedelta=False)
    except result_file.UNREADABLE:
        raise InputError(f"{path}: not a readable netCDF file; choose another output") from None
    if ds.attrs.get("basins_identity") != identity:
        raise InputError(f"{path}: has other contents; choose another output")
    return ds


def _finish(
    grid: ParameterGrid,
    compared: Sequence[str],
    tolerance: float,
    identity: str,
    rows: Rows,
    columns: result_file.Columns,
    status: NDArray[np.int8],
    failures: Mapping[str, str],
) -> xr.Dataset:
    """Find the attractors, and arrange the rows as a grid."""
    model = grid.model
    values = {
        name: rows.x[:, i] if name in grid.axes else grid.constants[name]
        for i, name in enumerate(model.parameter_names)
    }
    flat = result_file.build_rows(model, grid.settings, values, columns, status, failures)
    valid = np.flatnonzero(~result_file.failed(flat))
    labels = np.full(grid.rows, -1, np.int32)
    numbers = list(_numbers(flat.isel(row=valid), compared, tolerance))
    labels[valid] = attractors(numbers, len(valid))
    about = {
        "long_name": "attractor, -1 where the row failed",
        "compared": " ".join(compared),
        "tolerance": tolerance,
        "standard_errors": STANDARD_ERRORS,
    }
    flat["attractor"] = ("row", labels, about)
    ds = _folded(flat, grid).merge(_table(flat.isel(row=valid), grid))
    title = f"Basins of attraction of model '{model.name}'"
    ds.attrs = flat.attrs | {"title": title, "basins_identity": identity}
    for variable in ds.variables.values():
        variable.encoding["_FillValue"] = None
    return ds


def _numbers(flat: xr.Dataset, names: Sequence[str], tolerance: float) -> Iterator[Compared]:
    """Yield the numbers to be compared, element by element."""
    declared = outputs_of(flat)
    for name in names:
        values = flat[name].astype(float)
        errors = xr.zeros_like(values)
        if (stated := error_name(name)) in flat:
            errors = (errors + flat[stated]).transpose(*values.dims)
        slack = 0.0 if declared[name].is_category else tolerance
        columns = (np.reshape(a.values, (len(a), -1)).T for a in (values, errors))
        for value, error in zip(*columns, strict=True):
            yield value, np.nan_to_num(error, posinf=0.0), slack


def _folded(flat: xr.Dataset, grid: ParameterGrid) -> xr.Dataset:
    """Replace the dimension of rows by one dimension per axis."""
    axes, variables = tuple(grid.axes), {}
    for name, rows in flat.data_vars.items():
        variables[name] = rows.variable
        if "row" in rows.dims:
            data = rows.values.reshape(*grid.shape, *rows.shape[1:])
            variables[name] = xr.Variable((*axes, *rows.dims[1:]), data, rows.attrs)
    variables |= {name: xr.Variable(name, grid.values(name), flat[name].attrs) for name in axes}
    return xr.Dataset(variables, flat.coords)


def _table(flat: xr.Dataset, grid: ParameterGrid) -> xr.Dataset:
    """Return the table of attractors, given the rows that did not fail."""
    _, first, count = np.unique(flat["attractor"], return_index=True, return_counts=True)
    representatives = flat[[*grid.axes, *grid.model.outputs]].isel(row=first)
    for name, output in grid.model.outputs.items():
        if output.is_category:
            words = np.array(["none", *output.categories])[representatives[name].values + 1]
            representatives[name] = representatives[name].dims, words, {"long_name": output.meaning}
    table = representatives.rename(
        {"row": "basin"} | {name: f"representative_{name}" for name in representatives}
    )
    table["share"] = ("basin", count / grid.rows, {"units": "1", "long_name": "share of all rows"})
    return table.assign_coords(basin=("basin", np.arange(len(first)), {"long_name": "attractor"}))
