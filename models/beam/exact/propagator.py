"""Exact propagation from event to event: the reference for the beam.

Free flight and contact are linear, see `models.beam.exact.phases`, and the instants between them
are found to rounding, see `models.beam.exact.events`. One beam at a time, at about twenty times the
cost of `models.beam.lanes`. Like that, a `models.beam.structure.propagation.Propagator`.
"""

import numpy as np

from models.beam.exact.one_beam import CLOCK, advance_beam
from models.beam.exact.passage import passage
from models.beam.exact.phases import set_lines
from models.beam.exact.systems import System
from models.beam.exact.tuning import Beam
from models.beam.structure.modal import Array
from models.beam.structure.propagation import Record
from models.beam.structure.random_lines import COUNT, SPEED, TURN, draw, turn_at


def start(system: System, displacement: Array, velocity: Array) -> Array:
    """Return z and dz/d(Omega t) of each mode, the clock, and the work of unfinished contacts.

    The shape is (n, 2 m + 3); the last two are the work at the right and the left site.
    """
    n, m = system.modal.shape
    state = np.zeros((n, 2 * m - CLOCK))
    state[:, 0] = displacement
    state[:, m] = velocity / system.beams.forcing
    return state


def advance(
    system: System, state: Array, gaps: Array, growth: Array, periods: int, trace: bool = False
) -> Record:
    """Advance n beams; gaps grow at the end of each contact.

    The record is NaN from the period in which a beam exceeds
    `models.beam.exact.events.EVALUATIONS_PER_PERIOD`.
    """
    record = Record.empty(len(state), periods, system.steps if trace else 0)
    _advance(system, state, gaps, growth, record, False)
    return record


def speeds(system: System, state: Array, gaps: Array, trace: Array) -> Array:
    """Return the tip's dx/d(Omega t) at each sample of traces, shape (n, samples).

    Parameters
    ----------
    system : System
    state : ndarray, shape (n, 2 m + 3)
        At the start of the traces; not changed.
    gaps : ndarray, shape (n, 2)
        Constant.
    trace : ndarray, shape (n, samples)
        As recorded by `advance`.
    """
    record = Record.empty(len(state), trace.shape[1] // system.steps, system.steps)
    _advance(system, state.copy(), gaps.copy(), np.zeros_like(gaps), record, True)
    return record.trace


def _advance(
    system: System, state: Array, gaps: Array, growth: Array, record: Record, of_speeds: bool
) -> None:
    """Advance n beams over the periods of their record."""
    for i, (free, contact) in enumerate(system.phases):
        row = Record(*(a[i] for a in record))
        if system.beams.load[i]["power"] > 0:
            _advance_random(system, i, state[i], gaps[i], growth[i], row, of_speeds)
        else:
            advance_beam(free, contact, state[i], gaps[i], growth[i], row, of_speeds)


def monodromy(system: System, state: Array, gaps: Array, periods: int) -> Array:
    """Return the derivative; zero for the clock and the work of unfinished contacts.

    NaN where `advance` returns NaN.
    """
    out = np.zeros((*state.shape, state.shape[1]))
    for i, pair in enumerate(system.phases):
        found = passage(Beam.of(pair), state[i, :CLOCK], gaps[i], periods=periods)
        out[i, :CLOCK, :CLOCK] = found.tangents[:, :CLOCK]
    return out


def _advance_random(
    system: System,
    row: int,
    state: Array,
    gaps: Array,
    growth: Array,
    record: Record,
    of_speeds: bool,
) -> None:
    """Advance one beam under a random load, whose phasors are reset in each period."""
    free, contact = system.phases[row]
    load = system.beams.load[row]
    lines = np.empty((COUNT, 3))
    drawn = -1
    periods = len(record.work)
    steps = len(record.trace) // periods
    for period in range(periods):
        if np.isnan(state[0]):  # out of budget
            record.work[period:] = record.strobe[period:] = np.nan
            record.trace[period * steps :] = np.nan
            return
        epoch, since = divmod(int(state[CLOCK]), int(load["epoch"]))
        if epoch != drawn:
            draw(load, epoch, lines)
            set_lines(free, contact, system.beams, row, lines)
            drawn = epoch
        for j in range(COUNT):
            angle = 2 * np.pi * turn_at(lines[j, SPEED], lines[j, TURN], since)
            free.phasor[:, j] = np.cos(angle), np.sin(angle)
        one = Record(
            record.work[period : period + 1],
            record.strobe[period : period + 1],
            record.peak,
            record.trace[period * steps : (period + 1) * steps],
        )
        advance_beam(free, contact, state, gaps, growth, one, of_speeds)
