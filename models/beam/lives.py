"""Lifetimes in the limit of infinitely slow wear, from accelerated lives at ever slower paces.

Each run lasts twice as long as the one before and is nearer to that limit; how the differences
fall tells how near: see `extrapolate`.
"""

import math
from types import ModuleType
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam import wear
from models.beam.modal import Array

SHORTEST = 64  # N of the first run; each further one lasts twice as long
LONGEST = 660  # over the accuracy: N of the last run at most


class Lives(NamedTuple):
    """Lifetimes of n beams in the limit of slow wear, with their numerical errors.

    Attributes
    ----------
    time : ndarray, shape (n, 3, D)
        Right site, left site and the earlier of the two, in the unit of `wear.Run.time`.
    error : ndarray, shape (n, 3, D)
        Estimated numerical error, NaN where the growth is not reached.
    reached : ndarray of bool, shape (n, 3, D)
        False where the time is infinite, or only the time simulated.
    ratio : ndarray, shape (n, D)
        As in `wear.Run`.
    """

    time: Array
    error: Array
    reached: NDArray[np.bool_]
    ratio: Array

    @staticmethod
    def nothing(n: int, depths: int) -> "Lives":
        """Return what is known of n beams before they are run."""
        unknown = np.full((2, n, 3, depths), np.nan)
        ratio = np.full((n, depths), np.nan)
        return Lives._make([*unknown, np.zeros((n, 3, depths), bool), ratio])


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
        As in `wear.run`.
    accuracy : float
        Relative error at which a beam's lives are good enough. It also sets the longest run: where
        that does not suffice, the error says so.

    Returns
    -------
    Lives
    """
    n, depths = growths.shape
    out = Lives.nothing(n, depths)
    levels = max(3, 1 + int(math.log2(LONGEST / (SHORTEST * accuracy))))
    times = np.empty((levels, n, 2, depths))
    left = np.arange(n)
    for level in range(levels):
        one = wear.run(
            propagator,
            system.take(left),
            state[left],
            gaps[left],
            work[left],
            share[left],
            growths[left],
            SHORTEST * 2**level,
        )
        times[level, left] = one.time
        before, out.reached[left, :2] = out.reached[left, :2], one.reached
        out.ratio[left] = one.ratio
        if level < 2:
            continue
        time, error = extrapolate(times[level - 2 : level + 1, left])
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


def extrapolate(times: Array) -> tuple[Array, Array]:
    """Estimate the life at infinitely slow wear from lives at N, 2 N and 4 N periods.

    Where the response follows the gaps smoothly it lags behind by a time that does not depend on
    the pace, so that the error falls like 1/N; through a change of branch (a slow passage) it
    falls like N^(-2/3). In both cases the differences of the lives are a geometric series of
    ratio 2 or 1.6, whose rest is added; a third of that rest is kept as the error. Differences
    that grow say that a change is not resolved yet, and their error is several times the last;
    any other sequence is that of an aperiodic response, whose error is statistical.

    Parameters
    ----------
    times : ndarray, shape (3, ...)
        Lives, the slowest wear last.

    Returns
    -------
    time, error : ndarray, shape (...)
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        previous, last = times[1] - times[0], times[2] - times[1]
        ratio = previous / last
        regular = (ratio > 1.4) & (ratio < 2.4)
        growing = (ratio > 0) & (ratio < 1)
        rest = np.where(regular, last / (ratio - 1), 0.0)
        statistical = np.maximum(np.abs(last), 0.7 * np.abs(previous))
        error = np.where(growing, 4 * np.abs(last), statistical)
        return times[2] + rest, np.where(regular, np.abs(rest) / 3, error)
