"""Quantities of a Dataset on axes: their labels and units."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from uq.errors import InputError, nearest
from uq.render.figures.style import COLOURS
from uq.render.figures.words import in_words, labelled, literal
from uq.result.elements import Floats
from uq.text.units import ReadableUnit, unit_of


def with_quantities(ds: xr.Dataset) -> xr.Dataset:
    """Return a time history of `uq.simulate` as a Dataset with one variable per quantity.

    Parameters
    ----------
    ds : xarray.Dataset
        Returned unchanged if it has no ``trajectory``.

    Returns
    -------
    xarray.Dataset
    """
    if "trajectory" not in ds:
        return ds
    trajectory = ds["trajectory"]
    series = trajectory.reset_coords(drop=True).to_dataset("quantity")
    for quantity in trajectory.transpose("quantity", "time"):
        words = {"units": quantity["units"].item(), "long_name": quantity["meaning"].item()}
        series[quantity["quantity"].item()].attrs = words
    return series


def find(ds: xr.Dataset, name: str) -> xr.DataArray:
    """Return a variable by its name.

    Raises
    ------
    InputError
        When there is none.
    """
    if name not in ds.variables:
        names = [str(other) for other in ds.variables]
        raise InputError(f"no such quantity '{name}'{nearest(name, names)}")
    return ds[name]


def pair(ds: xr.Dataset, x: str, y: str) -> tuple[xr.DataArray, xr.DataArray]:
    """Return two variables broadcast against each other, along one or two dimensions.

    Raises
    ------
    InputError
        When one does not exist, or they are not along one or two dimensions.
    """
    across, up = xr.broadcast(find(ds, x), find(ds, y))
    if across.ndim not in (1, 2):
        dims = ", ".join(map(str, across.dims)) or "nothing"
        raise InputError(f"'{y}' and '{x}' vary along {dims}, not one or two dimensions")
    return across, up


def axis_unit(variables: Sequence[xr.DataArray]) -> ReadableUnit:
    """Return a readable unit for quantities that share an axis: 0.00025 m become 0.25 mm.

    Parameters
    ----------
    variables : sequence of xarray.DataArray
        Numeric.

    Returns
    -------
    ReadableUnit

    Raises
    ------
    InputError
        When their units differ, or they are not numeric.
    """
    for variable in variables:
        if variable.dtype.kind not in "fiub":
            raise InputError(f"'{variable.name}' is not numeric and cannot be drawn")
    units = {str(variable.attrs.get("units", "1")): variable.name for variable in variables}
    if len(units) > 1:
        unlike = ", ".join(f"{name} [{unit}]" for unit, name in units.items())
        raise InputError(f"quantities of different units cannot share an axis: {unlike}")
    (unit,) = units
    return unit_of(unit, max(_largest(variable) for variable in variables))


def label_axes(
    axes: Axes, across: xr.DataArray, up: xr.DataArray, width: int = 26
) -> tuple[ReadableUnit, ReadableUnit]:
    """Label both axes of a panel, and return their units.

    Parameters
    ----------
    axes : Axes
    across, up : xarray.DataArray
        The horizontal and the vertical quantity.
    width : int
        Of a line beside the vertical axis [characters].
    """
    units = axis_unit([across]), axis_unit([up])
    axes.set_xlabel(labelled(across, units[0].name))
    axes.set_ylabel(labelled(up, units[1].name, width))
    return units


def families(
    across: xr.DataArray, up: xr.DataArray, units: Sequence[ReadableUnit]
) -> Iterator[tuple[Floats, Floats, dict[str, Any]]]:
    """Yield the scaled coordinates of each curve along the last dimension, its colour and label."""
    if across.ndim == 1:
        across, up = (variable.expand_dims("") for variable in (across, up))
    for i, (x, y) in enumerate(zip(across.values, up.values, strict=True)):
        name = place_in(across, i) if len(across) > 1 else ""
        style = {"color": COLOURS[i % len(COLOURS)], "label": name}
        yield in_unit(x, units[0]), in_unit(y, units[1]), style


def in_unit(values: Any, unit: ReadableUnit) -> Any:
    """Return values in the unit of an axis."""
    return values * (1 / unit.size)


def place_in(variable: xr.DataArray, i: int) -> str:
    """Return the words for one place along the first dimension: ``left``, ``start 2``."""
    dim = str(variable.dims[0])
    if dim not in variable.coords:
        return f"{dim} {i + 1}"
    value = variable[dim].values[i]
    if isinstance(value, str):
        return literal(value)
    return literal(f"{in_words(variable[dim])} {value:g}")


def _largest(variable: xr.DataArray) -> float:
    values = np.abs(np.asarray(variable.values, float))
    return float(values[np.isfinite(values)].max(initial=0.0))
