"""Checks that the values of a result are possible."""

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Status
from uq.result.variables import outputs_of

_ROWS = 1_000_000  # read at a time
_ROUNDING = 1e-9  # relative, of an input that scales lives and was moved by inspections


def value_faults(ds: xr.Dataset) -> Iterator[str]:
    """Yield which inputs, outputs and coordinates have values that no run leaves behind."""
    for name, variable in ds.data_vars.items():
        role = variable.attrs.get("role")
        if role == "fixed" and np.isnan(variable.values):
            yield f"'{name}' is not a number"
        if role == "input" and (fault := _input_fault(variable)):
            yield f"'{name}' {fault}"
    complete = ds["status"].values == Status.OK
    for name, output in outputs_of(ds).items():
        for dim in output.dims:
            if not _are_labels(ds[dim].values):
                yield f"the coordinate '{dim}' has no distinct labels"
        if output.is_category:
            continue
        for kept in (name, f"prior_{name}"):
            if kept not in ds.data_vars or ds[kept].dims != ds[name].dims:
                continue
            for values, is_complete in _pieces(ds[kept], complete):
                absent = output.is_invalid(values)
                if absent[is_complete].any():
                    value = values[is_complete][absent[is_complete]][0]
                    yield f"'{kept}' {output.absence(value)}, in a row that did not fail"


def _input_fault(variable: xr.DataArray) -> str:
    low, high = map(float, variable.attrs.get("admissible", (-np.inf, np.inf)))
    values = variable.values
    least, most = low - _ROUNDING * abs(low), high + _ROUNDING * abs(high)
    if not ((least <= values) & (values <= most)).all():
        return f"is not within {low:g} to {high:g} in each row"
    return ""


def _are_labels(values: NDArray[Any]) -> bool:
    if values.dtype.kind not in "fiuUO" or (
        values.dtype.kind == "f" and not np.isfinite(values).all()
    ):
        return False
    return len(set(values.tolist())) == len(values)


def _pieces(
    variable: xr.DataArray, complete: NDArray[np.bool_]
) -> Iterator[tuple[NDArray[Any], NDArray[np.bool_]]]:
    """Yield the values of rows block by block, and the mask of complete rows."""
    for first in range(0, len(complete), _ROWS):
        rows = slice(first, first + _ROWS)
        yield variable[rows].values, complete[rows]
