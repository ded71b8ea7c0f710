"""Sensitivity from a plain sample: RBD-FAST, Borgonovo's delta and PAWN, by SALib's estimators.

Their scatter is not known: bootstrap intervals of these estimates miss the truth far more often
than they say. Beside each index stands what the same estimate makes of inputs that play no part;
an index below that shows nothing.
"""

import warnings
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from SALib.analyze import pawn
from SALib.analyze.delta import calc_delta
from SALib.analyze.rbd_fast import compute_first_order, permute_outputs, unskew_S1
from scipy.stats import norm, rankdata

from uq.elements import Floats
from uq.intervals import is_constant
from uq.targets import Index, Indices, RefusedError

MIN_ROWS = 64
"""Fewer rows than this leave too few in each slice of an input."""

DUMMIES = 19
"""The largest of 19 is passed by one input in twenty that plays no part."""

_HARMONICS = 10
_TIED = 0.01


def given_data_indices(method: str, x: dict[str, Floats], values: Floats) -> Indices:
    """Estimate the indices of one method.

    Parameters
    ----------
    method : {"rbd-fast", "delta", "pawn"}
    x : dict of str to ndarray, shape (n,)
        The uncertain parameters.
    values : ndarray, shape (n,)
        One number per row, NaN where there is none: the row is left out.

    Returns
    -------
    Indices
        ``S1`` (RBD-FAST), ``delta`` or ``pawn`` (the median over slices); without intervals, with
        `dummy`.

    Raises
    ------
    RefusedError
        Too few rows, a constant output, or one with repeated values where a density is needed.
    """
    kept = np.isfinite(values)
    y = values[kept]
    if len(y) < MIN_ROWS:
        raise RefusedError(f"only {len(y)} of {len(kept)} rows have a value; {MIN_ROWS} are needed")
    if is_constant(y):
        raise RefusedError("the same value in all rows: nothing depends on the inputs")
    name, measure = _METHODS[method]
    dummies = np.random.default_rng(0).random((len(y), DUMMIES))
    columns = np.column_stack([*(column[kept] for column in x.values()), dummies])
    found = measure(columns, y)
    indices = {parameter: Index(float(v)) for parameter, v in zip(x, found, strict=False)}
    dummy = {name: float(found[len(x) :].max())}
    return Indices({name: indices}, dummy=dummy)


def _rbd_fast(x: Floats, y: Floats) -> Floats:
    raw = [compute_first_order(permute_outputs(column, y), _HARMONICS) for column in x.T]
    return unskew_S1(np.array(raw), _HARMONICS, len(y))


def _delta(x: Floats, y: Floats) -> Floats:
    _, counts = np.unique(y, return_counts=True)
    if counts.max() > _TIED * len(y):
        raise RefusedError(
            f"{counts.max()} rows share one value, and delta compares densities; use rbd-fast or"
            " pawn"
        )
    # Delta is the same for any increasing function of y, but its estimate is useless where one
    # grid must serve a long tail. Normal scores have no tails.
    n = len(y)
    y = norm.ppf((rankdata(y) - 0.5) / n)
    grid = np.linspace(y.min(), y.max(), 100)
    # Slices of the input, as many as SALib's: Plischke, Borgonovo, Smith, Eur. J. Oper. Res. 226,
    # 536-550 (2013), section 5.
    slices = min(int(np.ceil(n ** (2 / (7 + np.tanh((1500 - n) / 500))))), 48)
    edges = np.linspace(0, n, slices + 1)
    return np.array([calc_delta(y, grid, column, edges) for column in x.T])


def _pawn(x: Floats, y: Floats) -> Floats:
    names = [str(i) for i in range(x.shape[1])]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # about p-values, which are not used
        return pawn.analyze({"num_vars": len(names), "names": names}, x, y)["median"]


_METHODS: dict[str, tuple[str, Callable[[Floats, Floats], NDArray[np.float64]]]] = {
    "rbd-fast": ("S1", _rbd_fast),
    "delta": ("delta", _delta),
    "pawn": ("pawn", _pawn),
}
