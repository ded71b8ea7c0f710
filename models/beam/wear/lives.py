"""Lifetimes in the limit of infinitely slow wear, from accelerated lives at ever slower paces.

Each run lasts twice as long as the one before and is nearer to that limit; how the differences
fall tells how near: see `extrapolate`.
"""

import math
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.special import stdtrit

from models.beam.structure.modal import Array
from models.beam.wear.accelerated_life import LOOKS, run
from models.beam.wear.regimes import UNKNOWN, WINDOW, changes_of, confirmed_regimes

SHORTEST = 64  # N of the first run; each further one lasts twice as long
LEAST = 5  # runs: fewer are too fast to notice some branch changes
SMOOTH = 4  # runs that suffice where nothing changes and the limit is approached evenly
LONGEST = 210  # over the accuracy: N of the last run at most, unless they are the least


def _fit_of_constant_and_inverse() -> Array:
    """Return the weights with which four lives at N to 8 N enter the constant of their fit."""
    periods = 2.0 ** np.arange(4)
    sum_, count, inverses = periods.sum(), len(periods), (1 / periods).sum()
    return (inverses * periods - count) / (sum_ * inverses - count * count)


_FIT = _fit_of_constant_and_inverse()
_FIT_SPREAD = math.sqrt(sum(weight**2 / 2**k for k, weight in enumerate(_FIT)))
_STUDENT = round(float(stdtrit(LEAST - 1, 0.95)), 9)  # the same on every processor


class Lives(NamedTuple):
    """Lifetimes of n beams in the limit of slow wear, with their numerical errors.

    Attributes
    ----------
    time : ndarray, shape (n, 3, D)
        Right site, left site and the earlier of the two, unit as in `accelerated_life.Run`.
    error : ndarray, shape (n, 3, D)
        Estimated numerical error, NaN where the growth is not reached.
    reached : ndarray of bool, shape (n, 3, D)
        False where the time is infinite, or only the time simulated.
    ratio : ndarray, shape (n, D)
        As in `accelerated_life.Run`.
    changes : ndarray, shape (n,)
        Changes of regime in the slowest run, up to its end.
    """

    time: Array
    error: Array
    reached: NDArray[np.bool_]
    ratio: Array
    changes: Array

    @staticmethod
    def nothing(n: int, depths: int) -> "Lives":
        """Return what is known of n beams before they are run."""
        unknown = np.full((2, n, 3, depths), np.nan)
        ratio = np.full((n, depths), np.nan)
        reached = np.zeros((n, 3, depths), bool)
        return Lives._make([*unknown, reached, ratio, np.full(n, np.nan)])


def find_lives(
    propagator: ModuleType,
    system: Any,
    state: Array,
    gaps: Array,
    work: Array,
    share: Array,
    growths: Array,
    accuracy: float,
) -> Lives:
    """Repeat the accelerated life ever more slowly until it no longer depends on the pace.

    Parameters
    ----------
    propagator, system, state, gaps, work, share, growths
        As in `accelerated_life.run`.
    accuracy : float
        Relative error at which a beam's lives are good enough. It also sets the longest run: where
        that does not suffice, the error says so.

    Returns
    -------
    Lives
    """
    n, depths = growths.shape
    out = Lives.nothing(n, depths)
    levels = max(LEAST, 1 + int(math.log2(LONGEST / (SHORTEST * accuracy))))
    times = np.empty((levels, n, 2, depths))
    left = np.arange(n)
    for level in range(levels):
        periods = SHORTEST << level
        one = run(
            propagator,
            system.take(left),
            state[left],
            gaps[left],
            work[left],
            share[left],
            growths[left],
            periods,
            min(LOOKS, max(LOOKS // 2, periods // WINDOW)),
        )
        times[level, left] = one.time
        before, out.reached[left, :2] = out.reached[left, :2], one.reached
        out.ratio[left] = one.ratio
        if level + 1 < SMOOTH:
            continue
        regime = one.history.regime
        out.changes[left] = changes_of(confirmed_regimes(regime)).sum(axis=1)
        if level + 1 < LEAST:
            time, error = extrapolate_smooth(times[:SMOOTH, left])
            changed = ((regime != regime[:, :1]) & (regime != UNKNOWN)).any(axis=1)
            error[changed | one.lost] = np.inf
        else:
            time, error = extrapolate(times[level + 1 - LEAST : level + 1, left])
        # A life that one of the runs did not reach is known no better than by its own size.
        error = np.where(before & np.isfinite(error), np.minimum(error, time), time)
        out.time[left, :2] = np.where(one.reached, time, one.time)
        out.error[left, :2] = np.where(one.reached, error, np.nan)
        good = (one.reached == before) & (~one.reached | (error <= accuracy * time))
        left = left[~good.all(axis=(1, 2))]
        if not len(left):
            break
    _take_the_earlier(out)
    return out


def _take_the_earlier(out: Lives) -> None:
    sites = np.where(out.reached[:, :2], out.time[:, :2], np.inf)
    earlier = sites.argmin(axis=1)[:, None]
    for field in (out.time, out.error, out.reached):
        field[:, 2] = np.take_along_axis(field[:, :2], earlier, axis=1)[:, 0]


def extrapolate_smooth(times: Array) -> tuple[Array, Array]:
    """Estimate the life at infinitely slow wear from lives at N, 2 N, 4 N and 8 N periods.

    Parameters
    ----------
    times : ndarray, shape (4, ...)
        Lives, the slowest wear last.

    Returns
    -------
    time, error : ndarray, shape (...)
        As `extrapolate` does; the error is infinite unless both differences of differences are
        those of a regular series.
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

    Where the response follows the gaps smoothly it lags behind by a time that does not depend on
    the pace, so that the error falls like 1/N; through a change of branch (a slow passage) it
    falls like N^(-2/3). In both cases the differences of the lives are a geometric series of
    ratio 2 or 1.6, whose rest is added. Any other sequence is, in part or wholly, that of an
    aperiodic response: then the four slowest lives are fitted by a constant and an error like
    1/N, each with the weight of its periods. Differences that grow say that a change is not
    resolved yet.

    The error is made of what was added, how much it changes when the slowest life is left out, the
    differences themselves, and the scatter that all of them show where the variance of a life is
    one over its periods. Its factors are such that nine in ten lives lie within it, measured
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
    """Return the error of a limit by what was added, and its change from one run to the next."""
    return np.maximum(added, 2 * change)


def _scatter(times: Array) -> Array:
    """Return the standard deviation of the second of five lives, from all their differences."""
    periods = (2.0 ** np.arange(-1, LEAST - 2)).reshape(-1, *[1] * (times.ndim - 1))
    return np.sqrt((np.diff(times, axis=0) ** 2 * periods / 1.5).mean(axis=0))


def _limit(times: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Return the limit of lives at N, 2 N, 4 N and 8 N, and whether they are regular."""
    slowest = times[-1]
    limit, regular = _rest(times[1:])
    # Summed one by one: a product of matrices would round by how many rows there are.
    fitted = sum(weight * time for weight, time in zip(_FIT, times, strict=True))
    limit = np.where(regular, limit, fitted)
    return np.where(np.abs(limit - slowest) < slowest / 2, limit, slowest), regular


def _rest(times: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Add the rest of a geometric series to the last of three lives; tell whether it is one."""
    last = times[2] - times[1]
    ratio = (times[1] - times[0]) / last
    return times[2] + last / (ratio - 1), (ratio > 1.4) & (ratio < 2.4)
