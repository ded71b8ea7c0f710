"""Whether a response that did not settle is the same from next to the same start.

One look, however its mean scatters, does not show that a response dwells in one state for longer
than the look, nor that the start decides by a hair between several. Others begin a thousandth of a
gap away: chaos takes them along other paths. Where they differ from the first by more than their
errors, the largest difference, of either site, is the error of its mean: their responses may be
each other's mirror images.
"""

from types import ModuleType
from typing import Any

import numpy as np

from models.beam.modal import Array
from models.beam.response import APERIODIC, MEMORIES, SEGMENT, Response, look

_SEGMENTS = 16  # of each further look
_AWAY = (-1e-3, 1e-3, 2e-3)  # where they begin, in the first mode and in initial gaps


def add_second_looks(
    propagator: ModuleType, system: Any, begin: Array, gaps: Array, out: Response
) -> None:
    """Look at aperiodic responses again, from starts close to the first.

    Parameters
    ----------
    propagator : module
        `models.beam.lanes` or `models.beam.exact`.
    system
        What the propagator prepared.
    begin : ndarray, shape (n, k)
        Where `models.beam.response.settle` began; not changed.
    gaps : ndarray, shape (n, 2)
        In initial gaps.
    out : Response
        Updated in place: the error of aperiodic responses that soon forget their start.
    """
    forgets = MEMORIES * system.memory <= _SEGMENTS * SEGMENT
    rattles = ~system.is_random & (out.regime == APERIODIC) & (out.work > 0).any(axis=1)
    rows = np.flatnonzero(rattles & forgets)
    if not len(rows):
        return
    again = np.repeat(rows, len(_AWAY))
    state = begin[again]
    state[:, 0] += np.tile(_AWAY, len(rows))
    found = Response.settling(len(again))
    every = np.arange(len(again))
    look(propagator, system.take(again), state, gaps[again], every, found, _SEGMENTS, _SEGMENTS)
    shape = (len(rows), len(_AWAY), 2)
    apart = np.abs(found.work.reshape(shape) - out.work[rows, None])
    within = np.hypot(found.error.reshape(shape), out.error[rows, None])
    beyond = np.where(apart > within, apart, 0.0).max(axis=(1, 2))[:, None]
    out.error[rows] = np.maximum(out.error[rows], beyond)
