"""Orbits that wear has made unstable are left at once, not when rounding has grown.

A beam that follows an orbit through the loss of its stability stays next to it until what is left
of its disturbances has grown again. In a life of 1e9 periods that is no time at all; in an
accelerated one it may be half of it, and the life comes out too long. So the multiplier of an orbit
of one period is computed on the way, and a beam whose orbit has just become unstable is pushed.
"""

import numpy as np
from numpy.typing import NDArray

from models.beam.response.response import ASYMMETRIC, SYMMETRIC
from models.beam.structure.modal import Array
from models.beam.structure.propagation import Propagator, System
from models.numerics.multipliers import largest_multiplier

_PUSH = 3e-3  # of the first mode [X0]


def push_off_unstable_orbits(
    propagator: Propagator,
    system: System,
    state: Array,
    gaps: Array,
    regime: NDArray[np.int8],
    unstable: NDArray[np.bool_],
) -> None:
    """Push the beams that follow an orbit which has become unstable.

    Parameters
    ----------
    propagator : Propagator
    system : System
        What it prepared.
    state : ndarray, shape (n, k)
        Updated in place.
    gaps : ndarray, shape (n, 2)
        In initial gaps.
    regime : ndarray of int8, shape (n,)
        Index into `models.beam.parameters.REGIMES`.
    unstable : ndarray of bool, shape (n,)
        Whether the orbit was so before; updated in place. One push is enough: the next might undo
        what has grown of it.
    """
    rows = np.flatnonzero((regime == SYMMETRIC) | (regime == ASYMMETRIC))
    now = np.zeros_like(unstable)
    if len(rows):
        flow = propagator.monodromy(system.take(rows), state[rows], gaps[rows], 1)
        now[rows] = largest_multiplier(flow) > 1
    state[now & ~unstable, 0] += _PUSH
    unstable[:] = now
