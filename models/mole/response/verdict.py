"""What a motion that does not repeat is: chaotic, quasi-periodic, or undecided.

The largest Lyapunov exponent decides, with its standard error. Chaos needs an exponent that is
positive, quasi-periodicity evidence of its own; an exponent indistinguishable from zero is
neither. Where control and mains have no common period, motion driven by both follows their phases
if neighbours come together: the exponent is negative. Where they have one, such motion is still
settling to something that repeats. A motion with a frequency of its own has an exponent of zero,
which no average can equal, but which it can be near to.
"""

import numpy as np
from numpy.typing import NDArray

from models.mole.parameters import CHAOTIC, QUASI_PERIODIC, UNDECIDED
from models.numerics.batch_means import mean_and_error

SURE = 3.0
"""Standard errors by which an exponent differs from another number."""

NEAR_ZERO = 0.01
"""Of the exponent times the control period: neighbours part, or come together, by less than a
hundredth in each. Chaos of the nominal mole makes it 0.015 to 0.6."""


def verdicts(
    growth: NDArray[np.float64], periods: NDArray[np.float64], alone: NDArray[np.bool_]
) -> NDArray[np.int8]:
    """Return what n motions that do not repeat are.

    Parameters
    ----------
    growth : ndarray, shape (n, b)
        Growth of the logarithm of a tangent in batches of equal length.
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
    known = np.where(follows | neutral, QUASI_PERIODIC, UNDECIDED)
    return np.where(low > 0, CHAOTIC, known).astype(np.int8)
