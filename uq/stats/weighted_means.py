"""Weighted means of numbers between 0 and 1, with confidence intervals.

Rows are independent, or belong to independent parts: the replicates of a design, or samples of
several rows (`uq.stats.intervals`). If few rows determine a mean, its interval is at least as wide
as the binomial interval of a share.
"""

from collections.abc import Callable
from math import inf

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.estimate import Estimate
from uq.stats.importance_weights import (
    effective_rows,
    is_bounded,
    is_negligible,
    largest_share,
    refusal,
    tail_shape,
    too_large,
)
from uq.stats.intervals import (
    CONFIDENCE,
    ONE_ROW,
    ROUNDING,
    Ends,
    exact_interval,
    is_constant,
    outlier_shift,
    scatter_interval,
    sized,
    upper_probability,
    widened_for_outliers,
    wilson_interval,
)
from uq.stats.jumps import widened_for_jumps
from uq.stats.quantile_functions import student

FEW = 20
"""With fewer effective rows on either side, an interval is no narrower than a binomial one."""


BinomialSize = tuple[float, float]
"""Sample size of a binomial interval that another interval must cover, and its extent."""


def binomial_sizes(
    numbers: Floats, weights: Floats | None, dependence: Dependence
) -> list[BinomialSize]:
    """Return the binomial sample sizes that an interval must allow for, if few rows determine it.

    Parameters
    ----------
    numbers : ndarray, shape (n,)
        Between 0 and 1.
    weights : ndarray, shape (n,), or None
    dependence : Dependence

    Returns
    -------
    list of (rows, extent)
        One entry for the mean and one for its complement, if its extent is positive. `rows` is the
        effective sample size, or less if the rows that contribute most have larger weights: an
        unobserved row may have the same weight. If no row contributes, the largest weight is
        assumed. The extent is 1 for up to 20 effective contributing rows and 0 from 40 on. It is
        linear in between, so that the interval is continuous in the weights.
    """
    hits = []
    for side in (numbers, 1 - numbers):
        carried = dependence.sums_of_samples(side if weights is None else weights * side)
        if carried.sum() > 3 * FEW * carried.max(initial=0.0):
            continue  # at least as many effective rows
        extent = float(np.clip(2 - effective_rows(carried) / FEW, 0.0, 1.0))
        if extent > 0:
            worth = np.ones(len(numbers)) if weights is None else weights
            of_samples = dependence.sums_of_samples(worth)
            most = carried.max()
            # Samples with nearly equal contributions count nearly equally.
            heaviest = (of_samples * carried).max() / most if most > 0 else of_samples.max()
            with np.errstate(over="ignore", divide="ignore"):  # for rows of negligible weight
                rows = min(effective_rows(of_samples), float(of_samples.sum() / heaviest))
            hits.append((rows, extent))
    return hits


def fewest_rows(hits: list[BinomialSize]) -> float:
    """Return the smallest binomial sample size; infinite if the list is empty."""
    return min((rows for rows, _ in hits), default=inf)


def widened_to_binomial(
    ends: Ends, hits: list[BinomialSize], of_hits: Callable[[float], Ends]
) -> Ends:
    """Return an interval widened to the binomial intervals, in proportion to their extent.

    Parameters
    ----------
    ends : tuple
        Lower and upper end.
    hits : list of (rows, extent)
    of_hits : function
        Sample size -> binomial interval of the share.
    """
    lows, highs = [ends[0]], [ends[1]]
    for rows, extent in hits:
        low, high = of_hits(rows)
        lows.append(ends[0] + extent * min(0.0, low - ends[0]))
        highs.append(ends[1] + extent * max(0.0, high - ends[1]))
    return min(lows), max(highs)


EXACT = "exact: rows differ only in integrated inputs"
_FEW_CARRY_IT = "too few rows carry the weight; many times the rows are required"


def weighted_part_means(
    numbers: Floats, weights: Floats | None, dependence: Dependence, mean: float | None = None
) -> Floats:
    """Return the linearised weighted mean of each independent part, shape (parts,).

    Without weights all rows count alike. This is the mean of all rows, which is computed unless it
    is given, plus the influence of the part on it. If the law of an input was estimated from all
    rows, the influence on this law is included (`uq.stats.dependent_rows.SharedInfluence`).
    """
    mean = np.average(numbers, weights=weights) if mean is None else mean
    influence = numbers - mean if weights is None else _influence(numbers, weights, mean)
    labels, shared = dependence.labels, dependence.shared
    if labels is None:
        return mean + influence
    if shared is not None:
        labels, influence = shared.labels, shared.added_to(influence)
    _, place = np.unique(labels, return_inverse=True)
    sums = np.bincount(place, weights=influence)
    return np.asarray(mean + len(sums) * sums / len(influence))


