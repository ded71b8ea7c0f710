"""Time means of a quantity that fluctuates without settling, with their errors, by batch means."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

_LENGTHS = (1, 2, 4)
_FEWEST = 3  # batches from which an error is still estimated
_NINE_IN_TEN = 0.95  # quantile: two-sided 90 %


def mean_and_error(batches: Array) -> tuple[Array, Array]:
    """Return time means and their standard errors.

    Neighbouring batches are not independent. Batches joined by twos and fours capture slower
    changes, so the largest of the three errors is returned.

    Parameters
    ----------
    batches : ndarray, shape (n, b, ...)
        Means over consecutive intervals of equal length; b a multiple of 4, at least 8.

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
    """Return time means and the half-widths of their 90 % intervals.

    Changes slower than a batch correlate neighbouring batches, which makes their error too small.
    So batches are joined by twos, fours and so on while `_FEWEST` are left, and the largest error
    is returned, each with Student's factor for its number of batches: changes as slow as a third of
    the whole are captured.

    Parameters
    ----------
    batches : ndarray, shape (n, b, ...)
        Means over consecutive intervals of equal length; b is at least `_FEWEST`.

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
        error = np.maximum(error, student(number - 1) / np.sqrt(number) * spread)
        length *= 2
    return batches.mean(axis=1), error


def student(freedom: int) -> float:
    """Return the half-width of a 90 % interval over the standard error it is estimated with.

    Parameters
    ----------
    freedom : int
        Degrees of freedom of the standard error; at least 1.
    """
    from scipy.special import stdtrit  # which few rows need

    return round(float(stdtrit(freedom, _NINE_IN_TEN)), 9)  # the same on every processor
