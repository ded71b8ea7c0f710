"""Lifetimes, and their numerical errors."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.structure.modal import Array
from models.beam.structure.propagation import Propagator, System
from models.beam.wear.regimes import changes_of, confirmed_regimes
from models.beam.wear.worn_beams import wear_down

PERIODS = 240  # over the accuracy: periods of a flow


class Lives(NamedTuple):
    """Lifetimes of n beams in the limit of slow wear, with their numerical errors.

    Attributes
    ----------
    time : ndarray, shape (n, 3, D)
        Right site, left site and the earlier of the two, in the unit of `progress.Worn`.
    error : ndarray, shape (n, 3, D)
        Estimated numerical error, NaN where the growth is not reached.
    reached : ndarray of bool, shape (n, 3, D)
        False where the time is infinite, or that simulated.
    ratio : ndarray, shape (n, D)
        As in `progress.Worn`.
    changes : ndarray, shape (n,)
        Changes of regime, up to the end.
    depth : ndarray, shape (n, 2, T)
        As in `progress.Worn`.
    """

    time: Array
    error: Array
    reached: NDArray[np.bool_]
    ratio: Array
    changes: Array
    depth: Array

    @staticmethod
    def nothing(n: int, depths: int, instants: int) -> "Lives":
        """Return the lives of n beams before they are run: unknown."""
        unknown = np.full((2, n, 3, depths), np.nan)
        ratio = np.full((n, depths), np.nan)
        reached = np.zeros((n, 3, depths), bool)
        depth = np.full((n, 2, instants), np.nan)
        return Lives._make([*unknown, reached, ratio, np.full(n, np.nan), depth])


def find_lives(
    propagator: Propagator,
    system: System,
    state: Array,
    gaps: Array,
    work: Array,
    regime: NDArray[np.int8],
    share: Array,
    growths: Array,
    instants: Array,
    accuracy: float,
) -> Lives:
    """Find the lives of n beams.

    Parameters
    ----------
    propagator, system, state, gaps, work, regime, share, growths, instants
        As in `worn_beams.wear_down`.
    accuracy : float
        Relative error asked for. It sets the errors of the steps, and the time spent where the
        response is aperiodic; the errors of the lives show whether this suffices.

    Returns
    -------
    Lives
    """
    periods = round(PERIODS / accuracy)
    start = (propagator, system, state, gaps, work, regime, share, growths)
    worn = wear_down(*start, periods, accuracy, instants=instants)
    out = Lives.nothing(len(growths), growths.shape[1], instants.shape[1])
    out.time[:, :2], out.error[:, :2], out.reached[:, :2] = worn.time, worn.error, worn.reached
    out.ratio[:], out.depth[:] = worn.ratio, worn.depth
    out.changes[:] = changes_of(confirmed_regimes(worn.history.regime)).sum(axis=1)
    _take_the_earlier(out)
    return out


def _take_the_earlier(out: Lives) -> None:
    sites = np.where(out.reached[:, :2], out.time[:, :2], np.inf)
    earlier = sites.argmin(axis=1)[:, None]
    for field in (out.time, out.error, out.reached):
        field[:, 2] = np.take_along_axis(field[:, :2], earlier, axis=1)[:, 0]
