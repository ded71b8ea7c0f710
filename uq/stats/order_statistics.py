"""Sample quantiles, their confidence intervals, and tolerance bounds, from order statistics."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.intervals import (
    CONFIDENCE,
    ROUNDING,
    UNKNOWN,
    Ends,
    scattered_share_interval,
    upper_probability,
)
from uq.stats.quantile_functions import binomial, binomial_exceeded, negative_binomial


def is_within(probability: float, rows: int) -> bool:
    """Whether the sample size is sufficient for a quantile: 1/(n + 1) <= p <= n/(n + 1).

    The i-th order statistic has the mean probability i/(n + 1). The rows of all replicates count,
    since their designs are at least as evenly spread.
    """
    return bool(1 - ROUNDING <= probability * (rows + 1) <= rows + ROUNDING * rows)


def rows_to_reach(probability: float) -> int:
    """Return the minimum sample size for a quantile."""
    rarer = min(probability, 1 - probability)
    rows = int(np.ceil(1 / rarer - 1))
    return next(n for n in (rows - 1, rows, rows + 1) if n > 0 and is_within(probability, n))


def quantile(values: Floats, probability: float, is_sorted: bool = False) -> float:
    """Return the median-unbiased estimate of a quantile (type 8 of [1]_).

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite or infinite.
    probability : float
    is_sorted : bool, optional
        Whether the values ascend, so that no search through them is needed.

    Returns
    -------
    float
        Infinite if the interpolation includes an infinite value; NaN if there are too few values,
        see `is_within`.

    References
    ----------
    .. [1] R. J. Hyndman, Y. Fan, "Sample quantiles in statistical packages", Am. Stat. 50,
       361-365 (1996).
    """
    if not is_within(probability, len(values)):
        return np.nan
    huge = np.finfo(float).max / 4
    if is_sorted and -huge < values[0] and values[-1] < huge:
        return _between_neighbours(values, probability)
    if -huge < values.min() and values.max() < huge:
        return float(np.quantile(values, probability, method="median_unbiased"))
    # Infinity times zero is NaN: numpy interpolates towards a huge number instead.
    finite = values[np.isfinite(values)]
    estimate = np.quantile(np.clip(values, -huge, huge), probability, method="median_unbiased")
    if estimate > finite.max(initial=-huge):
        return np.inf
    return float(estimate) if estimate >= finite.min(initial=huge) else -np.inf


def _between_neighbours(ascending: Floats, probability: float) -> float:
    """Return what `numpy.quantile` does of sorted values, to the bit."""
    n, third = len(ascending), 1 / 3.0
    place = n * probability + (third + probability * (1 - third - third)) - 1
    first = min(max(int(np.floor(place)), 0), n - 1)
    low, high = float(ascending[first]), float(ascending[min(first + 1, n - 1)])
    share = place - np.floor(place)
    return high - (high - low) * (1 - share) if share >= 0.5 else low + (high - low) * share


def quantile_interval(
    values: Floats,
    probability: float,
    dependence: Dependence = INDEPENDENT,
    confidence: float = CONFIDENCE,
    ascending: Floats | None = None,
) -> Ends:
    """Return the confidence interval of a quantile.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite or infinite.
    probability : float
    dependence : Dependence, optional
    confidence : float, optional
    ascending : ndarray, shape (n,), optional
        The sorted values, if already available.

    Returns
    -------
    low, high : float
        Independent rows: order statistics, by the binomial law [1]_. Replicates: Woodruff's
        interval, the quantiles at both ends of the interval of the share of rows below the
        quantile [2]_. Bounds may be infinite.

    References
    ----------
    .. [1] W. J. Conover, "Practical nonparametric statistics", 3rd ed., Wiley (1999), 3.2.
    .. [2] R. S. Woodruff, "Confidence intervals for medians and other position measures", J. Am.
       Stat. Assoc. 47, 635-646 (1952).
    """
    n = len(values)
    if n == 0:
        return UNKNOWN
    if dependence.is_none:
        tail = 1 - upper_probability(confidence)
        ordered, is_sorted = (values, False) if ascending is None else (ascending, True)
        return (
            order_statistic(ordered, binomial(tail, n, probability), is_sorted),
            order_statistic(ordered, binomial_exceeded(tail, n, probability) + 1, is_sorted),
        )
    ascending = np.sort(values) if ascending is None else ascending
    value = quantile(ascending, probability, is_sorted=True)
    if np.isnan(value):
        return UNKNOWN
    below = values < value if np.isposinf(value) else values <= value
    samples = dependence.samples
    low, high = scattered_share_interval(
        probability,
        dependence.part_means(below),
        below.mean(),
        confidence,
        rows=None if samples is None else n,
        samples=samples,
    )
    return (
        quantile(ascending, low, is_sorted=True) if low * n >= 1 else np.nan,
        quantile(ascending, high, is_sorted=True) if (1 - high) * n >= 1 else np.nan,
    )


def finite_part(ascending: Floats) -> Floats:
    """Return the finite ones of sorted values, none of which is NaN."""
    first = np.searchsorted(ascending, -np.inf, side="right")
    return ascending[first : np.searchsorted(ascending, np.inf)]


def order_statistic(values: Floats, rank: int, is_sorted: bool = False) -> float:
    """Return the order statistic of this rank, 1 to n; NaN outside this range."""
    if not 1 <= rank <= len(values):
        return np.nan
    if is_sorted:
        return float(values[rank - 1])
    return float(np.partition(values, rank - 1)[rank - 1])


def tolerance_bounds(
    values: Floats, failed: int, coverage: float, confidence: float, is_sorted: bool = False
) -> Ends:
    """Return two one-sided tolerance bounds from independent rows (Wilks 1941).

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite or +inf.
    failed : int
        Number of further rows without a value: they count as the worst on each side.
    coverage : float
        Share of all values within each one-sided bound.
    confidence : float
        Probability of at least this coverage; 0.95 and 0.95 give the 95/95 bounds.
    is_sorted : bool, optional
        Whether the values ascend.

    Returns
    -------
    low, high : float
        NaN if there are fewer rows than `rows_for_bound`.

    References
    ----------
    S. S. Wilks, "Determination of sample sizes for setting tolerance limits", Ann. Math. Stat. 12,
    91-96 (1941).
    """
    n = len(values)
    if n + failed == 0:
        return np.nan, np.nan
    outside = binomial(1 - confidence, n + failed, 1 - coverage) - failed
    ranks = outside, n + 1 - outside
    low, high = (order_statistic(values, rank, is_sorted) for rank in ranks)
    return low, high


def joint_bounds(
    values: Sequence[Floats], failed: int, coverage: float, confidence: float
) -> list[float]:
    """Return joint upper tolerance bounds of several outputs from independent rows (Wald 1943).

    Parameters
    ----------
    values : sequence of ndarray, shape (n,)
        Values of each output, in the same rows; finite or infinite. For a lower bound of an output
        its values have the opposite sign.
    failed : int
        Number of further rows that lack a value: they count as outside the bounds.
    coverage : float
        Share of all rows within all bounds.
    confidence : float
        Probability of at least this coverage.

    Returns
    -------
    list of float
        One bound for each output; NaN if there are fewer rows than `rows_for_bound`.

    Notes
    -----
    Rows are removed one at a time: for each output in turn, the row with the largest remaining
    value [1]_. The last row removed for an output gives its bound. The number of rows removed is
    the number that a bound of a single output leaves outside. The distribution of the coverage
    therefore does not depend on the dependence of the outputs [2]_.

    References
    ----------
    .. [1] A. Wald, "An extension of Wilks' method for setting tolerance limits", Ann. Math. Stat.
       14, 45-55 (1943).
    .. [2] A. Guba, M. Makai, L. Pal, "Statistical aspects of best estimate method - I", Reliab.
       Eng. Syst. Saf. 80, 217-232 (2003).
    """
    n, bounds = len(values[0]), [np.nan] * len(values)
    outside = binomial(1 - confidence, n + failed, 1 - coverage) - failed
    if outside < len(values):
        return bounds
    descending = [
        iter(np.argsort(-output_values, kind="stable").tolist()) for output_values in values
    ]
    left = np.ones(n, dtype=bool)
    for cut in range(outside):
        place = cut % len(values)
        row = next(row for row in descending[place] if left[row])
        left[row], bounds[place] = False, float(values[place][row])
    return bounds


def rows_for_bound(coverage: float, confidence: float, failed: int = 0, bounds: int = 1) -> int:
    """Return the minimum sample size, including `failed` rows, for joint tolerance bounds.

    References
    ----------
    S. S. Wilks, "Determination of sample sizes for setting tolerance limits", Ann. Math. Stat. 12,
    91-96 (1941); for several bounds see `joint_bounds`.
    """
    beyond = failed + bounds  # number of rows outside the bounds
    return beyond + negative_binomial(confidence, beyond, 1 - coverage)


def rows_still_needed(
    rows: int, failed: int, coverage: float, confidence: float, bounds: int = 1
) -> float:
    """Return the total sample size required for tolerance bounds if no further row fails.

    Parameters
    ----------
    rows : int
        Number of rows so far, the failed ones included.
    failed, coverage, confidence, bounds
        As for `rows_for_bound`.

    Returns
    -------
    float
        Infinite if the share of failed rows is at least the share that may lie outside the bounds:
        with this failure rate further rows never give a bound.
    """
    if rows and failed >= (1 - coverage) * rows:
        return np.inf
    return rows_for_bound(coverage, confidence, failed, bounds)


_LARGEST_KEPT = 2**20  # bytes of a column whose order is kept


def ascending_order(column: Floats) -> NDArray[np.intp]:
    """Return the rows in the order of a column, equal values in theirs.

    The orders of short columns are kept: the same inputs are sorted for each output.
    """
    if column.nbytes > _LARGEST_KEPT or column.dtype != float:
        return np.argsort(column, kind="stable")
    return _kept_order(column.tobytes())


@lru_cache(64)
def _kept_order(column: bytes) -> NDArray[np.intp]:
    order = np.argsort(np.frombuffer(column), kind="stable")
    order.flags.writeable = False
    return order


def mid_ranks(values: Floats) -> Floats:
    """Return mid-ranks as shares: the share of values below each value, ties counted by half."""
    _, place, counts = np.unique(values, return_inverse=True, return_counts=True)
    middle = np.cumsum(counts) - counts / 2
    return np.asarray(middle[place] / max(len(values), 1))
