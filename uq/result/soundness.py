"""Checks of a Dataset that may be damaged or come from an untrusted file."""

import json
from collections.abc import Iterator
from typing import Any, get_args

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Kind, Status, entered_name, high_name
from uq.result.variables import outputs_of
from uq.result.weights import has_rounds, weight_faults
from uq.sampling.designs import DESIGNS
from uq.study.provenance import provenance
from uq.text.literals import read_toml, without_control

_ROWS = 1_000_000  # read at a time
_ROUNDING = 1e-9  # relative, of an input that scales lives and was moved by inspections


def value_faults(ds: xr.Dataset) -> Iterator[str]:
    """Yield inputs, outputs and coordinates with values that no run produces."""
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
                    yield f"'{kept}' {output.absence(value)}, in a valid row"


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


_TEXTS = ("title", "source", "study", "study_identity", "design", "model", "model_version")
_NUMBERS = ("samples", "replicates")
_OPTIONAL_NUMBERS = ("seed", "second_order", "random")
_OF_OUTPUTS = ("thresholds", "joint_bounds")  # tables of [analysis] whose keys are outputs
_PLACES = ("replicate", "group", "block", "status")
_ROLES = ("input", "fixed", "output", "censored", "high", "entered", "status", "rerun")


def unsound(ds: xr.Dataset) -> str:
    """Return the first fault of a Dataset as a result, or ""."""
    return next(_faults(ds), "")


def _faults(ds: xr.Dataset) -> Iterator[str]:
    for name in ds.variables:
        for text in ("role", "kind"):
            if not isinstance(ds[name].attrs.get(text, ""), str):
                yield f"attribute '{text}' of '{name}' is not text"
    for text in _TEXTS:
        if not isinstance(ds.attrs.get(text), str):
            yield f"attribute '{text}' is not text"
    for text in ("code", "study_sha256", "row_name", *provenance()):
        if not isinstance(ds.attrs.get(text, ""), str):
            yield f"attribute '{text}' is not text"
    for number in _NUMBERS:
        if not isinstance(ds.attrs.get(number), int | np.integer) or ds.attrs[number] < 1:
            yield f"attribute '{number}' is not a positive number"
    for number in _OPTIONAL_NUMBERS:
        if not isinstance(ds.attrs.get(number, 0), int | np.integer) or ds.attrs.get(number, 0) < 0:
            yield f"attribute '{number}' is not a number"
    for name in ds.variables:
        if without_control(str(name)) != name:
            yield f"the name of '{name}' has control characters"
    if ds.attrs.get("design") not in DESIGNS:
        yield "its design is unknown"
    if not ds.sizes.get("row", 0):
        yield "it has no rows"
    for place in _PLACES:
        if place not in ds or ds[place].dims != ("row",) or ds[place].dtype.kind not in "iu":
            yield f"'{place}' is not one integer per row"
    yield from _place_faults(ds)
    yield from _nesting_faults(ds)
    if fault := _repeated_places(ds):
        yield fault
    yield from _study_faults(ds)
    for flag in ("block", "status"):
        if fault := _flag_fault(ds[flag]):
            yield fault
    if "rerun" in ds.variables:
        yield from _rerun_faults(ds["rerun"])
    for name, variable in ds.data_vars.items():
        role = variable.attrs.get("role")
        if role not in _ROLES:
            continue
        if role in ("input", "output", "censored", "high", "entered") and variable.dims[:1] != (
            "row",
        ):
            yield f"'{name}' has no row dimension"
        if (role == "input" and variable.ndim != 1) or (role == "fixed" and variable.ndim):
            yield f"'{name}' is not one number{' per row' * (role == 'input')}"
        yield from _attribute_faults(str(name), variable)
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
    yield from _companion_faults(ds)
    yield from value_faults(ds)
    yield from weight_faults(ds)


def _place_faults(ds: xr.Dataset) -> Iterator[str]:
    """Yield the faults of row numbers and design indices."""
    numbers = ds["row"].values
    if numbers.dtype.kind not in "iu" or (np.diff(numbers) <= 0).any() or numbers[0] < 0:
        yield "'row' does not number the rows in order"
    samples, replicates = int(ds.attrs["samples"]), int(ds.attrs["replicates"])
    if samples * replicates > len(numbers):
        yield f"its {len(numbers)} rows are fewer than its samples"
    for place, most in (("replicate", replicates), ("group", 2**53)):
        if ((ds[place].values < 0) | (ds[place].values >= most)).any():
            yield f"'{place}' is out of range"


def _repeated_places(ds: xr.Dataset) -> str:
    """Return a fault if design indices are duplicated, else ""; added rows are exempt."""
    if has_rounds(ds):
        return ""
    place = np.zeros(ds.sizes["row"], dtype=np.int64)
    for name in ("group", "replicate", "block", "unit", "repeat"):
        if name in ds.variables and (ds[name].values != ds[name].values[:1]).any():
            _, code = np.unique(ds[name].values, return_inverse=True)
            place = np.unique(place * (int(code.max()) + 1) + code, return_inverse=True)[1]
    return "" if place.max() == len(place) - 1 else "several rows have one place in the design"


