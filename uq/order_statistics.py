"""Quantiles, their intervals, and tolerance bounds, from order statistics."""

import numpy as np

from uq.clusters import Clusters
from uq.intervals import (
    CONFIDENCE,
    ROUNDING,
    UNKNOWN,
    Ends,
    Floats,
    Replicates,
    by_replicate,
    scattered_share_interval,
    upper_probability,
)
from uq.quantile_functions import binomial, binomial_exceeded, negative_binomial


def is_within(probability: float, rows: int) -> bool:
    """Whether there are enough values for a quantile: their ranks lie on average at i/(n + 1).

    The rows of all replicates count, since their designs spread at least as evenly.
    """
    return bool(1 - ROUNDING <= probability * (rows + 1) <= rows + ROUNDING * rows)


def rows_to_reach(probability: float) -> int:
    """Return the least number of values that gives a quantile."""
    rarer = min(probability, 1 - probability)
    rows = int(np.ceil(1 / rarer - 1))
    return next(n for n in (rows - 1, rows, rows + 1) if n > 0 and is_within(probability, n))


def quantile(values: Floats, probability: float) -> float:
    """Return the median-unbiased estimate of a quantile (type 8 of [1]_).

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite or infinite.
    probability : float

    Returns
    -------
    float
        Infinite if an infinite value takes part; NaN where there are too few values, see
        `is_within`.

    References
    ----------
    .. [1] R. J. Hyndman, Y. Fan, "Sample quantiles in statistical packages", Am. Stat. 50,
       361-365 (1996).
    """
    if not is_within(probability, len(values)):
        return np.nan
    # Infinity times zero is NaN: numpy interpolates towards a huge number instead.
    huge, finite = np.finfo(float).max / 4, values[np.isfinite(values)]
    found = np.quantile(np.clip(values, -huge, huge), probability, method="median_unbiased")
    if found > finite.max(initial=-huge):
        return np.inf
    return float(found) if found >= finite.min(initial=huge) else -np.inf


def quantile_interval(
    values: Floats, probability: float, replicate: Replicates = None, confidence: float = CONFIDENCE
) -> Ends:
    """Return the interval of a quantile.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite or infinite.
    probability : float
    replicate : ndarray of int, shape (n,), optional
    confidence : float, optional

    Returns
    -------
    low, high : float
        Independent rows: order statistics, by the binomial law [1]_. Replicates: the quantiles at
        both ends of the interval of the share of rows below the quantile [2]_. Bounds may
        be infinite.

    References
    ----------
    .. [1] W. J. Conover, "Practical nonparametric statistics", 3rd ed., Wiley (1999), 3.2.
    .. [2] R. S. Woodruff, "Confidence intervals for medians and other position measures", J. Am.
       Stat. Assoc. 47, 635-646 (1952).
    """
    n = len(values)
    if n == 0:
        return UNKNOWN
    if replicate is None:
        tail = 1 - upper_probability(confidence)
        return (
            order_statistic(values, binomial(tail, n, probability)),
            order_statistic(values, binomial_exceeded(tail, n, probability) + 1),
        )
    value = quantile(values, probability)
    if np.isnan(value):
        return UNKNOWN
    below = values < value if np.isposinf(value) else values <= value
    several = {"rows": n, "samples": replicate.samples} if isinstance(replicate, Clusters) else {}
    low, high = scattered_share_interval(
        probability, by_replicate(below, replicate), below.mean(), confidence, **several
    )
    return (
        quantile(values, low) if low * n >= 1 else np.nan,
        quantile(values, high) if (1 - high) * n >= 1 else np.nan,
    )


def order_statistic(values: Floats, rank: int) -> float:
    """Return the value of this rank, from 1 to n, or NaN beyond."""
    if not 1 <= rank <= len(values):
        return np.nan
    return float(np.partition(values, rank - 1)[rank - 1])


def tolerance_bounds(values: Floats, failed: int, coverage: float, confidence: float) -> Ends:
    """Return two one-sided tolerance bounds from independent rows (Wilks 1941).

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite or +inf.
    failed : int
        Number of further rows without a value: they count as the worst on each side.
    coverage : float
        Share of all values that must lie on the right side of a bound.
    confidence : float
        Probability that it does; 0.95 and 0.95 give the 95/95 bounds.

    Returns
    -------
    low, high : float
        NaN where there are fewer rows than `rows_for_bound`.

    References
    ----------
    S. S. Wilks, "Determination of sample sizes for setting tolerance limits", Ann. Math. Stat. 12,
    91-96 (1941).
    """
    n = len(values)
    outside = binomial(1 - confidence, n + failed, 1 - coverage) - failed
    return order_statistic(values, outside), order_statistic(values, n + 1 - outside)


def rows_for_bound(coverage: float, confidence: float, failed: int = 0) -> int:
    """Return the smallest number of rows, `failed` of them failed, for a tolerance bound.

    References
    ----------
    S. S. Wilks, "Determination of sample sizes for setting tolerance limits", Ann. Math. Stat. 12,
    91-96 (1941).
    """
    beyond = failed + 1  # rows that must lie outside the bound
    return beyond + negative_binomial(confidence, beyond, 1 - coverage)


def mid_ranks(values: Floats) -> Floats:
    """Return the share of values below each, shape (n,), ties counted by half."""
    _, place, counts = np.unique(values, return_inverse=True, return_counts=True)
    middle = np.cumsum(counts) - counts / 2
    return np.asarray(middle[place] / max(len(values), 1))
