"""Sensitivity from a plain sample: every method that asks for no design of its own.

RBD-FAST, Borgonovo's delta and HDMR are SALib's estimators; Kolmogorov's distance, which PAWN and
regional sensitivity take, is scipy's. Their scatter is not known: bootstrap intervals of these
estimates miss the truth far more often than they say. Beside each index stands what the same
estimate makes of inputs that play no part; an index below that shows nothing.
"""

from collections.abc import Callable, Mapping
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from SALib.analyze.delta import calc_delta
from SALib.analyze.rbd_fast import compute_first_order, permute_outputs, unskew_S1
from scipy.stats import ks_2samp, norm, rankdata

from uq.indices.hdmr import hdmr_indices
from uq.indices.quantile_oriented import quantile_indices, without_optimism
from uq.indices.regional import ks_distances
from uq.indices.targets import Index, Indices, RefusedError
from uq.intervals import is_constant
from uq.rows.elements import Floats

MIN_ROWS = 64
"""Fewer rows than this leave too few in each slice of an input."""

DUMMIES = 19
"""The largest of 19 is passed by one input in twenty that plays no part."""

MOST_ROWS = {"delta": 10_000, "pawn": 20_000, "rbd-fast": 200_000, "quantile": 200_000}
"""More rows would take long, and tell little more.

On Ishigami's function the estimates from so many scatter by 0.001 to 0.007. Delta is 0.03 to 0.06
too small besides, of which ten times the rows would mend a third.
"""

_HARMONICS = 10
_SLICES = 10
_TIED = 0.01


def given_data_indices(
    method: str, x: dict[str, Floats], values: Floats, quantiles: Mapping[str, float]
) -> Indices:
    """Estimate the indices of one method.

    Parameters
    ----------
    method : {"rbd-fast", "delta", "pawn", "hdmr", "quantile", "regional"}
    x : dict of str to ndarray, shape (n,)
        The uncertain parameters.
    values : ndarray, shape (n,)
        One number per row, NaN where there is none: the row is left out.
    quantiles : dict of str to float
        Name -> probability of each quantile that ``quantile`` is about.

    Returns
    -------
    Indices
        ``S1`` (RBD-FAST), ``delta``, ``pawn`` (the median over slices), ``KS`` (regional), one for
        each of `quantiles`, or those of `uq.indices.hdmr`; without intervals, with `dummy`.

    Raises
    ------
    RefusedError
        Too few rows, a constant output, one with repeated values where a density is needed, one
        that is no event where it must be.
    """
    kept = np.flatnonzero(np.isfinite(values))
    if (n := len(kept)) < MIN_ROWS:
        raise RefusedError(f"only {n} of {len(values)} rows have a value; {MIN_ROWS} are needed")
    if is_constant(values[kept]):
        raise RefusedError("the same value in all rows: nothing depends on the inputs")
    thinned: tuple[str, ...] = ()
    if n > (most := MOST_ROWS.get(method, n)):
        # At random: imported rows may come in an order that means something.
        kept = np.sort(np.random.default_rng(0).choice(kept, most, replace=False))
        thinned = (f"from {most} of {n} rows, chosen at random: all would take long",)
    y, x = values[kept], {parameter: column[kept] for parameter, column in x.items()}
    if method == "hdmr":
        return hdmr_indices(x, y)
    idle = np.random.default_rng(0).random((len(y), DUMMIES))
    columns = np.column_stack([*x.values(), idle])
    if method == "quantile":
        raw, notes = quantile_indices(columns, y, quantiles)
        found = {kind: without_optimism(one, one[len(x) :]) for kind, one in raw.items()}
    else:
        kind, measure = _METHODS[method]
        found, notes = {kind: measure(columns, y)}, ()
    values_of = {
        kind: {parameter: Index(float(v)) for parameter, v in zip(x, one, strict=False)}
        for kind, one in found.items()
    }
    return Indices(
        values_of,
        thinned + notes,
        dummy={k: float(one[len(x) :].max()) for k, one in found.items()},
    )


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
    """Return the median of distances between the law of y in a slice of an input and anywhere.

    SALib's estimate, without the p-values that it takes most of its time for and drops: F. Pianosi,
    T. Wagener, Environ. Model. Softw. 108, 197-207 (2018).
    """
    edges = np.quantile(x, np.arange(_SLICES + 1) / _SLICES, axis=0)
    return np.array([_median_distance(*one, y) for one in zip(x.T, edges.T, strict=True)])


def _median_distance(column: Floats, edges: Floats, y: Floats) -> float:
    slices = [y[(column >= low) & (column < high)] for low, high in pairwise(edges)]
    found = [ks_2samp(one, y, method="asymp").statistic for one in slices if len(one)]
    return float(np.median(found)) if found else np.nan


_METHODS: dict[str, tuple[str, Callable[[Floats, Floats], NDArray[np.float64]]]] = {
    "rbd-fast": ("S1", _rbd_fast),
    "delta": ("delta", _delta),
    "pawn": ("pawn", _pawn),
    "regional": ("KS", ks_distances),
}
