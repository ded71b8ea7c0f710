"""Weighted means of numbers between 0 and 1, with intervals.

Rows are independent, or belong to independent parts: the replicates of a design, or samples of
several rows (`uq.intervals`).
"""

from math import inf

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.estimate import Estimate
from uq.intervals import (
    CONFIDENCE,
    ROUNDING,
    Replicates,
    binomial_interval,
    is_constant,
    scatter_interval,
    upper_probability,
    wilson_interval,
)
from uq.population.smoothing import carries_little, effective_rows, per_sample, refusal, tail_shape
from uq.quantile_functions import student

FEW = 20
"""With fewer effective rows on the rarer side, the interval is no narrower than that of hits."""

EXACT = "exact: rows differ only in what is integrated"


def pulls(numbers: Floats, weights: Floats, part: Replicates) -> Floats:
    """Return what each independent part says of a weighted mean, shape (parts,).

    The mean of all rows, plus the influence of the part on it.
    """
    mean = np.average(numbers, weights=weights)
    influence = weights * (numbers - mean) / weights.mean()
    if part is None:
        return mean + influence
    _, place = np.unique(np.asarray(part), return_inverse=True)
    sums = np.bincount(place, weights=influence)
    return np.asarray(mean + len(sums) * sums / len(numbers))


def weighted_share(
    numbers: Floats,
    weights: Floats | None = None,
    part: Replicates = None,
    cautious: bool | None = None,
    confidence: float = CONFIDENCE,
) -> Estimate:
    """Estimate the mean of numbers between 0 and 1.

    Parameters
    ----------
    numbers : ndarray, shape (n,)
        Probabilities, given what is known of each row.
    weights : ndarray, shape (n,), optional
    part : ndarray of int, shape (n,), optional
        The independent part of each row.
    cautious : bool, optional
        Whether few rows carry the mean; by default `rests_on_few`.
    confidence : float, optional

    Returns
    -------
    Estimate
        With Student's interval of the logit from the parts' influences. The end on the side of the
        farther outlier is moved by what two more such parts would add, since samples without them
        scatter too little. Where fewer than 20 effective rows carry the mean, or its
        complement, it is no narrower than the interval of a share of hits: the rows that
        matter may be missing.
    """
    worth = np.ones(len(numbers)) if weights is None else weights
    if not worth.sum() > 0:
        return Estimate()
    mean = float(np.clip(np.average(numbers, weights=worth), 0.0, 1.0))
    found = pulls(numbers, worth, part)
    parts = len(found)
    if parts < 2:
        return Estimate(mean)
    if numbers.min() >= 1 - ROUNDING:  # the complement has no digits
        mean = 1.0
    if is_constant(numbers if mean <= 0.5 else 1 - numbers) and 0 < mean < 1:
        return Estimate(mean, reason=EXACT)
    low, high = _of_logit(mean, found, confidence)
    if 0 < mean < 1:
        outlier = _outlier(mean, found)
        low, high = max(low + min(outlier, 0.0), 0.0), min(high + max(outlier, 0.0), 1.0)
    if cautious or (cautious is None and rests_on_few(numbers, weights, part)):
        of_hits = binomial_interval(mean, effective_rows(per_sample(worth, part)), confidence)
        low, high = min(low, of_hits[0]), max(high, of_hits[1])
    return Estimate(mean, float(low), float(high))


def share_to_compare(
    numbers: Floats, weights: Floats | None = None, part: Replicates = None
) -> Estimate:
    """Estimate the mean of numbers between 0 and 1, with the interval that a difference needs.

    Parameters
    ----------
    numbers, weights, part
        As for `weighted_share`.

    Returns
    -------
    Estimate
        Its interval alone would be too narrow: it has no more than Wilson's where few rows carry
        the mean, and nothing for outliers. Two estimates are skewed to the same side, so that
        most of this cancels in their difference, which would be too wide with it.
    """
    worth = np.ones(len(numbers)) if weights is None else weights
    if not worth.sum() > 0:
        return Estimate()
    mean = float(np.clip(np.average(numbers, weights=worth), 0.0, 1.0))
    found = pulls(numbers, worth, part)
    if len(found) < 2:
        return Estimate(mean)
    low, high = _of_logit(mean, found)
    if rests_on_few(numbers, weights, part):
        of_hits = wilson_interval(mean, effective_rows(per_sample(worth, part)))
        low, high = min(low, of_hits[0]), max(high, of_hits[1])
    return Estimate(mean, low, high)


