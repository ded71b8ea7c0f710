"""Exact propagation from event to event: the reference for the beam.

Free flight and contact are linear, see `models.beam.exact.phases`, and the instants between them
are found to rounding, see `models.beam.exact.events`. One beam at a time, at about twenty times the
cost of `models.beam.lanes`. Like that, a `models.beam.structure.propagation.Propagator`.
"""

import numpy as np

from models.beam.exact.one_beam import CLOCK, advance_beam
from models.beam.exact.passage import passage
from models.beam.exact.systems import System
from models.beam.exact.tuning import Beam
from models.beam.structure.interpolation import REACH
from models.beam.structure.modal import Array
from models.beam.structure.propagation import Record
from models.beam.structure.random_load import FINER
from models.beam.structure.random_response import (
    Workspace,
    opening,
    samples_per_stretch,
    set_gain,
    set_stretches,
)


def start(system: System, displacement: Array, velocity: Array) -> Array:
    """Return z and dz/d(Omega t) of each mode, the clock, and the work of unfinished contacts.

    The shape is (n, 2 m + 3); the last two are the work at the right and the left site. The modes
    are without their response to a random load.
    """
    n, m = system.modal.shape
    state = np.zeros((n, 2 * m - CLOCK))
    state[:, 0] = displacement
    state[:, m] = velocity / system.beams.forcing
    b = system.beams
    if b.is_random.any():
        response = opening(b.load, b.forcing, b.oscillators)
        state[:, :m] -= response[:, 0]
        state[:, m : 2 * m] -= response[:, 1] / b.forcing[:, None]
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
            advance_beam(free, contact, np.empty(0), state[i], gaps[i], growth[i], row, of_speeds)


def monodromy(system: System, state: Array, gaps: Array, periods: int) -> Array:
    """Return the derivative; zero for the clock and the work of unfinished contacts.

    NaN where `advance` returns NaN.
    """
    out = np.zeros((*state.shape, state.shape[1]))
    for i, pair in enumerate(system.phases):
        motion = passage(Beam.of(pair), state[i, :CLOCK], gaps[i], periods=periods)
        out[i, :CLOCK, :CLOCK] = motion.tangents[:, :CLOCK]
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
    """Advance one beam under a random load, from one stretch of it to the next."""
    b, load = system.beams, system.beams.load[row]
    work = Workspace.of(system.beams.load)
    gain = np.empty((2, load["size"] // 2))
    samples = np.empty((2, samples_per_stretch(load)))
    set_gain(load, b.forcing[row], b.oscillators[row], gain)
    per_period = FINER * load["rate"]
    periods, done, drawn = len(record.work), 0, -1
    steps = len(record.trace) // periods
    while done < periods:
        if np.isnan(state[0]):  # out of budget
            record.work[done:] = record.strobe[done:] = np.nan
            record.trace[done * steps :] = np.nan
            return
        stretch, since = divmod(int(state[CLOCK]), int(load["stretch"]))
        if stretch // 2 != drawn:
            drawn = stretch // 2
            set_stretches(load, gain, drawn, work, samples)
        until = min(periods, done + int(load["stretch"]) - since)
        first = since * per_period
        last = first + (until - done) * per_period + REACH - 1
        part = Record(
            record.work[done:until],
            record.strobe[done:until],
            record.peak,
            record.trace[done * steps : until * steps],
        )
        here = samples[stretch % 2, first:last]
        advance_beam(*system.phases[row], here, state, gaps, growth, part, of_speeds)
        done = until