def _rerun_faults(variable: xr.DataArray) -> Iterator[str]:
    """Yield the faults of the settings of rows that were computed again."""
    if variable.dims != ("row",) or variable.dtype.kind not in "iu":
        yield "'rerun' is not one integer per row"
    if fault := _flag_fault(variable):
        yield fault
    for name, text in variable.attrs.items():
        if name.startswith("changed_") and not _is_table(text):
            yield f"attribute '{name}' of 'rerun' is not a table"


def _is_table(text: Any) -> bool:
    try:
        return isinstance(read_toml(f"settings = {text}")["settings"], dict)
    except (ValueError, OverflowError, RecursionError):
        return False


def _study_faults(ds: xr.Dataset) -> Iterator[str]:
    """Yield inputs and outputs of the study that are missing from the result."""
    try:
        study = read_toml(ds.attrs["study"])
    except (ValueError, OverflowError, RecursionError):
        return  # reported by whoever needs the study
    analysis = _table(study, "analysis")
    shown = analysis.get("outputs", [])
    named = (
        [*_table(study, "uncertain")],
        [
            *(shown if isinstance(shown, list) else []),
            *(name for key in _OF_OUTPUTS for name in _table(analysis, key)),
        ],
    )
    for verb, role, names in zip(("varies", "asks for"), ("input", "output"), named, strict=True):
        for name in map(str, names):
            if name not in ds.data_vars or ds[name].attrs.get("role") != role:
                yield f"its study {verb} '{name}', which it does not contain"


def _table(tables: Any, key: str) -> dict[str, Any]:
    table = tables.get(key, {})
    return table if isinstance(table, dict) else {}


def _attribute_faults(name: str, variable: xr.DataArray) -> Iterator[str]:
    """Yield optional attributes of a variable with a wrong type, shape or range."""
    attrs = variable.attrs
    admissible: Any = attrs.get("admissible", (-np.inf, np.inf))
    if not _are_numbers(admissible, 2) or not admissible[0] <= admissible[1]:
        yield f"attribute 'admissible' of '{name}' is not two numbers in order"
    if not _are_numbers(attrs.get("accuracy", 1.0), 1):
        yield f"attribute 'accuracy' of '{name}' is not a number"
    for text in ("source", "symbol", "success", "level", "accuracy_setting"):
        if not isinstance(attrs.get(text, ""), str):
            yield f"attribute '{text}' of '{name}' is not text"
    if attrs.get("role") == "censored" and not np.isin(variable.values, (0, 1)).all():
        yield f"'{name}' is neither 0 nor 1 throughout"
    if "scales" in attrs and not _are_exponents(attrs["scales"]):
        yield f"attribute 'scales' of '{name}' is not a table of exponents"


def _are_numbers(value: Any, count: int) -> bool:
    numbers = np.asarray(value)
    return numbers.dtype.kind in "fiu" and numbers.size == count and not np.isnan(numbers).any()


def _are_exponents(text: Any) -> bool:
    try:
        table = json.loads(text)
    except (TypeError, ValueError, RecursionError):
        return False
    return isinstance(table, dict) and all(_are_numbers(power, 1) for power in table.values())


def _nesting_faults(ds: xr.Dataset) -> Iterator[str]:
    """Yield the faults of samples of several rows."""
    if "world" not in ds.variables:
        return
    for place, size in (("world", ""), ("unit", "units_per_sample"), ("repeat", "repeats")):
        if place not in ds or ds[place].dims != ("row",) or ds[place].dtype.kind not in "iu":
            yield f"'{place}' is not one integer per row"
            return
        most = ds.attrs.get(size, np.iinfo(np.int64).max if not size else 0)
        if not isinstance(most, int | np.integer) or not 1 <= most:
            yield f"attribute '{size}' is not a positive number"
        elif ((ds[place].values < 0) | (ds[place].values >= most)).any():
            yield f"'{place}' is out of range"
        elif size and most > ds.sizes["row"]:
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


def _companion_faults(ds: xr.Dataset) -> Iterator[str]:
    """Yield the faults of upper bounds and entries of lives."""
    complete = ds["status"].values == Status.OK
    for name, output in outputs_of(ds).items():
        if not output.is_lifetime:
            continue
        values = ds[name].values[complete]
        for beside, meaning in ((high_name(name), "below"), (entered_name(name), "above")):
            if beside not in ds.variables:
                continue
            if ds[beside].dims != ds[name].dims:
                yield f"'{beside}' has not the dimensions of '{name}'"
                continue
            bounds = ds[beside].values[complete]
            wrong = bounds < values if meaning == "below" else (bounds > values) | (bounds < 0)
            if meaning == "above" and high_name(name) in ds.variables:
                wrong = (bounds >= ds[high_name(name)].values[complete]) | (bounds < 0)
            if (np.isnan(bounds) & ~np.isnan(values) | wrong).any():
                yield f"'{beside}' is {meaning} '{name}' or not a number, in a valid row"


def _flag_fault(variable: xr.DataArray) -> str:
    codes: Any = variable.attrs.get("flag_values")
    labels = variable.attrs.get("flag_meanings")
    if codes is None or not isinstance(labels, str) or np.size(codes) != len(labels.split()):
        return f"'{variable.name}' lacks the meaning of its numbers"
    if np.asarray(codes).dtype.kind not in "iu" or not np.isin(variable.values, codes).all():
        return f"'{variable.name}' has numbers without a meaning"
    return ""
