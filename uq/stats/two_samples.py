"""Difference and ratio of two estimates, with confidence intervals (MOVER)."""

import numpy as np

from uq.stats.estimate import NOTHING, Estimate


def difference(first: Estimate, second: Estimate, correlation: float) -> Estimate:
    """Return the difference, second minus first, with its confidence interval.

    Parameters
    ----------
    first, second : Estimate
    correlation : float
        Correlation of the two estimates; -1 gives a conservative interval.

    Returns
    -------
    Estimate
        Interval by the method of variance estimates recovery (MOVER) [1]_; for shares of
        independent rows it is Newcombe's method [2]_.

    References
    ----------
    .. [1] G. Y. Zou, A. Donner, "Construction of confidence limits about effect measures: a
       general approach", Stat. Med. 27, 1693-1702 (2008).
    .. [2] R. G. Newcombe, "Interval estimation for the difference between independent proportions:
       comparison of eleven methods", Stat. Med. 17, 873-890 (1998).
    """

    def reach(margin: float, other: float) -> float:
        # At least (margin - other)^2; negative values are rounding errors.
        return float(np.sqrt(max(margin**2 + other**2 - 2 * correlation * margin * other, 0.0)))

    value = second.value - first.value
    down = reach(second.value - second.low, first.high - first.value)
    up = reach(second.high - second.value, first.value - first.low)
    return Estimate(value, value - down, value + up)


def ratio(first: Estimate, second: Estimate, correlation: float) -> Estimate:
    """Return the ratio second / first of positive estimates; parameters as in `difference`."""
    if not (first.value > 0 and second.value > 0):
        return NOTHING

    def logarithm(number: float) -> float:
        return float(np.log(number)) if number > 0 else np.nan

    below, above = (
        Estimate(logarithm(estimate.value), logarithm(estimate.low), logarithm(estimate.high))
        for estimate in (first, second)
    )
    return Estimate(*np.exp(difference(below, above, correlation).numbers).tolist())
