"""Lyapunov exponents from tangents that a propagator carries along.

A single tangent turns into the direction that grows most, and its growth over a long time tells the
largest exponent. On a periodic orbit a full set of tangents through one period tells it at once, by
the largest multiplier. Either way tangents must be brought back to size now and then.
"""

import math

import numpy as np
from numpy.typing import NDArray

from models.numerics.elementary import log
from models.numerics.multipliers import log_radius

Array = NDArray[np.float64]

_LEAST = np.finfo(float).tiny  # whose logarithm is still a number


def grown(tangents: Array) -> Array:
    """Bring n sets of tangents back to size 1; return the logarithms of their sizes.

    Parameters
    ----------
    tangents : ndarray, shape (n, m)
        All components of a set, scaled in place by one number.

    Returns
    -------
    ndarray, shape (n,)
        Of the largest component in magnitude.
    """
    size = np.abs(tangents).max(axis=1)
    tangents /= np.where(size > 0, size, 1.0)[:, None]
    return np.asarray(log(np.maximum(size, _LEAST)))


def log_multiplier(flow: Array) -> Array:
    """Return the logarithm of the largest multiplier.

    Parameters
    ----------
    flow : ndarray, shape (n, k, k)
        Tangents after a period that were the unit vectors before, as rows or as columns.

    Returns
    -------
    ndarray, shape (n,)
    """
    return np.maximum(log_radius(flow), math.log(_LEAST))
