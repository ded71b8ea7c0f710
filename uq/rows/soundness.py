"""Whether a Dataset is a sound result: it may be damaged or come from an untrusted file."""

from collections.abc import Iterator
from typing import Any, get_args

import numpy as np
import xarray as xr

from uq.contract import Kind
from uq.designs.registry import DESIGNS
from uq.rows.weights import WEIGHT, has_weights

_TEXTS = ("title", "source", "study", "study_identity", "design")
_NUMBERS = ("samples", "replicates")
_PLACES = ("replicate", "group", "block", "status")
_ROLES = ("input", "fixed", "output", "censored", "status", "rerun")


def unsound(ds: xr.Dataset) -> str:
    """Return the first fault of a Dataset as a result, or ""."""
    return next(_faults(ds), "")


def _faults(ds: xr.Dataset) -> Iterator[str]:
    for text in _TEXTS:
        if not isinstance(ds.attrs.get(text), str):
            yield f"attribute '{text}' is not text"
    for number in _NUMBERS:
        if not isinstance(ds.attrs.get(number), int | np.integer) or ds.attrs[number] < 1:
            yield f"attribute '{number}' is not a positive number"
    if ds.attrs.get("design") not in DESIGNS:
        yield "its design is unknown"
    if not ds.sizes.get("sample", 0):
        yield "it has no rows"
    for place in _PLACES:
        if place not in ds or ds[place].dims != ("sample",) or ds[place].dtype.kind not in "iu":
            yield f"'{place}' is not one integer per row"
    yield from _nesting_faults(ds)
    if fault := _weight_fault(ds):
        yield fault
    for flag in ("block", "status"):
        if fault := _flag_fault(ds[flag]):
            yield fault
    for name, variable in ds.data_vars.items():
        role = variable.attrs.get("role")
        if role not in _ROLES:
            continue
        if role in ("input", "output", "censored") and variable.dims[:1] != ("sample",):
            yield f"'{name}' has no row dimension"
        if variable.dtype.kind not in "fiu":
            yield f"'{name}' is not numeric"
        texts = (
            ("long_name",) if role in ("status", "censored", "rerun") else ("long_name", "units")
        )
        for attribute in texts:
            if not isinstance(variable.attrs.get(attribute), str):
                yield f"'{name}' lacks the attribute '{attribute}'"
        if role == "output":
            yield from _output_faults(str(name), variable)


def _nesting_faults(ds: xr.Dataset) -> Iterator[str]:
    """Yield what is wrong with samples of several rows."""
    if "world" not in ds.variables:
        return
    for place, size in (("world", ""), ("unit", "units"), ("repeat", "repeats")):
        if place not in ds or ds[place].dims != ("sample",) or ds[place].dtype.kind not in "iu":
            yield f"'{place}' is not one integer per row"
            return
        most = ds.attrs.get(size, np.iinfo(np.int64).max if not size else 0)
        if not isinstance(most, int | np.integer) or not 1 <= most:
            yield f"attribute '{size}' is not a positive number"
        elif ((ds[place].values < 0) | (ds[place].values >= most)).any():
            yield f"'{place}' is out of range"
        elif size and most > ds.sizes["sample"]:
            yield f"attribute '{size}' is larger than the number of rows"


def _output_faults(name: str, variable: xr.DataArray) -> Iterator[str]:
    if variable.attrs.get("kind") not in get_args(Kind):
        yield f"'{name}' is of an unknown kind"
    elif variable.attrs["kind"] == "category" and (fault := _flag_fault(variable)):
        yield fault
    if not isinstance(variable.attrs.get("may_be_undefined"), int | np.integer):
        yield f"'{name}' lacks the attribute 'may_be_undefined'"
    if not isinstance(variable.attrs.get("never_known_at_once", 0), int | np.integer):
        yield f"attribute 'never_known_at_once' of '{name}' is not a number"
    for dim in variable.dims[1:]:
        if dim not in variable.coords:
            yield f"'{name}' lacks the coordinate '{dim}'"


def _weight_fault(ds: xr.Dataset) -> str:
    if not has_weights(ds):
        return ""
    weight = ds[WEIGHT]
    if weight.dims != ("sample",) or weight.dtype.kind != "f":
        return f"'{WEIGHT}' is not one number per row"
    sound = np.isfinite(weight.values).all() and (weight.values >= 0).all() and weight.values.any()
    return "" if sound else f"'{WEIGHT}' is negative, infinite or zero throughout"


def _flag_fault(variable: xr.DataArray) -> str:
    codes: Any = variable.attrs.get("flag_values")
    labels = variable.attrs.get("flag_meanings")
    if codes is None or not isinstance(labels, str) or np.size(codes) != len(labels.split()):
        return f"'{variable.name}' lacks the meaning of its numbers"
    return ""
