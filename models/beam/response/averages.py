"""Time means of a response that never settles, over as long a run as required.

The run is doubled until it is long enough; its first quarter is dropped, the rest divided into
batches that grow with it. It lasts at least `MEMORIES` times the memory of beam and load. The error
counts scatter as slow as a third of the run, with Student's factor for so few batches.
"""

from typing import NamedTuple

import numpy as np

from models.beam.structure.modal import Array
from models.beam.structure.propagation import LONGEST, Propagator, System
from models.numerics.batch_means import mean_and_bound

SHORTEST = 1024  # periods
MEMORIES = 20
NINE_IN_TEN = 1.645  # standard errors in the half-width of a 90 % interval
_PIECE = 32  # periods of the shortest batch
_ROWS = 64  # followed at a time, which limits the memory for the work of all their periods
_BATCHES = 24  # of the part that is kept


class Mean(NamedTuple):
    """The mean response of n beams.

    Attributes
    ----------
    work, error : ndarray, shape (n, 2)
        Mean dimensionless work per period at the right and the left site, and the half-width of
        its 90 % interval over `NINE_IN_TEN`.
    peak : ndarray, shape (n, 2)
        Largest penetration, in initial gaps.
    """

    work: Array
    error: Array
    peak: Array


def time_mean(
    propagator: Propagator, system: System, state: Array, gaps: Array, accuracy: float, least: int
) -> Mean:
    """Average the work of n beams until the errors of both sites are small, or the budget ends.

    A beam that has not yet met a stop within its reach is followed further: its work is not known
    to be zero.

    Parameters
    ----------
    propagator : Propagator
    system : System
        Prepared by it.
    state : ndarray, shape (n, k)
        Updated in place: the state at the end.
    gaps : ndarray, shape (n, 2)
        In initial gaps; not changed.
    accuracy : float
        Relative standard error that suffices.
    least : int
        Forcing periods of each run, at least.

    Returns
    -------
    Mean
        NaN for a beam whose memory is too long for the longest run.
    """
    n = len(state)
    wanted = np.maximum(least, MEMORIES * system.beams.random_memory)
    touches = system.free_reach >= gaps.min(axis=1)
    out = Mean(*np.zeros((3, n, 2)))
    pieces = np.zeros((n, LONGEST // _PIECE, 2))
    longest = system.longest
    left, done = np.flatnonzero(wanted <= longest), 0
    for field in out:
        field[wanted > longest] = np.nan
    total = SHORTEST // _PIECE
    while len(left):
        settled = max(done, SHORTEST // _PIECE // 4)
        for first in range(0, len(left), _ROWS):
            rows = left[first : first + _ROWS]
            now, here, part = state[rows], gaps[rows], system.take(rows)
            for begin, end in ((done, settled), (settled, total)):
                if begin == end:
                    continue
                periods = (end - begin) * _PIECE
                record = propagator.advance(part, now, here, np.zeros_like(here), periods)
                works = record.work.reshape(len(rows), end - begin, _PIECE, 2)
                pieces[rows, begin:end] = works.mean(axis=2)
                if begin >= settled:
                    out.peak[rows] = np.maximum(out.peak[rows], record.peak)
            state[rows] = now
        kept = pieces[left, total // 4 : total]
        batches = kept.reshape(len(left), _BATCHES, -1, 2).mean(axis=2)
        out.work[left], bound = mean_and_bound(batches)
        out.error[left] = bound / NINE_IN_TEN
        done, total = total, 2 * total
        good = (out.error[left] <= accuracy * out.work[left]).all(axis=1)
        good &= out.work[left].any(axis=1) | ~touches[left]
        good &= done * _PIECE >= wanted[left]
        lost = np.isnan(out.work[left]).any(axis=1)
        left = left[~(good | lost)] if total * _PIECE <= longest else left[:0]
    return out
