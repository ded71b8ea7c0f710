"""Lyapunov exponents from tangents that a propagator carries along.

A single tangent turns into the direction of fastest growth, and its growth over a long time gives
the largest exponent. On a periodic orbit a full set of tangents over one period gives it directly,
as the logarithm of the largest multiplier. Either way the tangents must be rescaled now and then.
"""

import math

import numpy as np
from numpy.typing import NDArray

from models.numerics.elementary import log
from models.numerics.multipliers import log_radius

Array = NDArray[np.float64]

_LEAST = np.finfo(float).tiny  # whose logarithm is still finite


def grown(tangents: Array) -> Array:
    """Rescale n sets of tangents to size 1; return the logarithms of their former sizes.

    Parameters
    ----------
    tangents : ndarray, shape (n, m)
        All components of a set; scaled in place by one factor.

    Returns
    -------
    ndarray, shape (n,)
        A size is the largest component in magnitude.
    """
    size = np.abs(tangents).max(axis=1)
    tangents /= np.where(size > 0, size, 1.0)[:, None]
    return np.asarray(log(np.maximum(size, _LEAST)))


def log_multiplier(flow: Array) -> Array:
    """Return the logarithm of the largest multiplier.

    Parameters
    ----------
    flow : ndarray, shape (n, k, k)
        Tangents after a period that started as the unit vectors, as rows or as columns.

    Returns
    -------
    ndarray, shape (n,)
    """
    return np.maximum(log_radius(flow), math.log(_LEAST))
