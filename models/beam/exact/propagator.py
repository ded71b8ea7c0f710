"""Exact propagation from event to event: the yardstick of the beam.

Free flight and contact are linear, see `models.beam.exact.phases`, and the instants between them
are found to rounding, see `models.beam.exact.events`. One beam at a time, at some twenty times the
cost of `models.beam.lanes`, whose interface this module shares.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.beam.exact.events import run
from models.beam.exact.passage import passage
from models.beam.exact.phases import Phase, phases, set_lines
from models.beam.exact.tuning import Beam
from models.beam.parameters import Settings
from models.beam.structure.modal import Array, Beams, reach, steady_response
from models.beam.structure.random_lines import COUNT, SPEED, TURN, draw, turn_at
from models.beam.structure.record import LONGEST, Record

CLOCK = -3
"""Column of the state that counts forcing periods."""

TRACE_STEPS = 200


class System(NamedTuple):
    """n beams, prepared.

    Attributes
    ----------
    phases : tuple of (Phase, Phase)
        Free flight and contact of each beam.
    modal : ndarray, shape (n, m), complex
        Steady amplitude of each mode without contact.
    reach : ndarray, shape (n,)
        Bound of the tip's displacement without contact.
    beams : Beams
    forcing : ndarray, shape (n,)
        [rad s-1]
    steps : int
        Samples of a trace in a forcing period.
    """

    phases: tuple[tuple[Phase, Phase], ...]
    modal: NDArray[np.complex128]
    reach: Array
    beams: Beams
    forcing: Array
    steps: int

    @property
    def is_random(self) -> NDArray[np.bool_]:
        """Which beams have a random load, shape (n,)."""
        return self.beams.load["power"] > 0

    @property
    def memory(self) -> Array:
        """Forcing periods in which the first mode's free motion falls to 1/e, shape (n,)."""
        return self.forcing / (2 * np.pi * self.beams.decay[:, 0])

    @property
    def turn(self) -> Array:
        """Forcing periods in a free oscillation of the first mode, shape (n,)."""
        return self.forcing / self.beams.frequency[:, 0]

    @property
    def longest(self) -> int:
        """Forcing periods in a time mean, at most."""
        return LONGEST

    def take(self, rows: NDArray[np.intp]) -> "System":
        """Return the systems of some rows."""
        chosen = tuple(self.phases[i] for i in rows)
        return System(
            chosen,
            self.modal[rows],
            self.reach[rows],
            self.beams.take(rows),
            self.forcing[rows],
            self.steps,
        )


def groups(beams: Beams, settings: Settings) -> Iterator[tuple[NDArray[np.intp], System]]:
    """Find the modes of n beams out of contact and in contact; see `models.beam.lanes.groups`.

    Parameters
    ----------
    beams : Beams
    settings : Settings

    Yields
    ------
    rows : ndarray of int
        All of them: here the beams need nothing in common.
    system : System
    """
    rows = np.arange(len(beams.forcing))
    each = tuple(phases(beams, i) for i in range(len(rows)))
    steps = settings.steps_per_period or TRACE_STEPS
    modal = steady_response(beams)
    yield rows, System(each, modal, reach(beams), beams, beams.forcing, steps)


def finer(system: System) -> Iterator[tuple[NDArray[np.intp], System]]:
    """Return no systems of smaller steps: there are no steps; see `models.beam.lanes.finer`."""
    return iter(())


def start(system: System, displacement: Array, velocity: Array) -> Array:
    """Return the state at phase 0 of the force, tip displaced in the shape of the first mode.

    Parameters
    ----------
    system : System
    displacement, velocity : ndarray, shape (n,)
        Of the tip, in initial gaps and initial gaps per second.

    Returns
    -------
    ndarray, shape (n, 2 m + 3)
        z and dz/d(Omega t) of each mode, the clock: forcing periods since the start, and the work
        of each site's unfinished contact.
    """
    n, m = system.modal.shape
    state = np.zeros((n, 2 * m + 3))
    state[:, 0] = displacement
    state[:, m] = velocity / system.forcing
    return state


def advance(
    system: System, state: Array, gaps: Array, growth: Array, periods: int, trace: bool = False
) -> Record:
    """Advance n beams by whole periods of the force, their gaps growing with the work done.

    Parameters
    ----------
    system : System
    state : ndarray, shape (n, 2 m + 3)
        Updated in place.
    gaps : ndarray, shape (n, 2)
        Right and left, in initial gaps; updated in place, at the end of each contact.
    growth : ndarray, shape (n, 2)
        Gap growth per unit of dimensionless work; zero for no wear.
    periods : int
    trace : bool
        Whether to keep the tip's displacement at every step.

    Returns
    -------
    Record
        NaN from the period on in which a beam needs more than
        `models.beam.exact.events.EVALUATIONS_PER_PERIOD`.
    """
    record = Record.empty(len(state), periods, system.steps if trace else 0)
    for i, (free, contact) in enumerate(system.phases):
        row = Record(*(a[i] for a in record))
        if system.beams.load[i]["power"] > 0:
            _advance_random(system, i, state[i], gaps[i], growth[i], row)
        else:
            run(free, contact, state[i], gaps[i], growth[i], row)
    return record


def monodromy(system: System, state: Array, gaps: Array, periods: int) -> Array:
    """Return how the states after whole periods of the force depend on the states now.

    Parameters
    ----------
    system : System
    state : ndarray, shape (n, 2 m + 3)
        At phase 0 of the force; not changed.
    gaps : ndarray, shape (n, 2)
        Constant, in initial gaps.
    periods : int

    Returns
    -------
    ndarray, shape (n, 2 m + 3, 2 m + 3)
        Derivative of each component after (rows) with respect to each before (columns); zero for
        clock and the work of unfinished contacts. NaN where `advance` gives NaN.
    """
    out = np.zeros((*state.shape, state.shape[1]))
    size = 2 * system.modal.shape[1]
    for i, pair in enumerate(system.phases):
        found = passage(Beam.of(pair), state[i, :size], gaps[i], periods=periods)
        out[i, :size, :size] = found.tangents[:, :size]
    return out


def _advance_random(
    system: System, row: int, state: Array, gaps: Array, growth: Array, record: Record
) -> None:
    """Advance one beam under a random load, whose phasors are set anew in each period."""
    free, contact = system.phases[row]
    load = system.beams.load[row]
    lines = np.empty((COUNT, 3))
    drawn = -1
    periods = len(record.work)
    steps = len(record.trace) // periods
    for period in range(periods):
        if np.isnan(state[0]):  # the budget ended
            record.work[period:] = record.strobe[period:] = np.nan
            record.trace[period * steps :] = np.nan
            return
        epoch, since = divmod(int(state[-3]), int(load["epoch"]))
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
        run(free, contact, state, gaps, growth, one)