def _influence(numbers: Floats, weights: Floats, mean: float) -> Floats:
    """Return the influence of each row on a weighted mean, shape (n,)."""
    return weights * (numbers - mean) / weights.mean()


def weighted_share(
    numbers: Floats,
    weights: Floats | None = None,
    dependence: Dependence = INDEPENDENT,
    hits: list[BinomialSize] | None = None,
    confidence: float = CONFIDENCE,
) -> Estimate:
    """Estimate a weighted mean of numbers between 0 and 1 [1]_.

    Parameters
    ----------
    numbers : ndarray, shape (n,)
        Conditional probabilities given each row.
    weights : ndarray, shape (n,), optional
    dependence : Dependence, optional
    hits : list of (rows, extent), optional
        Binomial sample sizes that the interval must allow for; by default `binomial_sizes`.
    confidence : float, optional

    Returns
    -------
    Estimate
        Mean with Student's interval of the logit, from the influences of the parts. The end on the
        side of the farther outlier is moved by the effect of two more such parts, since samples
        that lack them underestimate the scatter. If at most 20 effective rows determine the mean,
        or its complement, the interval is no narrower than the exact binomial interval, since
        important rows may be missing. This widening decreases to zero at 40 effective rows.

    References
    ----------
    .. [1] A. B. Owen, "Monte Carlo theory, methods and examples" (2013), section 9.2.
    """
    if not (len(numbers) if weights is None else weights.sum()) > 0:
        return Estimate()
    average = float(np.average(numbers, weights=weights))
    mean = float(np.clip(average, 0.0, 1.0))
    part_means = weighted_part_means(numbers, weights, dependence, average)
    parts = len(part_means)
    if parts < 2:
        return Estimate(mean, reason=ONE_ROW if dependence.is_none else "")
    if numbers.min() >= 1 - ROUNDING:  # the complement is only rounding
        mean = 1.0
    if is_constant(numbers if mean <= 0.5 else 1 - numbers) and 0 < mean < 1:
        return Estimate(mean, reason=EXACT)
    low, high = _of_logit(mean, part_means, confidence)
    if 0 < mean < 1:
        outlier = outlier_shift(mean, part_means)
        low, high = max(low + min(outlier, 0.0), 0.0), min(high + max(outlier, 0.0), 1.0)
    hits = binomial_sizes(numbers, weights, dependence) if hits is None else hits
    low, high = widened_to_binomial(
        (low, high), hits, lambda rows: exact_interval(mean, rows, confidence)
    )
    return Estimate(mean, float(low), float(high))


def share_to_compare(numbers: Floats, dependence: Dependence = INDEPENDENT) -> Estimate:
    """Estimate the mean of numbers between 0 and 1, with an interval for use in a difference.

    Parameters
    ----------
    numbers, dependence
        As for `weighted_share`.

    Returns
    -------
    Estimate
        The interval is too narrow for the mean alone: it is only Wilson's if few rows determine the
        mean, and it does not allow for outliers. Two estimates are skewed to the same side, so that
        these effects mostly cancel in their difference; including them would make it too wide.
    """
    if not len(numbers):
        return Estimate()
    average = float(numbers.mean())
    mean = float(np.clip(average, 0.0, 1.0))
    part_means = weighted_part_means(numbers, None, dependence, average)
    if len(part_means) < 2:
        return Estimate(mean)
    hits = binomial_sizes(numbers, None, dependence)
    low, high = widened_to_binomial(
        _of_logit(mean, part_means), hits, lambda rows: wilson_interval(mean, rows)
    )
    return Estimate(mean, low, high)


def _of_logit(
    mean: float, part_means: Floats, confidence: float = CONFIDENCE
) -> tuple[float, float]:
    """Return Student's logit interval of a mean, from the linearised means of the parts."""
    if not 0 < mean < 1:
        return mean, mean
    error = part_means.std(ddof=1) / len(part_means) ** 0.5
    wide = student(upper_probability(confidence), len(part_means) - 1)
    half = wide * error / (mean * (1 - mean))
    low, high = special.expit(special.logit(mean) + half * np.array([-1.0, 1.0])).tolist()
    return low, high


