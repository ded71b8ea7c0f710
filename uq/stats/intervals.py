"""Confidence intervals of means and proportions, 95 % by default.

Rows are independent, or dependent within replicates of a design or within samples of several rows
(`uq.stats.dependent_rows.Dependence`). Formulas for independent rows are wrong for the rows of a
Latin hypercube or a low-discrepancy sequence, whose estimates scatter less; their error is
estimated from the scatter between replicates. If no interval exists (one replicate, too few rows,
replicates that agree to the last bit), the result is ``(nan, nan)``, never an interval of zero
width.
"""

from typing import Any

import numpy as np
from scipy import special

from uq.contract import Floats, Mask
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.jumps import widened_for_jumps
from uq.stats.quantile_functions import normal, student

CONFIDENCE = 0.95

ONE_ROW = "a single row does not show any scatter"

ROUNDING = 64 * np.finfo(float).eps
"""Relative difference below which values are equal but for rounding."""

Ends = tuple[Any, Any]
"""Lower and upper end of an interval, or of several (two arrays); NaN if unknown."""

UNKNOWN: Ends = (np.nan, np.nan)

FEW = 20
"""With fewer hits, or fewer misses, the exact interval of Clopper and Pearson is used.

Wilson's lower end exceeds the true share in up to 16 % of samples if one hit is observed, and in up
to 4 % from twenty hits on.
"""


def are_few(share: Floats | float, rows: Floats | float) -> Mask:
    """Whether there are few hits or few misses; false if the share is NaN."""
    rarer = np.minimum(share, 1 - np.asarray(share)) * rows
    return np.asarray(np.round(rarer, 6) < FEW)


def exact_interval(
    share: Floats | float, rows: Floats | float, confidence: float
) -> tuple[Floats, Floats]:
    """Return the exact binomial (Clopper-Pearson) interval [1]_ of one or several shares.

    Parameters
    ----------
    share : float or ndarray, shape (k,)
    rows : float or ndarray, shape (k,)
        Effective number of independent rows; need not be an integer [2]_.
    confidence : float

    Returns
    -------
    low, high : ndarray
        Each misses in at most ``(1 - confidence) / 2`` of samples, less often where hits are few.

    References
    ----------
    .. [1] C. J. Clopper, E. S. Pearson, "The use of confidence or fiducial limits illustrated in
       the case of the binomial", Biometrika 26, 404-413 (1934).
    .. [2] E. L. Korn, B. I. Graubard, "Confidence intervals for proportions with small expected
       number of positive counts estimated from survey data", Surv. Methodol. 24, 193-201 (1998).
    """
    tail = (1 - confidence) / 2
    hits = np.asarray(share * rows, dtype=float)
    # Rounding must not turn zero hits into a fraction of a hit.
    whole = np.round(hits)
    hits = np.where(np.abs(hits - whole) <= 1e-9, whole, hits)
    misses = np.maximum(rows - hits, 0.0)
    low = np.where(hits > 0, special.betaincinv(np.maximum(hits, 1e-9), misses + 1, tail), 0.0)
    high = np.where(misses > 0, special.betainccinv(hits + 1, np.maximum(misses, 1e-9), tail), 1.0)
    return low, high


def weighted_count_interval(
    weights: Floats, largest: float, confidence: float = CONFIDENCE
) -> Ends:
    """Return the interval of the mean of a weighted sum of Poisson counts, by gamma laws [1]_.

    Parameters
    ----------
    weights : ndarray, shape (k,)
        Contribution of each event seen; none if k is 0.
    largest : float
        Weight of an event that might have been seen.
    confidence : float, optional

    Returns
    -------
    low, high : float
        Without an event, zero and ``largest`` times 3.69.

    References
    ----------
    .. [1] M. P. Fay, E. J. Feuer, "Confidence intervals for directly standardized rates", Stat.
       Med. 16, 791-801 (1997).
    """
    tail = (1 - confidence) / 2
    total, variance = float(weights.sum()), float((weights**2).sum())
    low = 0.0
    if total > 0:
        low = variance / total * float(special.gammaincinv(total**2 / variance, tail))
    total, variance = total + largest, variance + largest**2
    if not total > 0:
        return low, 0.0
    return low, variance / total * float(special.gammainccinv(total**2 / variance, tail))


def is_constant(values: Floats) -> bool:
    """Whether finite values are equal but for rounding."""
    low, high = values.min(), values.max()
    return bool(high - low <= ROUNDING * max(abs(low), abs(high)))


def sized(values: Floats) -> tuple[Floats, float]:
    """Return the values scaled by a power of two near the largest, and this power.

    Squares and fourth powers of the scaled values neither overflow nor underflow. Scaling by a
    power of two loses no digits.
    """
    largest = max(-values.min(initial=0.0), values.max(initial=0.0))
    if not np.isfinite(largest):
        largest = np.abs(values).max(where=np.isfinite(values), initial=0.0)
    size = 2.0 ** int(np.clip(np.frexp(largest)[1], -1000, 1000))
    return values / size, size


