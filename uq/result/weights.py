"""Posterior weights of rows: their variables in a result, and checks of them."""

import json
from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from uq.contract import Floats
from uq.errors import InputError
from uq.result.nesting import Nesting

WEIGHT = "weight"
"""The variable with the weight of each row."""

ONLY_INSPECTED = "only_inspected"
"""Attribute of a result: why no row represents an uninspected unit."""

OF_UNIT = "of_unit"
"""Attribute of a result: the inspected unit that all its rows represent."""

SCALE_SCORES, INPUT = "scale_scores", "input"
"""Variable with the law of the integrated input in each row of an inspected unit, and its attribute
with the name of the input."""

LAW_INFLUENCE, LAW_TERMS, ROWS = "learnt_law_pulls", "learnt_law_follows", "rows"
LAW_SCORES = "learnt_law_scores"
"""Variables of each row, if all units share the integrated input
(`uq.stats.dependent_rows.SharedInfluence`);
attribute of the first: the number of rows; and quantiles of the law."""

MOST = "largest_possible"
"""Attribute of the weights: upper bound of the weight of a row, if recorded."""


UNIT_WEIGHT, UNIT_MOST = "unit_weight", "unit_largest_weight"
UNIT_SCALE, UNIT_SCORES, SCORE = "unit_scale", "unit_scale_scores", "score"
UNIT_INFLUENCE, INSPECTED = "unit_law_pulls", "inspected"
"""Variables of each inspected unit, and the dimension of these units."""

INTEGRATED, INSPECTIONS, LEDGER = "integrated_input", "inspections", "ledger"
MODEL_ERROR, NEW_ROWS, WORLDS = "model_error", "new_rows", "worlds"
"""Attributes of a result: model error, number of new rows and worlds of the update."""

IMPORTANCE, ROUND = "importance", "round"
"""Variables of each row, if a sampler has added rows to a design: prior importance weight, with
expectation 1; and the sampling round, 0 for rows of the design."""

INDEPENDENT_ROUNDS = "independent"
"""Attribute of the round: each added row was drawn independently, from a density that was fixed."""

OWN_SIZE = "own_samples_and_replicates"
"""Attribute of a result: samples and replicates of the design, without added rows."""

_SAME = 1e-9  # relative difference of weights attributed to rounding


def has_weights(ds: xr.Dataset) -> bool:
    """Whether inspections, or the choice of next rows, have weighted the rows of a result."""
    return WEIGHT in ds.variables and ds[WEIGHT].attrs.get("role") == WEIGHT


def has_rounds(ds: xr.Dataset) -> bool:
    """Whether a sampler has added rows to a design; replicates are then its repetitions."""
    return ROUND in ds.variables and ds[ROUND].attrs.get("role") == IMPORTANCE


def has_next_rows(ds: xr.Dataset) -> bool:
    """Whether rows have weights since 'uq extend --next' drew some of them."""
    return has_rounds(ds) and bool(ds[ROUND].attrs.get(INDEPENDENT_ROUNDS))


def row_weights(ds: xr.Dataset) -> Floats | None:
    """Return the weights of rows of a result, of mean 1; None if rows have no weights.

    Raises
    ------
    InputError
        When all of them are zero.
    """
    if not has_weights(ds):
        return None
    weights = np.asarray(ds[WEIGHT].values, dtype=float)
    if not weights.sum() > 0:
        raise InputError("the inspections rule these rows out: all have weight 0")
    return np.asarray(weights / weights.mean())


def largest_weight(ds: xr.Dataset) -> float:
    """Return the upper bound of the weight of a row, infinite if not recorded."""
    return float(ds[WEIGHT].attrs.get(MOST, np.inf)) if has_weights(ds) else np.inf


def stand_for_any_unit(ds: xr.Dataset) -> bool:
    """Return whether rows represent any unit: no inspection concerns the units of a result."""
    return not has_weights(ds) or not (ds.attrs.keys() & {OF_UNIT, ONLY_INSPECTED})


def sample_weights(rows: xr.Dataset, place: Nesting, question: str) -> Floats | None:
    """Return the weights of samples whose units were not inspected; None if rows have no weights.

    Parameters
    ----------
    rows : xarray.Dataset
        The independent rows of a result, or samples of several rows.
    place : Nesting
        The nesting of these rows.
    question : str
        The question that needs them, such as ``fleets``.

    Returns
    -------
    ndarray, shape (samples,), or None
        Of mean 1.

    Raises
    ------
    InputError
        When rows represent inspected units, or units of a sample have different weights.
    """
    weights = row_weights(rows)
    if weights is None:
        return None
    if unit := rows.attrs.get(OF_UNIT, ""):
        raise InputError(
            f"no {question}: these rows represent unit '{unit}'; use the whole posterior"
        )
    if why := rows.attrs.get(ONLY_INSPECTED, ""):
        raise InputError(f"no {question}: {why}")
    table = place.table(weights).reshape(place.samples, -1)
    least, most = np.nanmin(table, axis=1), np.nanmax(table, axis=1)
    if (most - least > _SAME * most).any():
        raise InputError(
            f"no {question}: the inspections weight each unit of a sample separately, since units"
            " differ in more than an integrated input; use 'uq summary' for a single unit, or the"
            " result before 'uq update'"
        )
    return np.asarray(most / most.mean())


def refuse_if_weighted(ds: xr.Dataset, question: str) -> None:
    """Refuse a question that weighted rows cannot answer.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    question : str
        The question, such as ``uq twin``.

    Raises
    ------
    InputError
        When rows have weights.
    """
    if has_weights(ds):
        raise InputError(
            f"{question}: not with rows that {weighted_by(ds)}; ask it of the result before"
        )


def weighted_by(ds: xr.Dataset) -> str:
    """Return what has weighted the rows of a result."""
    if has_next_rows(ds):
        return "have weights ('uq extend --next')"
    return "inspections have weighted ('uq update')"


_ROW, _TERM = "row", "term"
_WEIGHTS = {WEIGHT: (_ROW,), UNIT_WEIGHT: (INSPECTED, _ROW)}
_NUMBERS = {
    UNIT_MOST: (INSPECTED,),
    UNIT_SCALE: (INSPECTED, _ROW),
    UNIT_SCORES: (INSPECTED, _ROW, SCORE),
    UNIT_INFLUENCE: (INSPECTED, _ROW, _TERM),
    LAW_INFLUENCE: (_ROW, _TERM),
    LAW_TERMS: (_ROW, _TERM),
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
    (LAW_INFLUENCE, LAW_TERMS),
    (LAW_INFLUENCE, LAW_SCORES),
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
    if LAW_INFLUENCE in ds.variables and not _is_count(ds[LAW_INFLUENCE].attrs.get(ROWS)):
        yield f"attribute '{ROWS}' of '{LAW_INFLUENCE}' is not a positive number"
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
    return "" if ds[name].dtype.kind == "f" else f"'{name}' does not contain numbers"


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
