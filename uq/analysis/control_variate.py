"""Control variates: what a correlated quantity of known mean says about an estimate.

The mean of n rows is corrected by the error that the same rows make on something cheap, whose mean
many more rows tell: m - b (c_n - c_M).
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from uq import intervals
from uq.estimate import Estimate

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]

FEWEST = 5
"""Hits, or misses, from which a control says more of a share than the rows themselves."""

_AGAINST = 5  # hits that count against a control
_UPPER_TAIL = 0.5 + intervals.CONFIDENCE / 2


class Controlled(NamedTuple):
    """An estimate by control variates.

    Attributes
    ----------
    estimate : Estimate
    reduction : float
        Variance of the plain estimate over that of this one: how many times more rows would have
        done the same.
    """

    estimate: Estimate
    reduction: float


def controlled_mean(values: Floats, kept: Mask, controls: Floats, many: Floats) -> Controlled:
    """Estimate the mean of the values of rows that have one.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Of independent rows; only those kept are looked at.
    kept : ndarray of bool, shape (n,)
        Where there is a value. The share of such rows is an estimate too: the mean is a ratio.
    controls : ndarray, shape (n, k)
        Cheap quantities of the same rows.
    many : ndarray, shape (M, k)
        The same quantities of other independent rows.

    Returns
    -------
    Controlled
    """
    plain = values[kept].mean()
    n, k = len(values), controls.shape[1]
    # Errors of the ratio, to first order.
    errors = np.where(kept, np.where(kept, values, 0.0) - plain, 0.0) / kept.mean()
    slope, reduction = _regressed(errors, controls, np.ones(n), len(many))
    value = float(plain - slope @ (controls.mean(axis=0) - many.mean(axis=0)))
    if n < k + 3 or intervals.is_constant(values[kept]):
        return Controlled(Estimate(float(plain)), 1.0)
    half = stats.t.ppf(_UPPER_TAIL, n - 1 - k) * errors.std(ddof=1 + k) / np.sqrt(n * reduction)
    return Controlled(Estimate(value, value - float(half), value + float(half)), reduction)


def controlled_share(hits: Mask, kept: Mask, control: Floats, many: Floats) -> Controlled:
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
    Controlled
        The control counts where it exceeds what as many rows exceed as there are hits. The interval
        is that of a share (`uq.intervals.binomial_interval`) for the number of independent plain
        rows that would do as well. With fewer than `FEWEST` hits, or misses, nothing shows what the
        control is worth: the plain rows alone count.

    Notes
    -----
    Half a row is added to each of the four cases (hit or not, control beyond or not) where the
    variance is estimated, as in [1]_ for two shares of the same rows: control and hits may agree in
    every row by chance. What the control adds is counted as k/(k + 5) of what it seems to, k the
    number of hits: it is seen in these alone. Measured with 300 rows, 5 to 18 hits expected and
    correlations of 0.5 to 0.999, the intervals then hold the truth in 95 to 99 % of cases, without
    it in 91 to 96 %.

    References
    ----------
    .. [1] A. Agresti, Y. Min, "Simple improved confidence intervals for comparing matched
       proportions", Stat. Med. 24, 729-740 (2005).
    """
    n, count = len(hits), int(hits[kept].sum())
    plain = float(hits[kept].mean())
    rarer = min(count, int(kept.sum()) - count)
    if rarer < FEWEST:
        return Controlled(Estimate(plain, *intervals.share_interval(hits[kept])), 1.0)
    known = ~np.isnan(control)
    oriented = _orientation(hits[kept & known], control[kept & known])
    beyond = _limit(oriented * control[known], count)
    if beyond is None:
        return Controlled(Estimate(plain, *intervals.share_interval(hits[kept])), 1.0)
    here, there = (1.0 * (oriented * some > beyond) for some in (control, many))
    errors = np.where(kept, hits - plain, 0.0) / kept.mean()
    padded = np.append(errors, np.array([1, 1, 0, 0]) - plain)
    cases = np.append(here, [1.0, 0.0, 1.0, 0.0])[:, None]
    weight = np.append(np.ones(n), np.full(4, 0.5))
    slope, reduction = _regressed(padded, cases, weight, len(many))
    value = float(np.clip(plain - slope[0] * (here.mean() - there.mean()), 0.0, 1.0))
    reduction = 1 + (reduction - 1) * rarer / (rarer + _AGAINST)
    ends = intervals.binomial_interval(value, reduction * kept.sum())
    return Controlled(Estimate(value, *ends), reduction)


def _orientation(hits: Mask, control: Floats) -> float:
    """Return 1 where hits go with large values of the control, -1 where with small ones."""
    if hits.all() or not hits.any():
        return 1.0
    ranks = stats.rankdata(control)
    return 1.0 if ranks[hits].mean() >= ranks[~hits].mean() else -1.0


def _limit(control: Floats, count: int) -> float | None:
    """Return what `count` values lie beyond, or None where none or all do."""
    if not 0 < count < len(control):
        return None
    near = np.partition(control, (-count - 1, -count))[[-count - 1, -count]]
    return float(near[0]) if np.isinf(near).any() else float(near.mean())


def _regressed(errors: Floats, controls: Floats, weight: Floats, many: int) -> tuple[Floats, float]:
    """Return the slope of errors on controls that is best for so many cheap rows, and its use.

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