def scatter_interval(value: float, estimates: Floats, confidence: float = CONFIDENCE) -> Ends:
    """Return Student's interval ``value`` +- t s / sqrt(R) from R independent estimates.

    Parameters
    ----------
    value : float
        The estimate from all rows together.
    estimates : ndarray, shape (R,)
        One estimate per replicate.
    confidence : float, optional

    Returns
    -------
    low, high : float
    """
    count = len(estimates)
    if count < 2 or is_constant(estimates):
        return UNKNOWN
    estimates, size = sized(estimates)
    error = size * (estimates.std(ddof=1) / count**0.5)
    half = student(upper_probability(confidence), count - 1) * error
    return float(value - half), float(value + half)


def log_scatter_interval(estimates: Floats) -> Ends:
    """Return the log-scale confidence interval of a small probability from independent estimates.

    Parameters
    ----------
    estimates : ndarray, shape (R,)
        Not negative.

    Returns
    -------
    low, high : float
        Student's interval of the logarithms about the mean. If any estimate is zero, Student's
        interval of the estimates themselves, not below zero.
    """
    mean = float(estimates.mean())
    if (estimates > 0).all():
        low, high = np.exp(scatter_interval(np.log(mean), np.log(estimates)))
        return low, high
    low, high = scatter_interval(mean, estimates)
    return np.maximum(low, 0.0), high


def mean_interval(
    values: Floats, dependence: Dependence = INDEPENDENT, confidence: float = CONFIDENCE
) -> Ends:
    """Return the confidence interval of a mean.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite.
    dependence : Dependence, optional
    confidence : float, optional

    Returns
    -------
    low, high : float
        Student's t interval [1]_ from the rows, or from the means of the replicates, which is
        widened for the error of jumps (`uq.stats.jumps`). For independent rows or samples the
        interval is widened for two more outliers (`widened_for_outliers`).

    References
    ----------
    .. [1] Student, "The probable error of a mean", Biometrika 6, 1-25 (1908).
    """
    if len(values) < 2 or is_constant(values):
        return UNKNOWN
    mean = float(values.mean())
    ends = interval_of_mean(mean, values, dependence, confidence)
    if not dependence.has_independent_parts:
        return ends
    return widened_for_outliers(mean, ends, dependence.part_means(values))


OUTLYING_ROWS = 2
"""Number of further outliers for which the interval of a mean is widened."""


def widened_for_outliers(
    value: float, ends: Ends, estimates: Floats, more: int = OUTLYING_ROWS
) -> Ends:
    """Return an interval widened for further outliers as extreme as the most extreme estimate.

    Parameters
    ----------
    value : float
    ends : tuple of float
        Student's interval of the estimates about the value.
    estimates : ndarray, shape (n,)
    more : int, optional
        Number of further outliers.

    Returns
    -------
    low, high : float
        The interval with the end on the side of the farther outlier moved outwards. A sample of a
        skewed law that lacks outliers underestimates the scatter, and its mean is biased away from
        that side.
    """
    move = outlier_shift(value, estimates, more)
    return ends[0] + min(move, 0.0), ends[1] + max(move, 0.0)


def outlier_shift(value: float, estimates: Floats, more: int = OUTLYING_ROWS) -> float:
    """Return the shift of a mean by further outliers as extreme as the most extreme estimate."""
    return float(more * ((estimates.max() - value) - (value - estimates.min())) / len(estimates))


def interval_of_mean(
    value: float,
    values: Floats,
    dependence: Dependence = INDEPENDENT,
    confidence: float = CONFIDENCE,
) -> Ends:
    """Return the confidence interval of an estimate from its influence values.

    Parameters
    ----------
    value : float
    values : ndarray, shape (n,)
        The rows themselves, or the influence of each row on the estimate plus a constant.
    dependence : Dependence, optional
    confidence : float, optional

    Returns
    -------
    low, high : float
        As in `mean_interval`.
    """
    if dependence.is_none:
        return scatter_interval(value, values, confidence)
    values, unit = sized(values)  # squares of jumps neither overflow nor vanish
    ends = scatter_interval(value / unit, dependence.part_means(values), confidence)
    low, high = widened_for_jumps(value / unit, ends, values, dependence.neighbours, confidence)
    return unit * low, unit * high


