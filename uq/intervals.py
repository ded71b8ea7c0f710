"""Intervals of 95 % for means, shares and quantiles, and tolerance bounds.

Rows are either independent (``replicate`` is None) or belong to independent replicates of a
design, given as the replicate's number for each row. Formulas for independent rows are wrong for
the rows of a Latin hypercube or a low-discrepancy sequence, whose estimates scatter less; there
the scatter between replicates is the only witness. Where nothing can be said (one replicate, too
few rows, replicates that agree to the last bit) an interval is ``(nan, nan)``: never one of zero
width.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from uq.exact_shares import are_few, exact_interval

CONFIDENCE = 0.95
ROUNDING = 64 * np.finfo(float).eps
"""Values that differ by less than this part of the largest differ by no more than rounding."""

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Replicates = NDArray[np.integer] | None


class Interval(NamedTuple):
    """Two bounds, or two arrays of bounds, NaN where they are not known."""

    low: Any
    high: Any


UNKNOWN = Interval(np.nan, np.nan)


def is_constant(values: Floats) -> bool:
    """Whether finite values differ by no more than rounding."""
    return bool(np.ptp(values) <= ROUNDING * np.abs(values).max())


def scatter_interval(value: float, estimates: Floats, confidence: float = CONFIDENCE) -> Interval:
    """Return ``value`` +- t s / sqrt(R) from independent estimates of the same number.

    Parameters
    ----------
    value : float
        The estimate from all rows together.
    estimates : ndarray, shape (R,)
        One estimate per replicate.
    confidence : float, optional

    Returns
    -------
    Interval
    """
    count = len(estimates)
    if count < 2 or is_constant(estimates):
        return UNKNOWN
    half = stats.t.ppf(_upper_tail(confidence), count - 1) * stats.sem(estimates)
    return Interval(float(value - half), float(value + half))


def mean_interval(
    values: Floats, replicate: Replicates = None, confidence: float = CONFIDENCE
) -> Interval:
    """Return the interval of the mean.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite.
    replicate : ndarray of int, shape (n,), optional
    confidence : float, optional

    Returns
    -------
    Interval
    """
    if len(values) < 2 or is_constant(values):
        return UNKNOWN
    estimates = values if replicate is None else by_replicate(values, replicate)
    return scatter_interval(values.mean(), estimates, confidence)


def share_interval(
    hits: Mask, replicate: Replicates = None, confidence: float = CONFIDENCE
) -> Interval:
    """Return the interval of a share of rows.

    Parameters
    ----------
    hits : ndarray of bool, shape (n,)
    replicate : ndarray of int, shape (n,), optional
    confidence : float, optional

    Returns
    -------
    Interval
        Wilson's score interval [1]_. For replicates with the number of independent rows that
        would scatter as much, and Student's t for the normal quantile [2]_. Where hits or misses
        are few that of Clopper and Pearson (`uq.exact_shares`), which is conservative; replicates
        then count for no more than their rows, since few hits show little of their scatter.

    References
    ----------
    .. [1] E. B. Wilson, "Probable inference, the law of succession, and statistical inference",
       J. Am. Stat. Assoc. 22, 209-212 (1927).
    .. [2] N. Dean, M. Pagano, "Evaluating confidence interval methods for binomial proportions in
       clustered surveys", J. Surv. Stat. Methodol. 3, 484-503 (2015).
    """
    if len(hits) == 0:
        return UNKNOWN
    if replicate is None:
        return binomial_interval(hits.mean(), len(hits), confidence)
    return _floats(
        scattered_share_interval(
            hits.mean(), by_replicate(hits, replicate), confidence=confidence, rows=len(hits)
        )
    )


def binomial_interval(share: float, rows: float, confidence: float = CONFIDENCE) -> Interval:
    """Return the interval of a share known as well as from so many rows: exact where hits are few.

    Parameters
    ----------
    share : float
    rows : float
        Independent rows that tell as much.
    confidence : float, optional

    Returns
    -------
    Interval
    """
    if are_few(share, rows):
        return _floats(Interval(*exact_interval(share, rows, confidence)))
    return wilson_interval(share, rows, confidence)


def wilson_interval(share: float, rows: float, confidence: float = CONFIDENCE) -> Interval:
    """Return the interval of a share that is known as well as from so many independent rows."""
    return _floats(_wilson(share, rows, stats.norm.ppf(_upper_tail(confidence))))


def scattered_share_interval(
    share: Floats | float,
    estimates: Floats,
    scatter_at: Floats | float | None = None,
    confidence: float = CONFIDENCE,
    rows: Floats | float | None = None,
) -> Interval:
    """Return the interval of a share, or of several, from estimates by replicates.

    Parameters
    ----------
    share : float or ndarray, shape (k,)
        The estimate from all rows together.
    estimates : ndarray, shape (R,) or (R, k)
        By replicate.
    scatter_at : float or ndarray, optional
        The share whose scatter `estimates` show, if it is not exactly `share`.
    confidence : float, optional
    rows : float or ndarray, shape (k,), optional
        Of all replicates together: where hits are few, they count for no more than these.

    Returns
    -------
    Interval
        As in `share_interval`; arrays of shape (k,) if `share` is one.
    """
    at = share if scatter_at is None else scatter_at
    count = len(estimates)
    if count < 2:
        return Interval(*np.full((2, *np.shape(share)), np.nan))
    variance = estimates.var(axis=0, ddof=1) / count
    # A curve of survival may reach 0 as a whole while a replicate's, censored, does not.
    known = (np.ptp(estimates, axis=0) > 0) & (at > 0) & (at < 1)
    worth = at * (1 - at) / np.where(known, variance, np.nan)
    wide = stats.t.ppf(_upper_tail(confidence), count - 1)
    found = _wilson(share, worth, wide)
    if rows is None:
        return found
    normal = stats.norm.ppf(_upper_tail(confidence))
    worth = np.fmin(worth * (normal / wide) ** 2, rows)
    few, exact = are_few(share, rows), exact_interval(share, worth, confidence)
    return Interval(*(np.where(few, *ends) for ends in zip(exact, found, strict=True)))


def is_within(probability: float, rows: int) -> bool:
    """Whether so many values reach a quantile: their ranks, on average, lie at i/(n + 1).

    Rows of replicates count together: their designs spread as evenly, or more so.
    """
    return bool(1 - ROUNDING <= probability * (rows + 1) <= rows + ROUNDING * rows)


def rows_to_reach(probability: float) -> int:
    """Return the least number of values that reach a quantile."""
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
        Infinite as soon as an infinite value takes part; NaN beyond what the values reach, see
        `is_within`.

    References
    ----------
    .. [1] R. J. Hyndman, Y. Fan, "Sample quantiles in statistical packages", Am. Stat. 50,
       361-365 (1996).
    """
    if not is_within(probability, len(values)):
        return np.nan
    # Infinity times zero is no number: numpy interpolates towards a huge number instead.
    huge, finite = np.finfo(float).max / 4, values[np.isfinite(values)]
    found = np.quantile(np.clip(values, -huge, huge), probability, method="median_unbiased")
    if found > finite.max(initial=-huge):
        return np.inf
    return float(found) if found >= finite.min(initial=huge) else -np.inf


