"""Lifetimes in the limit of infinitely slow wear, from accelerated lives at ever slower paces.

Each run is twice as long as the one before and nearer to that limit; the decrease of the
differences shows how near: see `models.beam.wear.extrapolation`.
"""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.structure.modal import Array
from models.beam.structure.propagation import Propagator, System
from models.beam.wear.accelerated_life import LOOKS, run_life
from models.beam.wear.extrapolation import LEAST, SMOOTH, extrapolate, extrapolate_smooth
from models.beam.wear.regimes import UNKNOWN, WINDOW, changes_of, confirmed_regimes

SHORTEST = 64  # N of the first run; each further one lasts twice as long
LONGEST = 210  # over the accuracy: largest N of the last run, unless `LEAST` runs need more


class Lives(NamedTuple):
    """Lifetimes of n beams in the limit of slow wear, with their numerical errors.

    Attributes
    ----------
    time : ndarray, shape (n, 3, D)
        Right site, left site and the earlier of the two, in the unit of `accelerated_life.Run`.
    error : ndarray, shape (n, 3, D)
        Estimated numerical error, NaN where the growth is not reached.
    reached : ndarray of bool, shape (n, 3, D)
        False where the time is infinite, or that simulated.
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
        """Return the lives of n beams before they are run: unknown."""
        unknown = np.full((2, n, 3, depths), np.nan)
        ratio = np.full((n, depths), np.nan)
        reached = np.zeros((n, 3, depths), bool)
        return Lives._make([*unknown, reached, ratio, np.full(n, np.nan)])


def find_lives(
    propagator: Propagator,
    system: System,
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
        As in `accelerated_life.run_life`.
    accuracy : float
        Relative error at which a beam's lives are accurate enough. It also sets the longest run: if
        this does not suffice, the error shows it.

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
        one = run_life(
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
        # The error of a life that one of the runs did not reach is as large as the life.
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