def share_interval(
    hits: Mask, dependence: Dependence = INDEPENDENT, confidence: float = CONFIDENCE
) -> Ends:
    """Return the confidence interval of a proportion of rows.

    Parameters
    ----------
    hits : ndarray of bool, shape (n,)
    dependence : Dependence, optional
    confidence : float, optional

    Returns
    -------
    low, high : float
        Wilson's score interval [1]_. For replicates it uses the effective number of independent
        rows, and Student's t in place of the normal quantile [2]_. If hits or misses are few, it is
        the interval of Clopper and Pearson (`exact_interval`), which is conservative. The
        effective number of rows is then at most the number of rows, since the scatter of replicates
        cannot be estimated from few hits.

    References
    ----------
    .. [1] E. B. Wilson, "Probable inference, the law of succession, and statistical inference",
       J. Am. Stat. Assoc. 22, 209-212 (1927).
    .. [2] N. Dean, M. Pagano, "Evaluating confidence interval methods for binomial proportions in
       clustered surveys", J. Surv. Stat. Methodol. 3, 484-503 (2015).
    """
    if len(hits) == 0:
        return UNKNOWN
    if dependence.is_none:
        return binomial_interval(hits.mean(), len(hits), confidence)
    return _floats(
        scattered_share_interval(
            hits.mean(),
            dependence.part_means(hits),
            confidence=confidence,
            rows=len(hits),
            samples=dependence.samples,
        )
    )


def binomial_interval(share: float, rows: float, confidence: float = CONFIDENCE) -> Ends:
    """Return the interval of a share from an effective sample size: exact if hits are few.

    Parameters
    ----------
    share : float
    rows : float
        Effective number of independent rows.
    confidence : float, optional

    Returns
    -------
    low, high : float
    """
    if are_few(share, rows):
        return _floats(exact_interval(share, rows, confidence))
    return wilson_interval(share, rows, confidence)


def wilson_interval(share: float, rows: float, confidence: float = CONFIDENCE) -> Ends:
    """Return Wilson's score interval of a share from an effective sample size."""
    return _floats(_wilson(share, rows, normal(upper_probability(confidence))))


def scattered_share_interval(
    share: Floats | float,
    estimates: Floats,
    scatter_at: Floats | float | None = None,
    confidence: float = CONFIDENCE,
    rows: Floats | float | None = None,
    samples: int | None = None,
) -> Ends:
    """Return the interval of one or several shares from the estimates of replicates.

    Parameters
    ----------
    share : float or ndarray, shape (k,)
        The estimate from all rows together.
    estimates : ndarray, shape (R,) or (R, k)
        One estimate per replicate.
    scatter_at : float or ndarray, optional
        The share that `estimates` estimate, if it differs from `share`.
    confidence : float, optional
    rows : float or ndarray, shape (k,), optional
        Number of rows of all replicates: the upper limit of the effective number if hits are few.
    samples : int, optional
        Number of samples, if samples have several rows: the effective number if the correlation
        within samples cannot be estimated. Hits are then counted in effective rows.

    Returns
    -------
    low, high : float or ndarray, shape (k,)
        As in `share_interval`; arrays of shape (k,) if `share` is one.
    """
    at = share if scatter_at is None else scatter_at
    count = len(estimates)
    if count < 2:
        return np.full(np.shape(share), np.nan), np.full(np.shape(share), np.nan)
    variance = estimates.var(axis=0, ddof=1) / count
    # A survival curve may reach 0 while the curve of a censored replicate does not.
    estimable = (np.ptp(estimates, axis=0) > 0) & (at > 0) & (at < 1)
    worth = at * (1 - at) / np.where(estimable, variance, np.nan)
    wide = student(upper_probability(confidence), count - 1)
    wilson = _wilson(share, worth, wide)
    if rows is None:
        return wilson
    limit = rows if samples is None else np.where(estimable, rows, np.minimum(rows, samples))
    worth = np.fmin(worth * (normal(upper_probability(confidence)) / wide) ** 2, limit)
    few = are_few(share, rows if samples is None else worth)
    low, high = exact_interval(share, worth, confidence)
    return np.where(few, low, wilson[0]), np.where(few, high, wilson[1])


def _wilson(share: Floats | float, rows: Floats | float, z: float) -> Ends:
    """Return Wilson's interval; scipy's takes only integer numbers of rows.

    The bounds solve (1 + w) x^2 - (2 p + w) x + p^2 = 0 with w = z^2 / rows. The second root is
    computed from the product of the roots, so that a share of 0 or 1 has a bound of exactly 0 or 1.
    """
    w = z**2 / rows
    high = (share + w / 2 + np.sqrt(w * share * (1 - share) + w**2 / 4)) / (1 + w)
    low = share**2 / (1 + w) / high
    return low, 1 - (1 - share) ** 2 / (1 + w) / (1 - low)


def upper_probability(confidence: float = CONFIDENCE) -> float:
    """Return the quantile level of the upper end of an equal-tailed interval."""
    return 0.5 + confidence / 2


def _floats(ends: Ends) -> Ends:
    return float(ends[0]), float(ends[1])
