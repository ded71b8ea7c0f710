"""Rows that inspections have weighted."""

import numpy as np
import xarray as xr

from uq.contract import Floats
from uq.errors import InputError
from uq.result.nesting import Nesting

WEIGHT = "weight"
"""The variable with the weight of each row."""

ONLY_INSPECTED = "only_inspected"
"""Attribute of a result: why no row stands for a unit that was not inspected."""

OF_UNIT = "of_unit"
"""Attribute of a result: the inspected unit that all its rows stand for."""

SCALE_SCORES, INPUT = "scale_scores", "input"
"""The variable of rows of an inspected unit with the law of the integrated input in each, and its
attribute: which input."""

LAW_PULLS, LAW_FOLLOWS, ROWS = "learnt_law_pulls", "learnt_law_follows", "rows"
LAW_SCORES = "learnt_law_scores"
"""Variables of each row, if all units share the integrated input
(`uq.stats.clusters.SharedInfluence`);
the attribute of the first: of how many rows they are; and quantiles of the law."""

MOST = "largest_possible"
"""Its attribute: the largest weight that a row can have, if it is recorded."""


UNIT_WEIGHT, UNIT_MOST = "unit_weight", "unit_largest_weight"
UNIT_SCALE, UNIT_SCORES, SCORE = "unit_scale", "unit_scale_scores", "score"
UNIT_PULLS, INSPECTED = "unit_law_pulls", "inspected"
"""Variables of each inspected unit, and the dimension of these units."""

INTEGRATED, INSPECTIONS, LEDGER = "integrated_input", "inspections", "ledger"
MODEL_ERROR, NEW_ROWS, WORLDS = "model_error", "new_rows", "worlds"
"""Attributes of a result: what the inspections were, and how they were used."""

IMPORTANCE, ROUND = "importance", "round"
"""Variables of each row, if a sampler has added rows to those of a design: how much it counts
before any inspection, of mean 1 in expectation; and the round in which it was drawn, 0 by the
design."""

OWN_SIZE = "own_samples_and_replicates"
"""Attribute of a result: of the design, without the rows that a sampler has added."""

_SAME = 1e-9  # relative difference of weights that only rounding tells apart


def has_weights(ds: xr.Dataset) -> bool:
    """Whether inspections have weighted the rows of a result."""
    return WEIGHT in ds.variables and ds[WEIGHT].attrs.get("role") == WEIGHT


def has_rounds(ds: xr.Dataset) -> bool:
    """Whether a sampler has added rows to those of a design; replicates are its repetitions."""
    return ROUND in ds.variables and ds[ROUND].attrs.get("role") == IMPORTANCE


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
    """Return the largest weight that a row can have, infinite if it is not recorded."""
    return float(ds[WEIGHT].attrs.get(MOST, np.inf)) if has_weights(ds) else np.inf


def stand_for_any_unit(ds: xr.Dataset) -> bool:
    """Return whether rows stand for any unit: no inspection concerns the units of a result."""
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
        When rows stand for inspected units, or units of a sample have different weights.
    """
    weights = row_weights(rows)
    if weights is None:
        return None
    if unit := rows.attrs.get(OF_UNIT, ""):
        raise InputError(
            f"no {question}: these rows stand for unit '{unit}'; use the whole posterior"
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


def refuse_weights(ds: xr.Dataset, question: str) -> None:
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
            f"{question}: not with rows that inspections have weighted; ask it of the result before"
            " 'uq update'"
        )
