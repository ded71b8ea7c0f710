"""The difference and ratio of two estimates, with intervals from the interval of each."""

import numpy as np

from uq.stats.estimate import NOTHING, Estimate


def difference(first: Estimate, second: Estimate, correlation: float) -> Estimate:
    """Return the second less the first, with an interval.

    Parameters
    ----------
    first, second : Estimate
    correlation : float
        Of the two estimates; -1 gives a conservative interval.

    Returns
    -------
    Estimate
        By variance estimates recovery [1]_; for shares of independent rows this is the method of
        [2]_.

    References
    ----------
    .. [1] G. Y. Zou, A. Donner, "Construction of confidence limits about effect measures: a
       general approach", Stat. Med. 27, 1693-1702 (2008).
    .. [2] R. G. Newcombe, "Interval estimation for the difference between independent proportions:
       comparison of eleven methods", Stat. Med. 17, 873-890 (1998).
    """

    def reach(margin: float, other: float) -> float:
        # Negative only by rounding: it is at least (margin - other)^2.
        return float(np.sqrt(max(margin**2 + other**2 - 2 * correlation * margin * other, 0.0)))

    value = second.value - first.value
    down = reach(second.value - second.low, first.high - first.value)
    up = reach(second.high - second.value, first.value - first.low)
    return Estimate(value, value - down, value + up)


def ratio(first: Estimate, second: Estimate, correlation: float) -> Estimate:
    """Return the second over the first, both positive; parameters as in `difference`."""
    if not (first.value > 0 and second.value > 0):
        return NOTHING

    def logarithm(number: float) -> float:
        return float(np.log(number)) if number > 0 else np.nan

    below, above = (
        Estimate(logarithm(estimate.value), logarithm(estimate.low), logarithm(estimate.high))
        for estimate in (first, second)
    )
    return Estimate(*np.exp(difference(below, above, correlation).numbers).tolist())
