"""The life at infinitely slow wear, from lives each half as fast as the one before."""

import math

import numpy as np
from numpy.typing import NDArray

from models.beam.structure.modal import Array

LEAST = 5  # runs: fewer would be too fast to notice some changes of branch
SMOOTH = 4  # runs that suffice where nothing changes and convergence is regular


def _fit_of_constant_and_inverse() -> Array:
    """Return the weights of four lives at N to 8 N in the constant of their fit."""
    periods = 2.0 ** np.arange(4)
    sum_, count, inverses = periods.sum(), len(periods), (1 / periods).sum()
    return (inverses * periods - count) / (sum_ * inverses - count * count)


_FIT = _fit_of_constant_and_inverse()
_FIT_SPREAD = math.sqrt(sum(weight**2 / 2**k for k, weight in enumerate(_FIT)))
_STUDENT = 2.131846786  # 95 % quantile of t with LEAST - 1 degrees of freedom


def extrapolate_smooth(times: Array) -> tuple[Array, Array]:
    """Estimate the life at infinitely slow wear from lives at N, 2 N, 4 N and 8 N periods.

    Parameters
    ----------
    times : ndarray, shape (4, ...)
        Lives, the slowest wear last.

    Returns
    -------
    time, error : ndarray, shape (...)
        As from `extrapolate`; the error is infinite unless both second differences are those of a
        regular series.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        time, regular = _rest(times[1:])
        before, was_regular = _rest(times[:-1])
        error = _regular_error(np.abs(time - times[-1]), np.abs(time - before))
        differences = np.abs(np.diff(times, axis=0)).max(axis=0)
        even = regular & was_regular
        return np.where(even, time, times[-1]), np.where(even, error, 4 * differences)


def extrapolate(times: Array) -> tuple[Array, Array]:
    """Estimate the life at infinitely slow wear from lives at N, 2 N, 4 N, 8 N and 16 N periods.

    Where the response follows the gaps smoothly it lags behind by a time independent of the pace,
    so the error falls like 1/N; through a change of branch (a slow passage) it falls like N^(-2/3).
    In both cases the differences of the lives are a geometric series of ratio 2 or 1.6, whose
    remainder is added. Any other sequence is that of a partly or wholly aperiodic response: then
    the four slowest lives are fitted by a constant plus an error like 1/N, weighted by their
    periods. Differences that grow mean that a change is not resolved yet.

    The error combines the remainder added, its change when the slowest life is dropped, the
    differences themselves, and their scatter, assuming that the variance of a life is inversely
    proportional to its periods. Its factors are such that it covers nine in ten lives, measured
    against lives ten times as slow: see ``benchmarks/beam_lives.py``.

    Parameters
    ----------
    times : ndarray, shape (5, ...)
        Lives, the slowest wear last.

    Returns
    -------
    time, error : ndarray, shape (...)
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        time, regular = _limit(times[1:])
        before, _ = _limit(times[:-1])
        added, change = np.abs(time - times[-1]), np.abs(time - before)
        last, previous = np.abs(times[-1] - times[-2]), np.abs(times[-2] - times[-3])
        same_sign = (times[-1] > times[-2]) == (times[-2] > times[-3])
        growing = same_sign & (last > previous)
        rest = np.maximum.reduce(
            [added, 3 * change, 2 * last, 1.4 * previous, np.where(growing, 8 * last, 0.0)]
        )
        irregular = np.maximum(rest, _STUDENT * _FIT_SPREAD * _scatter(times))
        return time, np.where(regular, _regular_error(added, change), irregular)


def _regular_error(added: Array, change: Array) -> Array:
    """Return the error of a limit from the remainder added and its change between runs."""
    return np.maximum(added, 2 * change)


def _scatter(times: Array) -> Array:
    """Return the standard deviation of the second of five lives, from all their differences."""
    periods = (2.0 ** np.arange(-1, LEAST - 2)).reshape(-1, *[1] * (times.ndim - 1))
    return np.sqrt((np.diff(times, axis=0) ** 2 * periods / 1.5).mean(axis=0))


def _limit(times: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return the limit of lives at N, 2 N, 4 N and 8 N, and whether they are regular."""
    slowest = times[-1]
    limit, regular = _rest(times[1:])
    # Summed one by one: the rounding of a matrix product depends on the number of rows.
    fitted = sum(weight * time for weight, time in zip(_FIT, times, strict=True))
    limit = np.where(regular, limit, fitted)
    return np.where(np.abs(limit - slowest) < slowest / 2, limit, slowest), regular


def _rest(times: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Add the remainder of a geometric series to the last of three lives; return if it is one."""
    last = times[2] - times[1]
    ratio = (times[1] - times[0]) / last
    return times[2] + last / (ratio - 1), (ratio > 1.4) & (ratio < 2.4)
