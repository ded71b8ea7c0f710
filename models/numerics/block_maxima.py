"""Largest values of a quantity that fluctuates without settling, by block maxima.

A largest value over a finite time grows with that time. Block maxima of a bounded quantity have an
extreme-value law with a shape of at most zero (of chaotic motion: V. Lucarini et al., J. Stat.
Phys. 154 (2014) 723), so each further multiplication of the time by the same factor adds less on
average (S. Coles, An Introduction to Statistical Modeling of Extreme Values, Springer 2001).
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def maximum_and_growth(maxima: Array) -> tuple[Array, Array]:
    """Return the largest values, and their growth from one block to all.

    Over as many times the time as there are blocks, the largest value is expected to grow by no
    more than that.

    Parameters
    ----------
    maxima : ndarray, shape (n, b)
        Largest values over consecutive intervals of equal length.

    Returns
    -------
    maximum, growth : ndarray, shape (n,)
    """
    maximum = maxima.max(axis=1)
    return maximum, maximum - maxima.mean(axis=1)