def quantile_interval(
    values: Floats, probability: float, replicate: Replicates = None, confidence: float = CONFIDENCE
) -> Interval:
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
    Interval
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
        tail = 1 - _upper_tail(confidence)  # a frozen law would cost more than the rest
        return Interval(
            order_statistic(values, int(stats.binom.ppf(tail, n, probability))),
            order_statistic(values, int(stats.binom.isf(tail, n, probability)) + 1),
        )
    value = quantile(values, probability)
    if np.isnan(value):
        return UNKNOWN
    below = values < value if np.isposinf(value) else values <= value
    low, high = scattered_share_interval(
        probability, by_replicate(below, replicate), below.mean(), confidence
    )
    return Interval(
        quantile(values, low) if low * n >= 1 else np.nan,
        quantile(values, high) if (1 - high) * n >= 1 else np.nan,
    )


def order_statistic(values: Floats, rank: int) -> float:
    """Return the value of this rank, from 1 to n, or NaN beyond."""
    if not 1 <= rank <= len(values):
        return np.nan
    return float(np.partition(values, rank - 1)[rank - 1])


def tolerance_bounds(values: Floats, failed: int, coverage: float, confidence: float) -> Interval:
    """Return two one-sided tolerance bounds from independent rows (Wilks 1941).

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite or +inf.
    failed : int
        Number of further rows without a value: they count as the worst one on each side.
    coverage : float
        Share of all values that a bound must have on its side.
    confidence : float
        Probability that it has.

    Returns
    -------
    Interval
        NaN where there are fewer rows than `rows_needed`.

    References
    ----------
    S. S. Wilks, "Determination of sample sizes for setting tolerance limits", Ann. Math. Stat. 12,
    91-96 (1941).
    """
    n = len(values)
    outside = int(stats.binom.ppf(1 - confidence, n + failed, 1 - coverage)) - failed
    return Interval(order_statistic(values, outside), order_statistic(values, n + 1 - outside))


def rows_needed(coverage: float, confidence: float, failed: int = 0) -> int:
    """Return the least number of rows, `failed` of them failed, that gives a tolerance bound."""
    beyond = failed + 1  # rows that must lie outside the bound
    return beyond + int(stats.nbinom.ppf(confidence, beyond, 1 - coverage))


def by_replicate(values: NDArray[np.generic], replicate: NDArray[np.integer]) -> Floats:
    """Return the mean of each replicate that has rows."""
    counts = np.bincount(replicate)
    sums = np.bincount(replicate, weights=values.astype(float))
    return sums[counts > 0] / counts[counts > 0]


def _wilson(share: Floats | float, rows: Floats | float, z: float) -> Interval:
    """Return Wilson's interval; scipy's wants whole numbers of rows.

    The bounds solve (1 + w) x^2 - (2 p + w) x + p^2 = 0 with w = z^2 / rows. One comes from the
    other by the product of the roots, so that a share of 0 or 1 has a bound of exactly 0 or 1.
    """
    w = z**2 / rows
    high = (share + w / 2 + np.sqrt(w * share * (1 - share) + w**2 / 4)) / (1 + w)
    low = share**2 / (1 + w) / high
    return Interval(low, 1 - (1 - share) ** 2 / (1 + w) / (1 - low))


def _upper_tail(confidence: float) -> float:
    return 0.5 + confidence / 2


def _floats(interval: Interval) -> Interval:
    return Interval(*map(float, interval))
