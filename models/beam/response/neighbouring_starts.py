"""Whether a response that did not settle is the same from nearly the same start.

One run, however its mean scatters, does not show that a response dwells in one state for longer
than the run, or that a tiny change of the start decides between several. Further runs start a
thousandth of a gap away, and last until the beam has forgotten this: chaos takes them along other
paths. Where they differ from the first by more than their errors, the largest difference, of either
site, is the error of its mean: the responses may be mirror images of each other.
"""

import numpy as np
from numpy.typing import NDArray

from models.beam.response.response import APERIODIC, Response
from models.beam.response.settling import MEMORIES, SEGMENT, look
from models.beam.structure.modal import Array
from models.beam.structure.propagation import FIRST_MODE, Propagator, System

_SHORTEST = 16  # segments of a further run
_AWAY = (-1e-3, 1e-3, 2e-3)  # offsets of their starts, in the first mode and in initial gaps


def add_neighbour_error(
    propagator: Propagator, system: System, begin: Array, gaps: Array, out: Response
) -> None:
    """Run aperiodic responses again, from starts close to the first.

    Parameters
    ----------
    propagator : Propagator
    system : System
        Prepared by it.
    begin : ndarray, shape (n, k)
        State from which `models.beam.response.settling.settle` started; not changed.
    gaps : ndarray, shape (n, 2)
        In initial gaps.
    out : Response
        Updated in place: the error of aperiodic responses.
    """
    rattles = ~system.beams.is_random & (out.regime == APERIODIC) & (out.work > 0).any(axis=1)
    rows = np.flatnonzero(rattles)
    if not len(rows):
        return
    again = np.repeat(rows, len(_AWAY))
    state = begin[again]
    state[:, FIRST_MODE] += np.tile(_AWAY, len(rows))
    neighbours = Response.settling(len(again))
    segments = np.repeat(_segments(system.beams.memory[rows]), len(_AWAY))
    for count in np.unique(segments):
        alike = np.flatnonzero(segments == count)
        look(propagator, system.take(again), state, gaps[again], alike, neighbours, count, count)
    shape = (len(rows), len(_AWAY), 2)
    apart = np.abs(neighbours.work.reshape(shape) - out.work[rows, None])
    within = np.hypot(neighbours.error.reshape(shape), out.error[rows, None])
    beyond = np.where(apart > within, apart, 0.0).max(axis=(1, 2))[:, None]
    out.error[rows] = np.maximum(out.error[rows], beyond)


def _segments(memory: Array) -> NDArray[np.int64]:
    """Return the number of segments after which a beam has forgotten its start."""
    looks = np.maximum(1.0, MEMORIES * memory / (_SHORTEST * SEGMENT))
    return _SHORTEST * 2 ** np.ceil(np.log2(looks)).astype(np.int64)
