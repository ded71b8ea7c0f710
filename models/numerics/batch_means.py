"""Means of something that goes up and down for ever, with their errors, from batches of it."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LENGTHS = (1, 2, 4)


def mean_and_error(batches: Array) -> tuple[Array, Array]:
    """Return time means and their standard errors.

    Neighbouring batches are not independent. Longer batches, made of two and of four, see slower
    changes: the largest of their errors is the one to believe.

    Parameters
    ----------
    batches : ndarray, shape (n, b, ...)
        Means over equal stretches of time, in their order; b a multiple of 4, 8 at least.

    Returns
    -------
    mean, error : ndarray, shape (n, ...)
    """
    n, count, *rest = batches.shape
    error = np.zeros((n, *rest))
    for length in _LENGTHS:
        means = batches.reshape(n, count // length, length, *rest).mean(axis=2)
        error = np.maximum(error, means.std(axis=1, ddof=1) / np.sqrt(count // length))
    return batches.mean(axis=1), error
