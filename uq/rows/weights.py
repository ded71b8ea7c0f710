"""Rows that inspections have weighted."""

import numpy as np
import xarray as xr

from uq.contract import Floats
from uq.errors import InputError

WEIGHT = "weight"
"""The variable with the weight of each row."""

ONLY_INSPECTED = "only_inspected"
"""Attribute of a result: why no row stands for a unit that was not inspected."""

MOST = "largest_possible"
"""Its attribute: the largest weight that a row can have, where that is known."""


IMPORTANCE, ROUND = "importance", "round"
"""Variables of each row, if a sampler has added rows to those of a design: how much it counts
before any inspection, of mean 1 in expectation; and the round in which it was drawn, 0 by the
design."""


def has_weights(ds: xr.Dataset) -> bool:
    """Whether inspections have weighted the rows of a result."""
    return WEIGHT in ds.variables and ds[WEIGHT].attrs.get("role") == WEIGHT


def has_rounds(ds: xr.Dataset) -> bool:
    """Whether a sampler has added rows to those of a design; replicates are its repetitions."""
    return ROUND in ds.variables and ds[ROUND].attrs.get("role") == IMPORTANCE


def row_weights(ds: xr.Dataset) -> Floats | None:
    """Return the weights of some rows of a result, of mean 1; None where rows have none.

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
    """Return the largest weight that a row can have, infinite where that is not known."""
    return float(ds[WEIGHT].attrs.get(MOST, np.inf)) if has_weights(ds) else np.inf


def refuse_weights(ds: xr.Dataset, what: str, *, but_equal: bool = False) -> None:
    """Refuse a question that weighted rows cannot answer.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    what : str
        The question, such as ``uq levels``.
    but_equal : bool
        Whether equal weights will do: those of units that share only what is integrated.

    Raises
    ------
    InputError
        When rows have weights.
    """
    if has_weights(ds) and not (but_equal and np.ptp(ds[WEIGHT].values) == 0):
        raise InputError(
            f"{what}: not with rows that inspections have weighted; ask it of the result before"
            " 'uq update'"
        )