def moments_of_rows(
    values: Floats,
    weights: Floats,
    dependence: Dependence = INDEPENDENT,
    within: Floats | float = 0.0,
) -> tuple[Estimate, Estimate]:
    """Estimate mean and standard deviation from rows with reliable weights [1]_.

    Parameters
    ----------
    values, weights : ndarray, shape (n,)
    dependence : Dependence, optional
    within : ndarray, shape (n,), optional
        Variance of each value, if the value is the mean of a law.

    Returns
    -------
    mean, sd : Estimate
        Estimates with Student's intervals from the influences of the parts; the interval of the
        standard deviation is on the log scale. A single row gives only a mean. The end on the side
        of the farther outlier is moved by the effect of two more such parts. For replicates with
        weighted rows it is moved by two more such rows: eight replicates without a heavy row
        underestimate the scatter and show no outlier.

    References
    ----------
    .. [1] A. B. Owen, "Monte Carlo theory, methods and examples" (2013), section 9.2.
    """
    values, unit = sized(values)  # their squares neither overflow nor vanish
    mean = float(np.average(values, weights=weights))
    if len(values) == 1:
        return Estimate(unit * mean, reason=ONE_ROW), Estimate(reason=ONE_ROW)
    squares = (values - mean) ** 2 + within / unit / unit
    variance = float(np.average(squares, weights=weights))
    of_rows = dependence.inputs is not None and not is_constant(weights)
    influence = _influence(values, weights, mean)
    part_means = weighted_part_means(values, weights, dependence, mean)
    parts = mean + influence if of_rows else part_means
    ends = widened_for_outliers(mean, scatter_interval(mean, part_means), parts)
    ends = widened_for_jumps(mean, ends, influence, dependence.neighbours, CONFIDENCE)
    of_mean = Estimate(unit * mean, unit * ends[0], unit * ends[1])
    size = max(variance, 1e-300)
    relative = weighted_part_means(squares, weights, dependence, variance) / size
    rows = _influence(squares, weights, variance) / size
    parts = 1.0 + rows if of_rows else relative
    away = np.asarray(widened_for_outliers(1.0, scatter_interval(1.0, relative), parts)) - 1.0
    sd = unit * variance**0.5
    return of_mean, Estimate(sd, *(sd * np.exp(away / 2)).tolist())


def weighted_moments(
    values: Floats, weights: Floats, dependence: Dependence = INDEPENDENT, most: float = inf
) -> tuple[Estimate, Estimate]:
    """Estimate mean and standard deviation if the weights are reliable.

    Parameters
    ----------
    values, weights : ndarray, shape (n,)
    dependence : Dependence, optional
    most : float, optional
        Upper limit of the weight of a row, for weights of mean 1.

    Returns
    -------
    mean, sd : Estimate
        The mean is missing, with the reason, if the Pareto k of the weights is too large. The
        standard deviation is missing if a sample carries more than a hundredth of the total weight.
        These criteria must not depend on the values, since samples without an outlier underestimate
        the scatter: of those that a criterion on weight times value accepts, intervals of the mean
        covered 85 % where they cover 91 % of all. The interval of the mean has as many degrees of
        freedom as the kurtosis of the influences allows [1]_.

    References
    ----------
    .. [1] F. E. Satterthwaite, "An approximate distribution of estimates of variance components",
       Biom. Bull. 2, 110-114 (1946).
    """
    mean, sd = moments_of_rows(values, weights, dependence)
    of_samples = dependence.sums_of_samples(weights)
    differ = tail_shape(of_samples) > -inf
    if differ and mean.has_interval:
        mean = _with_freedom_of_kurtosis(mean, weighted_part_means(values, weights, dependence))
    differ &= not is_bounded(most, effective_rows(of_samples))
    why = too_large(largest_share(of_samples), len(of_samples)) if differ else ""
    return if_reliable(mean, weights, dependence, most), Estimate(reason=why) if why else sd


def _with_freedom_of_kurtosis(mean: Estimate, part_means: Floats) -> Estimate:
    """Return a mean with Student's interval of 2 n / (kurtosis - 1) degrees of freedom, if fewer.

    The variance of a sample variance is (kurtosis - 1)/n times its square.
    """
    away = part_means - part_means.mean()
    kurtosis = float(np.mean(away**4) / np.mean(away**2) ** 2) if away.any() else 1.0
    parts = len(away)
    freedom = min(2 * parts / max(kurtosis - 1, 1e-9), parts - 1.0)
    probability = upper_probability(CONFIDENCE)
    wider = student(probability, freedom) / student(probability, parts - 1)
    low, high = (mean.value + wider * (end - mean.value) for end in (mean.low, mean.high))
    return Estimate(mean.value, low, high, mean.reason, mean.assumes)


def if_reliable(
    estimate: Estimate,
    contributions: Floats,
    dependence: Dependence,
    most: float = inf,
    hopeless: str = _FEW_CARRY_IT,
) -> Estimate:
    """Return the estimate, or a missing estimate with the reason if its weights are unreliable.

    Parameters
    ----------
    estimate : Estimate
    contributions : ndarray, shape (n,)
        Weights; for a mean of unbounded numbers, weights times these numbers.
    dependence : Dependence
    most : float, optional
        Upper limit of the weight of a row.
    hopeless : str, optional
        Reason to give if a larger sample would not help.
    """
    of_samples = dependence.sums_of_samples(np.abs(contributions))
    if is_negligible(most, len(of_samples)) or is_bounded(most, effective_rows(of_samples)):
        return estimate
    why = refusal(tail_shape(of_samples), len(of_samples), hopeless)
    return Estimate(reason=why) if why else estimate
