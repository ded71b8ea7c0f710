"""Checks of weights and attributes that inspections have left in a result."""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from uq.result.weights import (
    IMPORTANCE,
    INPUT,
    INSPECTED,
    INSPECTIONS,
    INTEGRATED,
    LAW_FOLLOWS,
    LAW_PULLS,
    LAW_SCORES,
    LEDGER,
    MODEL_ERROR,
    MOST,
    OF_UNIT,
    ONLY_INSPECTED,
    OWN_SIZE,
    ROUND,
    ROWS,
    SCALE_SCORES,
    SCORE,
    UNIT_MOST,
    UNIT_PULLS,
    UNIT_SCALE,
    UNIT_SCORES,
    UNIT_WEIGHT,
    WEIGHT,
    WORLDS,
    has_rounds,
    has_weights,
)

_ROW, _TERM = "row", "term"
_WEIGHTS = {WEIGHT: (_ROW,), UNIT_WEIGHT: (INSPECTED, _ROW)}
_NUMBERS = {
    UNIT_MOST: (INSPECTED,),
    UNIT_SCALE: (INSPECTED, _ROW),
    UNIT_SCORES: (INSPECTED, _ROW, SCORE),
    UNIT_PULLS: (INSPECTED, _ROW, _TERM),
    LAW_PULLS: (_ROW, _TERM),
    LAW_FOLLOWS: (_ROW, _TERM),
    LAW_SCORES: (SCORE,),
    SCALE_SCORES: (_ROW, SCORE),
}
_MAY_BE_ABSENT = (UNIT_SCALE,)  # in rows that do not stand for the unit
_MAY_BE_INFINITE = (UNIT_MOST,)
_TEXTS = (OF_UNIT, ONLY_INSPECTED, "prior_title")
_TOGETHER = (
    (UNIT_WEIGHT, UNIT_MOST),
    (UNIT_SCALE, UNIT_WEIGHT),
    (UNIT_SCORES, UNIT_SCALE),
    (LAW_PULLS, LAW_FOLLOWS),
    (LAW_PULLS, LAW_SCORES),
)
"""Pairs of variables: the first needs the second."""


def weight_faults(ds: xr.Dataset) -> Iterator[str]:
    """Yield the faults of the weights of rows and of the variables behind them."""
    if has_rounds(ds):
        yield from _round_faults(ds)
    if not has_weights(ds):
        return
    for name, dims in _WEIGHTS.items():
        if name in ds.variables:
            if fault := _shape_fault(ds, name, dims):
                yield fault
            if not _are_weights(ds[name].values):
                yield f"'{name}' is negative, infinite or zero throughout"
    for name, dims in _NUMBERS.items():
        if name in ds.variables:
            if fault := _shape_fault(ds, name, dims):
                yield fault
            values = ds[name].values
            absent = np.isnan(values).any() and name not in _MAY_BE_ABSENT
            if absent or (np.isinf(values).any() and name not in _MAY_BE_INFINITE):
                yield f"'{name}' is not finite throughout"
    for name, needed in _TOGETHER:
        if name in ds.variables and needed not in ds.variables:
            yield f"it holds '{name}' without '{needed}'"
    if LAW_PULLS in ds.variables and not _is_count(ds[LAW_PULLS].attrs.get(ROWS)):
        yield f"attribute '{ROWS}' of '{LAW_PULLS}' is not a positive number"
    if SCALE_SCORES in ds.variables and ds[SCALE_SCORES].attrs.get(INPUT) not in ds.variables:
        yield f"attribute '{INPUT}' of '{SCALE_SCORES}' names no input"
    if not _is_number(ds[WEIGHT].attrs.get(MOST, 1.0), 0.0):
        yield f"attribute '{MOST}' of '{WEIGHT}' is not a positive number"
    yield from _attribute_faults(ds)


def _attribute_faults(ds: xr.Dataset) -> Iterator[str]:
    for name in _TEXTS:
        if not isinstance(ds.attrs.get(name, ""), str):
            yield f"attribute '{name}' is not text"
    for name, entry in ((INSPECTIONS, dict), (LEDGER, str)):
        if not _is_list(ds.attrs.get(name, "[]"), entry):
            yield f"attribute '{name}' is not a list in JSON"
    if not _is_number(ds.attrs.get(MODEL_ERROR, 0.0), 0.0):
        yield f"attribute '{MODEL_ERROR}' is not a coefficient of variation"
    if UNIT_WEIGHT not in ds.variables:
        return
    if not _is_count(ds.attrs.get(WORLDS)):
        yield f"attribute '{WORLDS}' is not a positive number"
    if INSPECTED not in ds.coords or ds[INSPECTED].dtype.kind not in "OU":
        yield f"'{INSPECTED}' does not name the units"
    integrated: Any = ds.attrs.get(INTEGRATED)
    if not isinstance(integrated, str) or (integrated and UNIT_SCALE not in ds.variables):
        yield f"attribute '{INTEGRATED}' names no input with '{UNIT_SCALE}'"
    elif integrated and not _is_input(ds, integrated):
        yield f"attribute '{INTEGRATED}' names no input"
    for kept, variable in ds.data_vars.items():
        if variable.attrs.get("role") == "prior":
            learnt = str(kept).removeprefix("prior_")
            if learnt not in ds.data_vars or ds[learnt].dims != variable.dims:
                yield f"'{kept}' is not of the shape of '{learnt}'"
            elif variable.dtype.kind != "f":
                yield f"'{kept}' is not numeric"


def _round_faults(ds: xr.Dataset) -> Iterator[str]:
    """Yield the faults of rows that a sampler has added."""
    if fault := _shape_fault(ds, IMPORTANCE, (_ROW,)):
        yield fault
    elif not _are_weights(ds[IMPORTANCE].values):
        yield f"'{IMPORTANCE}' is negative, infinite or zero throughout"
    if ds[ROUND].dims != (_ROW,) or ds[ROUND].dtype.kind not in "iu":
        yield f"'{ROUND}' is not one integer per row"
    elif not (ds[ROUND].values == 0).any() or (ds[ROUND].values < 0).any():
        yield f"'{ROUND}' is out of range"
    size = np.atleast_1d(ds.attrs.get(OWN_SIZE, ()))
    if len(size) != 2 or not all(map(_is_count, size)):
        yield f"attribute '{OWN_SIZE}' is not two positive numbers"


def _shape_fault(ds: xr.Dataset, name: str, dims: tuple[str, ...]) -> str:
    if name not in ds.variables or ds[name].dims != dims:
        return f"'{name}' is not of the dimensions {', '.join(dims)}"
    return "" if ds[name].dtype.kind == "f" else f"'{name}' does not hold numbers"


def _are_weights(values: Any) -> bool:
    with np.errstate(over="ignore"):
        return bool((values >= 0).all() and 0 < values.sum() and np.isfinite((values**2).sum()))


def _is_count(value: Any) -> bool:
    return isinstance(value, int | np.integer) and bool(value >= 1)


def _is_input(ds: xr.Dataset, name: str) -> bool:
    return name in ds.data_vars and ds[name].attrs.get("role") == "input"


def _is_number(value: Any, least: float) -> bool:
    return isinstance(value, int | float | np.integer | np.floating) and bool(value >= least)


def _is_list(text: Any, entry: type) -> bool:
    try:
        entries = json.loads(text)
    except (TypeError, ValueError, RecursionError):
        return False
    return isinstance(entries, list) and all(isinstance(item, entry) for item in entries)
