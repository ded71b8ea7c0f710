"""Time means of quantities that fluctuate without settling, and their errors, by batch means."""

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


def ratio_error(numerators: Array, denominators: Array) -> Array:
    """Return standard errors of ratios of time means, linearised (delta method).

    Batches without a denominator tell nothing of the ratio: degrees of freedom are those of the
    others. Where these are few, the error is larger by Student's factor, so that 1.645 times the
    error remains the half-width of a 90 % interval.

    Parameters
    ----------
    numerators, denominators : ndarray, shape (n, b)
        Over consecutive intervals of equal length; b a multiple of 4, at least 8.

    Returns
    -------
    ndarray, shape (n,)
        NaN where fewer than two batches have a denominator.
    """
    mean = denominators.mean(axis=1, keepdims=True)
    with np.errstate(divide="ignore", invalid="ignore"):  # where no batch has one
        ratio = numerators.mean(axis=1, keepdims=True) / mean
        _, error = mean_and_error((numerators - ratio * denominators) / mean)
    count, informative = denominators.shape[1], np.count_nonzero(denominators, axis=1)
    if (informative == count).all():
        return error
    return error * _wider(count)[informative]


def _wider(count: int) -> Array:
    """Return the factors of a standard error for 0, 1, ... or all informative batches."""
    from scipy.special import stdtrit  # which few rows need

    number = np.arange(2, count + 1)
    factors = stdtrit(number - 1, _NINE_IN_TEN) * np.sqrt(number / (number - 1))
    return np.append([np.nan, np.nan], np.round(factors / factors[-1], 9))


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