def _beyond_outliers(mean: float, found: Floats) -> tuple[float, float]:
    """Return Student's interval, moved by what two more outliers as far would add."""
    low, high = scatter_interval(mean, found)
    move = _outlier(mean, found)
    return low + min(move, 0.0), high + max(move, 0.0)


def _outlier(mean: float, found: Floats) -> float:
    """Return by how much two more parts as far out as the farthest on one side move a mean."""
    return float(2 * ((found.max() - mean) - (mean - found.min())) / len(found))


def _of_logit(mean: float, found: Floats, confidence: float = CONFIDENCE) -> tuple[float, float]:
    """Return Student's interval of the logit of a mean, from what each part says of it."""
    if not 0 < mean < 1:
        return mean, mean
    error = found.std(ddof=1) / len(found) ** 0.5
    wide = student(upper_probability(confidence), len(found) - 1)
    half = wide * error / (mean * (1 - mean))
    low, high = special.expit(special.logit(mean) + half * np.array([-1.0, 1.0])).tolist()
    return low, high


def rests_on_few(numbers: Floats, weights: Floats | None, part: Replicates) -> bool:
    """Whether fewer than 20 effective rows carry a mean, or its complement."""
    worth = np.ones(len(numbers)) if weights is None else weights
    rarer = numbers if np.average(numbers, weights=worth) <= 0.5 else 1 - numbers
    return effective_rows(per_sample(worth * rarer, part)) < FEW


def moments_of_rows(
    values: Floats, weights: Floats, part: Replicates = None
) -> tuple[Estimate, Estimate]:
    """Estimate mean and standard deviation from rows whose weights can be trusted.

    Parameters
    ----------
    values, weights : ndarray, shape (n,)
    part : ndarray of int, shape (n,), optional

    Returns
    -------
    mean, sd : Estimate
        With Student's intervals from the parts' influences, that of the standard deviation by its
        logarithm.
    """
    mean = float(np.average(values, weights=weights))
    squares = (values - mean) ** 2
    variance = float(np.average(squares, weights=weights))
    found = Estimate(mean, *_beyond_outliers(mean, pulls(values, weights, part)))
    relative = pulls(squares, weights, part) / max(variance, 1e-300)
    ends = np.asarray(_beyond_outliers(1.0, relative)) - 1.0
    return found, Estimate(variance**0.5, *(variance**0.5 * np.exp(ends / 2)).tolist())


def weighted_moments(
    values: Floats, weights: Floats, part: Replicates = None
) -> tuple[Estimate, Estimate]:
    """Estimate mean and standard deviation, if weights allow it; see `moments_of_rows`.

    Returns
    -------
    mean, sd : Estimate
        Without interval, and with the reason, where the Pareto k of weight times value, or times
        its square, is too large.
    """
    mean, sd = moments_of_rows(values, weights, part)
    squares = (values - mean.value) ** 2
    return trusted(mean, values, weights, part), trusted(sd, squares, weights, part)


def trusted(
    found: Estimate, numbers: Floats, weights: Floats, part: Replicates, most: float = inf
) -> Estimate:
    """Return an estimate, or why weights times numbers do not allow one.

    Parameters
    ----------
    found : Estimate
    numbers, weights : ndarray, shape (n,)
    part : ndarray of int, shape (n,), or None
    most : float, optional
        The largest weight that a row can have, where numbers are at most 1. If no row can carry
        much of all, 20 effective rows that carry the estimate suffice.
    """
    of_samples = per_sample(np.abs(weights * numbers), part)
    if carries_little(most, len(of_samples)) and effective_rows(of_samples) >= FEW:
        return found
    why = refusal(tail_shape(of_samples), len(of_samples))
    return Estimate(reason=why) if why else found
