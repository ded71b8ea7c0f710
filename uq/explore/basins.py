"""Basins of attraction of any model on a grid of its parameters, computed like a study."""

import hashlib
import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from math import prod
from operator import index
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Floats, Model
from uq.errors import InputError
from uq.execution import runner, tally
from uq.execution.options import RunOptions
from uq.files import whole_files
from uq.files.netcdf_files import refuse_tricks
from uq.result import result_file
from uq.result.variables import error_name, outputs_of
from uq.result.workload import Workload
from uq.sampling.named_values import fault_lines, parameter_problem, read_settings, unknown_name
from uq.study.installed_models import find_model, model_at, model_names
from uq.study.row_sampling import Rows, row_seeds

STANDARD_ERRORS = 4.0
"""Smallest difference between two values, in standard errors, that separates attractors."""


Compared = tuple[Floats, Floats, float]
"""Values of every row, shape (n,), where NaN equals NaN and infinity equals infinity; their
standard errors, 0 if unknown; and the tolerance relative to the largest finite magnitude of the
values, 0 for exact equality."""

Axis = tuple[float, float, int]
"""First value, last value, number of values."""


def attractors(compared: Sequence[Compared], rows: int) -> NDArray[np.int32]:
    """Return the attractor number of each row; 0 is the most frequent attractor.

    Rows are split at every gap of every output, and the parts again until no gap is left. A branch
    of responses that changes with a parameter is therefore one attractor.

    Parameters
    ----------
    compared : sequence of Compared
    rows : int

    Returns
    -------
    ndarray of int32, shape (rows,)
        Of equally frequent attractors, the first to occur has the lower number.
    """
    labels, count = np.zeros(rows, np.int64), 0
    while count < (count := len(np.unique(labels))):
        for values, errors, tolerance in compared:
            labels = _parted(labels, values, errors, tolerance)
    _, first, place, frequency = np.unique(
        labels, return_index=True, return_inverse=True, return_counts=True
    )
    rank = np.empty(len(first), np.int32)
    rank[np.lexsort((first, -frequency))] = np.arange(len(first))
    return rank[place]


def _parted(
    labels: NDArray[np.int64], values: Floats, errors: Floats, tolerance: float
) -> NDArray[np.int64]:
    """Split each group of rows at the gaps of one output."""
    size = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    order = np.lexsort((values, labels))
    values, errors, groups = values[order], errors[order], labels[order]
    lower, upper = values[:-1], values[1:]
    slack = tolerance * size + STANDARD_ERRORS * np.hypot(errors[:-1], errors[1:])
    with np.errstate(invalid="ignore"):
        alike = (lower == upper) | (upper - lower <= slack) | (np.isnan(lower) & np.isnan(upper))
    new = np.concatenate([[False], ~alike | (groups[:-1] != groups[1:])])[: len(labels)]
    parted = np.empty_like(labels)
    parted[order] = np.cumsum(new)
    return parted


@dataclass(frozen=True)
class ParameterGrid:
    """Rows of a model on the points of a grid, the last axis running fastest.

    Attributes
    ----------
    model : Model
    reference : str
        Reference of the model for other processes; empty if not importable.
    axes : dict of str to Axis
        Of the parameters that vary.
    constants : dict of str to float
        All other parameters.
    settings : object
        An instance of ``model.settings``.
    """

    model: Model
    reference: str
    axes: Mapping[str, Axis]
    constants: dict[str, float]
    settings: Any

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of values on each axis."""
        return tuple(count for _, _, count in self.axes.values())

    @property
    def rows(self) -> int:
        """Number of points."""
        return prod(self.shape)

    def values(self, name: str) -> Floats:
        """Return the values along an axis."""
        return np.linspace(*self.axes[name])

    def block(self, start: int, stop: int) -> Rows:
        """Return the rows start..stop, as in `uq.study.row_sampling.row_block`."""
        number = np.arange(start, stop)
        places = dict(zip(self.axes, np.unravel_index(number, self.shape), strict=True))
        x = np.empty((len(number), len(self.model.parameter_names)))
        for i, name in enumerate(self.model.parameter_names):
            x[:, i] = self.values(name)[places[name]] if name in places else self.constants[name]
        return Rows.without_design(x, row_seeds(0, number))


def grid_of(
    model: str | Model,
    axes: Mapping[str, Axis],
    fixed: Mapping[str, float],
    settings: Mapping[str, Any],
) -> ParameterGrid:
    """Check and build a grid.

    Parameters
    ----------
    model : str or Model
    axes : dict of str to Axis
    fixed : dict of str to float
        Other parameters with values that are not nominal.
    settings : dict
        Numerical settings by name.

    Returns
    -------
    ParameterGrid

    Raises
    ------
    InputError
        All faults, one line each.
    """
    if isinstance(model, str):
        resolved, reference = model_at(model), model
    else:
        installed = model.name in model_names() and find_model(model.name) is model
        resolved, reference = model, model.name if installed else ""
    for argument, given in (("axes", axes), ("fixed", fixed), ("settings", settings)):
        if not isinstance(given, Mapping):
            raise InputError(f"{argument} must be a dictionary with names as keys: {given!r}")
    faults = [] if axes else ["axes: nothing varies; give at least one parameter its values"]
    wrong_axes = {name: _axis_problem(resolved, name, axis) for name, axis in axes.items()}
    twice = dict.fromkeys(axes, "is among the axes too; keep one of the two")
    wrong_fixed = {
        name: twice.get(name) or parameter_problem(resolved, name, value)
        for name, value in fixed.items()
    }
    frozen, wrong = read_settings(resolved, settings)
    faults += fault_lines("axes: ", axes, wrong_axes) + fault_lines("fixed: ", fixed, wrong_fixed)
    if faults := faults + fault_lines("settings: ", settings, wrong):
        raise InputError(*faults)
    return ParameterGrid(
        resolved.given(frozen),
        reference,
        {name: (float(a), float(b), index(n)) for name, (a, b, n) in axes.items()},
        {
            name: float(x)
            for name, x in (resolved.nominal | dict(fixed)).items()
            if name not in axes
        },
        frozen,
    )


def _axis_problem(model: Model, name: str, axis: Any) -> str | None:
    try:
        first, last, count = axis
        enough = index(count) >= 2
    except (TypeError, ValueError):
        return "must be (first value, last value, number of values)"
    problem = parameter_problem(model, name, first) or parameter_problem(model, name, last)
    ascends = enough and not problem and first < last < np.inf
    return problem if ascends or problem else "must ascend, two finite values at least"


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
    """Compute basins of attraction: run a model on a parameter grid and identify attractors.

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
    """Yield the values to compare, element by element."""
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
