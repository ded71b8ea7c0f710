"""Orbits made unstable by wear are left at once, not only when rounding errors have grown.

A beam that follows an orbit through its loss of stability stays close to it until the remaining
disturbances have grown again. In a life of 1e9 periods this delay is negligible; in an accelerated
one it may be half the life, which is then overestimated. So the multiplier of a period-1 orbit is
computed on the way, and a beam whose orbit has just become unstable is pushed.
"""

import numpy as np
from numpy.typing import NDArray

from models.beam.response.response import ASYMMETRIC, SYMMETRIC
from models.beam.structure.modal import Array
from models.beam.structure.propagation import FIRST_MODE, Propagator, System
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
    """Push the beams whose orbit has become unstable.

    Parameters
    ----------
    propagator : Propagator
    system : System
        Prepared by it.
    state : ndarray, shape (n, k)
        Updated in place.
    gaps : ndarray, shape (n, 2)
        In initial gaps.
    regime : ndarray of int8, shape (n,)
        Index into `models.beam.parameters.REGIMES`.
    unstable : ndarray of bool, shape (n,)
        Whether the orbit was already unstable; updated in place. One push suffices: another might
        cancel its growth.
    """
    rows = np.flatnonzero((regime == SYMMETRIC) | (regime == ASYMMETRIC))
    now = np.zeros_like(unstable)
    if len(rows):
        flow = propagator.monodromy(system.take(rows), state[rows], gaps[rows], 1)
        now[rows] = largest_multiplier(flow) > 1
    state[now & ~unstable, FIRST_MODE] += _PUSH
    unstable[:] = now
