"""The step error of periodic responses of the fast propagator: the orbit again, in half steps."""

import numpy as np

from models.beam.response.approached_orbits import approached
from models.beam.response.response import NO_IMPACT, Response
from models.beam.response.settling import look, note_orbit
from models.beam.structure.modal import Array
from models.beam.structure.propagation import Propagator, System

_SEGMENTS = 16  # of the look at a beam that leaves its orbit


def add_step_error(
    propagator: Propagator, system: System, state: Array, gaps: Array, out: Response
) -> None:
    """Replace orbits by orbits at half the step; the difference is their error.

    Parameters
    ----------
    propagator : Propagator
    system : System
        Prepared by it.
    state : ndarray, shape (n, k)
        On the orbits, where there are any; not changed.
    gaps : ndarray, shape (n, 2)
        In initial gaps.
    out : Response
        Updated in place. Where an orbit is unstable with half the step, the response is the one it
        leads to.
    """
    rows = np.flatnonzero((out.period > 0) & (out.regime != NO_IMPACT))
    for part, fine, now in propagator.finer(system.take(rows), state[rows]):
        chosen = rows[part]
        coarse = out.take(chosen)
        refined = Response.settling(len(chosen))
        size = (gaps[chosen] + coarse.peak).max(axis=1)
        for k in np.unique(coarse.period):
            at = np.flatnonzero(coarse.period == k)
            orbit = approached(
                propagator, fine.take(at), now[at], gaps[chosen[at]], size[at], int(k)
            )
            note_orbit(refined, at, orbit, now)
        left = np.flatnonzero(refined.period == 0)
        look(propagator, fine, now, gaps[chosen], left, refined, _SEGMENTS, _SEGMENTS)
        refined.error[:] = np.maximum(refined.error, np.abs(refined.work - coarse.work))
        out.put(chosen, refined)
