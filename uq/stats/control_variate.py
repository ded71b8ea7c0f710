"""Control variates: an estimate corrected by a correlated quantity of known mean.

The mean of n rows is corrected by their error in a cheap quantity, whose mean is known from many
more rows: m - b (c_n - c_M).
"""

import numpy as np
import scipy  # which imports scipy.stats when it is first used

from uq.contract import Floats, Mask
from uq.stats import intervals
from uq.stats.estimate import Estimate
from uq.stats.quantile_functions import student

FEWEST = 5
"""With fewer hits, or misses, a control does not improve a share."""

_AGAINST = 5  # hits that count against a control


def controlled_mean(
    values: Floats, kept: Mask, *, controls: Floats, many: Floats
) -> tuple[Estimate, float]:
    """Estimate the mean of the values of rows that have one.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Of independent rows; only those kept are used.
    kept : ndarray of bool, shape (n,)
        Where there is a value. The share of such rows is an estimate too: the mean is a ratio.
    controls : ndarray, shape (n, k)
        Cheap quantities of the same rows.
    many : ndarray, shape (M, k)
        The same quantities of other independent rows.

    Returns
    -------
    estimate : Estimate
    reduction : float
        Variance of the plain estimate over that of this one: how many times more rows would be as
        good.
    """
    plain = values[kept].mean()
    n, k = len(values), controls.shape[1]
    # Errors of the ratio, to first order.
    errors = np.where(kept, np.where(kept, values, 0.0) - plain, 0.0) / kept.mean()
    slope, reduction = _regressed(errors, controls, np.ones(n), len(many))
    value = float(plain - slope @ (controls.mean(axis=0) - many.mean(axis=0)))
    if n < k + 3 or intervals.is_constant(values[kept]):
        return Estimate(float(plain)), 1.0
    wide = student(intervals.upper_probability(), n - 1 - k)
    half = wide * errors.std(ddof=1 + k) / np.sqrt(n * reduction)
    return Estimate(value, value - float(half), value + float(half)), reduction


def controlled_share(
    hits: Mask, kept: Mask, *, control: Floats, many: Floats
) -> tuple[Estimate, float]:
    """Estimate the share of hits among the rows kept, from hits of a cheap quantity.

    Parameters
    ----------
    hits, kept : ndarray of bool, shape (n,)
    control : ndarray, shape (n,)
        Larger where a hit is likelier, or smaller; NaN where there is none.
    many : ndarray, shape (M,)
        The same quantity of other independent rows.

    Returns
    -------
    estimate : Estimate
        A hit of the control is a value beyond a limit that as many rows exceed as there are hits.
        The interval is that of a share (`uq.stats.intervals.binomial_interval`) for the equivalent
        number of independent plain rows. With fewer than `FEWEST` hits, or misses, the value of the
        control is unknown, and the estimate is that of the plain rows.
    reduction : float
        As in `controlled_mean`.

    Notes
    -----
    Half a row is added to each of the four cases (hit or not, control beyond or not) where the
    variance is estimated, as in [1]_ for two shares of the same rows: control and hits may agree in
    every row by chance. The gain of the control, seen in the k hits alone, is reduced to k/(k + 5)
    of its estimate. Measured with 300 rows, 5 to 18 hits expected and correlations of 0.5 to 0.999,
    the intervals then cover the truth in 95 to 99 % of cases, without it in 91 to 96 %.

    References
    ----------
    .. [1] A. Agresti, Y. Min, "Simple improved confidence intervals for comparing matched
       proportions", Stat. Med. 24, 729-740 (2005).
    """
    n, count = len(hits), int(hits[kept].sum())
    plain = float(hits[kept].mean())
    rarer = min(count, int(kept.sum()) - count)
    has_control = ~np.isnan(control)
    oriented = _orientation(hits[kept & has_control], control[kept & has_control])
    beyond = _limit(oriented * control[has_control], count)
    if rarer < FEWEST or beyond is None:
        return Estimate(plain, *intervals.share_interval(hits[kept])), 1.0
    exceeding, many_exceeding = (
        1.0 * (oriented * quantity > beyond) for quantity in (control, many)
    )
    errors = np.where(kept, hits - plain, 0.0) / kept.mean()
    padded = np.append(errors, np.array([1, 1, 0, 0]) - plain)
    cases = np.append(exceeding, [1.0, 0.0, 1.0, 0.0])[:, None]
    weight = np.append(np.ones(n), np.full(4, 0.5))
    slope, reduction = _regressed(padded, cases, weight, len(many))
    value = float(np.clip(plain - slope[0] * (exceeding.mean() - many_exceeding.mean()), 0.0, 1.0))
    reduction = 1 + (reduction - 1) * rarer / (rarer + _AGAINST)
    ends = intervals.binomial_interval(value, reduction * kept.sum())
    return Estimate(value, *ends), reduction


def _orientation(hits: Mask, control: Floats) -> float:
    """Return 1 where hits go with large values of the control, -1 where with small ones."""
    if hits.all() or not hits.any():
        return 1.0
    ranks = scipy.stats.rankdata(control)
    return 1.0 if ranks[hits].mean() >= ranks[~hits].mean() else -1.0


def _limit(control: Floats, count: int) -> float | None:
    """Return the limit that `count` values exceed, or None where none or all do."""
    if not 0 < count < len(control):
        return None
    near = np.partition(control, (-count - 1, -count))[[-count - 1, -count]]
    return float(near[0]) if np.isinf(near).any() else float(near.mean())


def _regressed(errors: Floats, controls: Floats, weight: Floats, many: int) -> tuple[Floats, float]:
    """Return the best slope of errors on controls for `many` cheap rows, and the reduction.

    Variance n^-1 Var(e - b c) + M^-1 Var(b c) is least for the slope of regression times
    M/(n + M), and is then Var(e)/n times 1 - R^2 M/(n + M).
    """
    total = weight.sum()
    e = errors - weight @ errors / total
    c = controls - weight @ controls / total
    root = np.sqrt(weight)
    slope = np.linalg.lstsq(root[:, None] * c, root * e, rcond=None)[0]
    spread = float(weight @ e**2)
    explained = float(weight @ (c @ slope) ** 2) / spread if spread else 0.0
    share = many / (len(errors) + many)
    return share * slope, 1.0 / max(1.0 - share * explained, np.finfo(float).eps)
