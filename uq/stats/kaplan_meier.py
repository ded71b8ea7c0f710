"""Kaplan-Meier estimate of the survival of lives, some censored and some infinite."""

from typing import NamedTuple

import numpy as np

from uq.contract import Floats, Mask


class SurvivalCurve(NamedTuple):
    """Share that outlives each time, and the variance of that estimate from independent rows."""

    share: Floats
    variance: Floats


def outliving(
    values: Floats, censored: Mask, time: Floats, *, known_at_once: bool
) -> SurvivalCurve:
    """Estimate the share that outlives each time.

    Parameters
    ----------
    values : ndarray, shape (n,)
        +inf for rows that never end.
    censored : ndarray of bool, shape (n,)
    time : ndarray
        [s]
    known_at_once : bool
        Whether every censored row is one that ends.

    Returns
    -------
    SurvivalCurve

    Notes
    -----
    With p the share of the n rows that end, and S the estimate of Kaplan and Meier among these,
    the share that outlives t is 1 - p + p S(t). Given how many rows end, the bias of S is
    negligible, so that the errors of p and S are uncorrelated, and the variance is
    (1 - S)^2 p (1 - p) / n + p^2 Var(S), with Greenwood's Var(S). Without censored rows that is
    the variance of the share of all rows, F (1 - F) / n with F = p (1 - S).

    Otherwise a row that never ends is at risk until the last time: p is 1.
    """
    never = np.isposinf(values)
    if not known_at_once:
        return kaplan_meier(np.where(never, time.max(initial=0.0), values), never | censored, time)
    p = 1 - never.mean()
    of_ending = kaplan_meier(values[~never], censored[~never], time)
    share = 1 - p + p * of_ending.share
    spread = (1 - of_ending.share) ** 2 * p * (1 - p) / len(values)
    return SurvivalCurve(share, spread + p**2 * of_ending.variance)


def kaplan_meier(values: Floats, censored: Mask, time: Floats) -> SurvivalCurve:
    """Return Kaplan and Meier's estimate from finite values, with Greenwood's variance.

    scipy's ``ecdf`` gives the first, but the second only within its own intervals.

    References
    ----------
    E. L. Kaplan, P. Meier, "Nonparametric estimation from incomplete observations", J. Am. Stat.
    Assoc. 53, 457-481 (1958).
    """
    ends, count = np.unique(values[~censored], return_counts=True)
    at_risk = len(values) - np.searchsorted(np.sort(values), ends)
    share = np.cumprod((at_risk - count) / at_risk)
    with np.errstate(divide="ignore", invalid="ignore"):
        variance = share**2 * np.cumsum(count / (at_risk * (at_risk - count)))
    # All have ended: certain for these rows, unless some were censored before.
    variance[share == 0] = np.nan if censored.any() else 0.0
    place = np.searchsorted(ends, time, side="right")
    return SurvivalCurve(np.append(1.0, share)[place], np.append(0.0, variance)[place])
