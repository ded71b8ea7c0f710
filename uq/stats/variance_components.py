"""Variance components of nested rows: samples, units within samples, repeats within units.

Y = mean + A(sample) + B(sample, unit) + C(sample, unit, repeat). Each term has its own variance and
may follow any law. Units are nested in samples: B includes the interaction of units and samples.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.stats.estimate import Estimate
from uq.stats.intervals import CONFIDENCE, ROUNDING, is_constant, upper_probability
from uq.stats.quantile_functions import student

FEWEST_SAMPLES = 8
"""Fewest independent samples for a confidence interval of the shares."""

FARTHEST = 2.0
"""Coefficient by which the most influential sample widens an interval; it is multiplied by the
squared share of this sample in the squared influences. Without such samples the scatter is
underestimated (measured)."""

FEW = f"{FEWEST_SAMPLES} samples are required to estimate its scatter"
ALL_SAME = "all values are the same"
TOO_FEW_ROWS = "fewer than two rows have a value"
TOO_FEW = "fewer than two samples have values in two units, and in two repeats of one"
NO_SCATTER = "no two samples show different shares"


class NestedShares(NamedTuple):
    """Variance components as shares of the variance.

    Attributes
    ----------
    outer, middle, inner : Estimate
        Shares of samples, units and repeats.
    error : Estimate
        Share of the numerical error that each row states; it is included in the other shares.
    variance : float
        The sum of the three components.
    left_out : int
        Number of excluded samples: fewer than two units with a value, or no unit with two repeats
        if there are repeats.
    """

    outer: Estimate
    middle: Estimate
    inner: Estimate
    error: Estimate
    variance: float
    left_out: int


def nested_shares(
    values: Floats,
    errors: Floats | None = None,
    replicate: NDArray[np.integer] | None = None,
    analytic: Floats | None = None,
    weights: Floats | None = None,
) -> NestedShares:
    """Estimate the variance components of samples, units and repeats, as shares of the variance.

    Parameters
    ----------
    values : ndarray, shape (samples, units, repeats)
        NaN if missing. With a single repeat `middle` includes `inner`, which cannot be estimated;
        with a single unit `outer` includes both.
    errors : ndarray, shape (samples, units, repeats), optional
        Standard deviation of the numerical error of each value; NaN if unknown.
    replicate : ndarray of int, shape (samples,), optional
        Replicate of each sample, if only replicates are independent.
    analytic : ndarray, shape (3, samples, units, repeats), optional
        Variances that are known exactly for each row and are added to the components of samples,
        units and repeats. They belong to independent terms that are at their means in `values`.
    weights : ndarray, shape (samples,), optional
        Weights of the samples.

    Returns
    -------
    NestedShares

    Notes
    -----
    Analysis of variance: the components are unbiased for any laws [1]_. Let s_u^2 be the variance
    of the repeats of a unit, b^2 the variance of the unit means of a sample, and m their mean. The
    components are mean(s_u^2), mean(b^2) - mean(s_u^2) / repeats, and var(m) - mean(b^2) / units,
    where means are over samples. If values are missing, the actual numbers of units and repeats are
    used. With weights w of samples the means are weighted. The divisor of var(m) is then
    sum(w) - sum(w^2) / sum(w), which is unbiased for weights that do not depend on m.

    Intervals: Student's t with the jackknife over independent samples (or replicates) [2]_ of a
    share p, on the scale log((p + e) / (1 - p + f)). Here e and f are the noise terms that were
    subtracted from a component. This makes the transformed quantities ratios of mean squares: they
    are positive, approximately log-symmetric, and not degenerate if a component vanishes. Analytic
    variances are added to the components. Coverage is measured in
    `tests/uq/assess/test_coverage_levels.py`.

    References
    ----------
    .. [1] S. R. Searle, G. Casella, C. E. McCulloch, "Variance components", Wiley (1992), 3.
    .. [2] J. N. Arvesen, "Jackknifing U-statistics", Ann. Math. Stat. 40, 2076-2100 (1969).
    """
    analytic = np.zeros((3, *values.shape)) if analytic is None else analytic
    worth = np.ones(len(values)) if weights is None else weights
    terms, whole = _terms(values, errors, analytic, worth)
    independent = np.arange(np.count_nonzero(whole))
    if replicate is not None:
        _, independent = np.unique(replicate[whole], return_inverse=True)
    shares, added, beside, variance = _shares(terms.sum(axis=1))
    left_out = int((~whole & (worth > 0)).sum())
    finite = values[whole][np.isfinite(values[whole])]
    least = ROUNDING * float(np.nan_to_num(np.sqrt(np.abs(variance))))
    scatters = len(finite) > 1 and not is_constant(finite) and np.ptp(finite) > least
    if len(finite) < 2 or not (scatters or variance > 0):
        too_few = TOO_FEW if values[0].size > 1 else TOO_FEW_ROWS
        nothing = Estimate(reason=ALL_SAME if whole.sum() > 1 else too_few)
        return NestedShares(nothing, nothing, nothing, nothing, 0.0, left_out)
    groups = int(independent.max(initial=-1)) + 1
    reason = FEW if replicate is None and groups < FEWEST_SAMPLES else ""
    if groups < 2:
        reason = reason or "a single replicate does not show its scatter"
    if not scatters:
        estimates = [Estimate(share, share, share) for share in shares.tolist()]
    elif reason:
        estimates = [Estimate(share, reason=reason) for share in shares.tolist()]
    else:
        of_groups = np.stack([np.bincount(independent, term) for term in terms])
        without, *_ = _shares(terms.sum(axis=1)[:, None] - of_groups)
        estimates = list(map(_estimate, shares.tolist(), added, beside, without))
    for place in (1, 2):
        if values.shape[place] == 1 and not analytic[place].any():
            estimates[place] = Estimate(reason="needs two of them")
    if errors is None or not np.isfinite(errors).any():
        estimates[3] = Estimate(reason="no row states its error")
    outer, middle, inner, error = estimates
    return NestedShares(outer, middle, inner, error, float(variance), left_out)


def _terms(
    values: Floats, errors: Floats | None, analytic: Floats, worth: Floats
) -> tuple[Floats, Mask]:
    """Return the terms of each sample for `_shares`, and the mask of samples used.

    Returns
    -------
    terms : ndarray, shape (12, n)
        Weighted terms: 1, the weight, mean and squared mean of a sample, its noise, variance of
        units and of repeats, noise of the latter, squared error, and analytic variances of samples,
        units and repeats.
    whole : ndarray of bool, shape (samples,)
    """
    counts = np.isfinite(values).sum(axis=2)
    units = (counts > 0).sum(axis=1)
    repeated = (counts > 1).sum(axis=1)
    enough_units = units > min(values.shape[1] - 1, 1)
    whole = enough_units & ((repeated > 0) | (values.shape[2] == 1)) & (worth > 0)
    values, counts, units, repeated = (
        per_sample[whole] for per_sample in (values, counts, units, repeated)
    )
    present = np.isfinite(values)
    analytic_means = np.where(present, analytic[:, whole], 0.0).sum(axis=(2, 3)) / present.sum(
        axis=(1, 2)
    )
    least = (ROUNDING * np.nanmax(np.abs(values), initial=0.0)) ** 2
    values = values - (np.nanmean(values) if values.size else 0.0)  # squares lose no digits
    has_values = counts > 0
    unit_means, within = _mean_and_variance(values, counts, least)
    means = np.where(has_values, unit_means, np.nan)
    sample_means, between = _mean_and_variance(means, units, least)
    inner = np.divide(
        np.where(counts > 1, within, 0.0).sum(axis=1),
        repeated,
        out=np.zeros(len(values)),
        where=repeated > 0,
    )
    with np.errstate(divide="ignore"):
        floor = inner * np.where(has_values, 1 / counts, 0.0).sum(axis=1) / units
    if values.shape[2] == 1:
        floor = np.zeros(len(values))
    squares = np.zeros(len(values))
    if errors is not None:
        square = errors[whole] ** 2
        stated = np.isfinite(square) & np.isfinite(values)
        sums = np.where(stated, square, 0.0).sum(axis=(1, 2))
        squares = np.divide(sums, stated.sum(axis=(1, 2)), out=squares, where=stated.any((1, 2)))
    worth, ones = worth[whole], np.ones(len(values))
    columns = (sample_means, sample_means**2, between / units, between - floor, inner, floor)
    return np.stack([ones, worth, *columns, squares, *analytic_means]) * worth, whole


def _mean_and_variance(
    values: Floats, counts: NDArray[np.integer], least: float
) -> tuple[Floats, Floats]:
    """Return mean and variance along the last axis; 0 for too few values or pure rounding."""
    present = np.isfinite(values)
    sums = np.where(present, values, 0.0).sum(axis=-1)
    mean = np.divide(sums, counts, out=np.zeros(counts.shape), where=counts > 0)
    squares = np.where(present, values - mean[..., None], 0.0) ** 2
    variance = squares.sum(axis=-1) / np.maximum(counts - 1, 1)
    return mean, np.where(variance > least, variance, 0.0)


def _shares(sums: Floats) -> tuple[Floats, Floats, Floats, Floats]:
    """Return the shares of samples, units, repeats and errors, and the variance.

    Parameters
    ----------
    sums : ndarray, shape (12,) or (12, groups)
        Sums of the terms over all samples, or over all samples except one group.

    Returns
    -------
    shares, added, beside : ndarray, shape (4,) or (4, groups)
        Each share, and the terms e and f that its transformation adds to it and its complement.
    variance : ndarray, shape () or (groups,)
    """
    n, squares, mean, square, noise, middle, inner, floor, error, *analytic = sums
    with np.errstate(divide="ignore", invalid="ignore"):
        noise, floor, error = noise / n, floor / n, error / n
        outer = (square - mean**2 / n) / (n - squares / n) - noise + analytic[0] / n
        middle, inner = (middle + analytic[1]) / n, (inner + analytic[2]) / n
        variance = outer + middle + inner
        noise, floor, nothing = noise / variance, floor / variance, 0.0 * variance
        shares = np.array([outer, middle, inner, error]) / variance
    added = np.array([noise, floor, nothing, nothing])
    return shares, added, np.array([nothing, noise, floor, nothing]), variance


def _estimate(value: float, added: float, beside: float, without: Floats) -> Estimate:
    """Return a share with its jackknife interval, from its leave-one-group-out values."""
    groups = len(without)
    influence = (groups - 1) * (value - without)
    influence = influence - influence.mean()
    squares = influence @ influence
    up, down = value + added, 1 - value + beside
    if not squares > 0:
        return Estimate(value, reason=NO_SCATTER)
    if not (up > 0 and down > 0):
        return Estimate(value, 0.0, 1.0)
    widened = 1 + FARTHEST * float((influence**2).max() / squares) ** 2
    error = np.sqrt(widened * squares / (groups * (groups - 1)))
    half = student(upper_probability(CONFIDENCE), groups - 1) * error * (1 / up + 1 / down)
    middle = np.log(up / down)
    odds = np.exp([middle - half, middle + half])
    low, high = (odds * (1 + beside) - added) / (1 + odds)
    return Estimate(value, max(float(low), 0.0), min(float(high), 1.0))
