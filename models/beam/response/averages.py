"""Time means of a response that never settles, taken as long as it needs.

The run is doubled until it is long enough; its first quarter is left out, the rest cut into
batches that grow with it. It lasts `MEMORIES` times what the beam remembers at least.
"""

from typing import NamedTuple

import numpy as np

from models.beam.structure.modal import Array
from models.beam.structure.propagation import LONGEST, Propagator, System
from models.numerics.batch_means import mean_and_error

SHORTEST = 1024  # periods
MEMORIES = 20
_PIECE = 32  # periods in one call, and in the shortest batch
_BATCHES = 24  # cut from what is kept


class Mean(NamedTuple):
    """The mean response of n beams.

    Attributes
    ----------
    work, error : ndarray, shape (n, 2)
        Mean dimensionless work per period at the right and the left site, and its standard error.
    peak : ndarray, shape (n, 2)
        Largest penetration, in initial gaps.
    """

    work: Array
    error: Array
    peak: Array


def time_mean(
    propagator: Propagator, system: System, state: Array, gaps: Array, accuracy: float, least: int
) -> Mean:
    """Average the work of n beams until both sites' errors are small, or the budget ends.

    A beam that has not met a stop it can reach is followed on: its work is not known to be zero.

    Parameters
    ----------
    propagator : Propagator
    system : System
        What it prepared.
    state : ndarray, shape (n, k)
        Updated in place: the state at the end.
    gaps : ndarray, shape (n, 2)
        In initial gaps; not changed.
    accuracy : float
        Relative standard error that is good enough.
    least : int
        Forcing periods that each run lasts at least.

    Returns
    -------
    Mean
        NaN for a beam whose memory is too long for the longest run.
    """
    n = len(state)
    wanted = np.maximum(least, MEMORIES * system.beams.memory)
    touches = system.reach >= gaps.min(axis=1)
    out = Mean(*np.zeros((3, n, 2)))
    pieces = np.zeros((n, LONGEST // _PIECE, 2))
    longest = system.longest
    left, done = np.flatnonzero(wanted <= longest), 0
    for field in out:
        field[wanted > longest] = np.nan
    total = SHORTEST // _PIECE
    while len(left):
        now, here, some = state[left], gaps[left], system.take(left)
        for piece in range(done, total):
            record = propagator.advance(some, now, here, np.zeros_like(here), _PIECE)
            pieces[left, piece] = record.work.mean(axis=1)
            if piece >= SHORTEST // _PIECE // 4:
                out.peak[left] = np.maximum(out.peak[left], record.peak)
        state[left] = now
        kept = pieces[left, total // 4 : total]
        batches = kept.reshape(len(left), _BATCHES, -1, 2).mean(axis=2)
        out.work[left], out.error[left] = mean_and_error(batches)
        done, total = total, 2 * total
        good = (out.error[left] <= accuracy * out.work[left]).all(axis=1)
        good &= out.work[left].any(axis=1) | ~touches[left]
        good &= done * _PIECE >= wanted[left]
        lost = np.isnan(out.work[left]).any(axis=1)
        left = left[~(good | lost)] if total * _PIECE <= longest else left[:0]
    return out
