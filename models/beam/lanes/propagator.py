"""The fast propagator: many beams at a time over whole forcing periods, and their tangents."""

import numpy as np

from models.beam.lanes.layout import CLOCK, X1
from models.beam.lanes.random_motion import random_motion
from models.beam.lanes.steps import advance_blocks, advance_loaded_blocks, room
from models.beam.lanes.systems import System
from models.beam.lanes.tangents import carry
from models.beam.structure.modal import Array
from models.beam.structure.propagation import Record

_LOST = 1e6  # displacement, relative to the gap plus the reach of the tip without contact


def advance(
    system: System, state: Array, gaps: Array, growth: Array, periods: int, trace: bool = False
) -> Record:
    """Advance n beams; gaps grow at the end of each period.

    Record and state are NaN for a beam whose motion diverges.
    """
    n, _, m = system.modes.shape
    beams = system.beams
    record = Record.empty(n, periods, system.steps if trace else 0)
    arguments = (
        system.modes,
        system.sigma,
        system.response,
        state,
        gaps,
        growth,
        system.wave[0],
        system.wave[1],
        room(m, system.steps),
        tuple(record),
    )
    if beams.is_random.any():
        advance_loaded_blocks(*arguments, random_motion(beams, system.taps))
    else:
        advance_blocks(*arguments)
    # Steps too long for the ringing of a long contact amplify it: this is no motion of the beam.
    lost = ~(np.abs(state[:, 2 * m + X1]) <= _LOST * (1 + system.free_reach))
    if lost.any():
        for field in (state, *record):
            field[lost] = np.nan
    return record


def monodromy(system: System, state: Array, gaps: Array, periods: int) -> Array:
    """Return the derivative; zero for the clock.

    It is that of the numerical scheme, not of the beam that it approximates.
    """
    record = advance(system, state.copy(), gaps.copy(), np.zeros_like(gaps), periods, trace=True)
    n, size = state.shape
    tangents = np.tile(np.eye(size - 1), (n, 1, 1))
    carry(system, state, gaps, record.trace, tangents)
    out = np.zeros((n, size, size))
    out[:, :CLOCK, :CLOCK] = tangents
    return out
