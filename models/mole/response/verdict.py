"""The regime of a motion that does not repeat: chaotic, quasi-periodic, or undecided.

The largest Lyapunov exponent and its standard error decide. Chaos requires a positive exponent,
quasi-periodicity evidence of its own; an exponent indistinguishable from zero shows neither. If
control and mains have no common period, a motion driven by both follows their phases if neighbours
converge: the exponent is negative. If they have one, such a motion is still settling to one that
repeats. A motion with a frequency of its own has an exponent of zero, which an average can approach
but never equal.
"""

import numpy as np
from numpy.typing import NDArray

from models.mole.parameters import CHAOTIC, QUASI_PERIODIC, UNDECIDED
from models.numerics.batch_means import mean_and_error

SURE = 3.0
"""Standard errors by which an exponent must differ from another number."""

NEAR_ZERO = 0.01
"""Bound of the exponent times the control period: neighbours diverge or converge by less than 1 %
in each. For chaos of the nominal mole it is 0.015 to 0.6."""


def verdicts(
    growth: NDArray[np.float64], periods: NDArray[np.float64], alone: NDArray[np.bool_]
) -> NDArray[np.int8]:
    """Return the regimes of n motions that do not repeat.

    Parameters
    ----------
    growth : ndarray, shape (n, b)
        Growth of the logarithm of a tangent, in batches of equal length.
    periods : ndarray, shape (n,)
        Control periods in all batches together.
    alone : ndarray of bool, shape (n,)
        Whether control and mains have no common period.

    Returns
    -------
    ndarray of int8, shape (n,)
        `CHAOTIC`, `QUASI_PERIODIC` or `UNDECIDED`.
    """
    mean, error = mean_and_error(growth)
    each = periods / growth.shape[1]
    low, high = (mean - SURE * error) / each, (mean + SURE * error) / each
    follows = alone & (high < 0)
    neutral = (low > -NEAR_ZERO) & (high >= 0) & (high < NEAR_ZERO)
    not_chaotic = np.where(follows | neutral, QUASI_PERIODIC, UNDECIDED)
    return np.where(low > 0, CHAOTIC, not_chaotic).astype(np.int8)
