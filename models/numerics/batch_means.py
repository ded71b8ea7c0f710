"""Means of something that goes up and down for ever, with their errors, from batches of it."""

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

Array = NDArray[np.float64]

_LENGTHS = (1, 2, 4)
_FEWEST = 3  # batches that an error is still told from
_NINE_IN_TEN = 0.95  # quantile, of two sides


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


def mean_and_bound(batches: Array) -> tuple[Array, Array]:
    """Return time means and the errors within which nine in ten of them lie.

    What changes more slowly than a batch makes neighbouring batches alike, and their error too
    small. So they are joined by twos, fours and so on while `_FEWEST` are left, and the largest
    error is taken, each with Student's factor for its number of batches: changes as slow as a third
    of the whole are seen.

    Parameters
    ----------
    batches : ndarray, shape (n, b, ...)
        Means over equal stretches of time, in their order; b is `_FEWEST` at least.

    Returns
    -------
    mean, error : ndarray, shape (n, ...)
    """
    n, count, *rest = batches.shape
    error = np.zeros((n, *rest))
    length = 1
    while count // length >= _FEWEST:
        number = count // length
        joined = batches[:, count - number * length :].reshape(n, number, length, *rest)
        spread = joined.mean(axis=2).std(axis=1, ddof=1)
        student = round(float(stdtrit(number - 1, _NINE_IN_TEN)), 9)  # the same on every processor
        error = np.maximum(error, student / np.sqrt(number) * spread)
        length *= 2
    return batches.mean(axis=1), error
