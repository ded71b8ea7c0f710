"""Every propagator of the machines, with what each needs to be called alike."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from models.beam import exact as beam_exact
from models.beam import lanes as beam_lanes
from models.beam.parameters import Params as Beam
from models.beam.parameters import Settings as BeamSettings
from models.beam.structure.modal import beams
from models.mole import exact as mole_exact
from models.mole import lanes as mole_lanes
from models.mole.lanes.rows import HALF
from models.mole.parameters import Params as Mole
from models.mole.parameters import Settings as MoleSettings
from models.mole.theory.system import mole as mole_system
from models.numerics.blocks import LANES
from models.vibrator import exact as vibrator_exact
from models.vibrator import lanes as vibrator_lanes
from models.vibrator.equations.system import system as vibrator_system
from models.vibrator.exact.propagator import scales_of
from models.vibrator.lanes.tangents import FREE
from models.vibrator.parameters import Params as Vibrator
from models.vibrator.parameters import Settings as VibratorSettings

N = LANES + 5  # more than a block, and not a whole one


def rows_of(declared: Any, scattered: tuple[str, ...], **fixed: float) -> np.ndarray:
    """Return N machines within some per cent of the nominal one, as a study has them."""
    rng = np.random.default_rng(3)
    nominal = declared()._replace(**fixed)
    rows = np.tile(np.array(nominal, float), (N, 1))
    for name in scattered:
        rows[:, declared._fields.index(name)] *= rng.uniform(0.95, 1.05, N)
    return rows


class Carried(NamedTuple):
    """A propagator with what its machine needs besides, so that all are called alike.

    ``groups(rows)`` and ``start(system, rows)`` take rows of a study, ``advance`` and
    ``monodromy`` whole periods. `sizes` are those of the state's components, 0 where a component
    cannot be varied; `close` is how near a derivative comes to a difference.
    """

    propagator: Any
    rows: np.ndarray
    groups: Callable[[np.ndarray], Any]
    start: Callable[[Any, np.ndarray], np.ndarray]
    advance: Callable[[Any, np.ndarray, int], Any]
    monodromy: Callable[[Any, np.ndarray, int], np.ndarray]
    sizes: Callable[[np.ndarray], np.ndarray]
    close: float = 1e-6
    in_parts: float = 0.0


def carried_beam(propagator):
    def columns(rows):
        return Beam._make(rows.T)

    def groups(rows):
        settings = BeamSettings(elements=6)
        return propagator.groups(beams(columns(rows), settings), settings)

    def start(system, rows):
        p = columns(rows)
        x0 = p.initial_gap
        return propagator.start(system, p.initial_displacement / x0, p.initial_velocity / x0)

    def advance(system, state, periods):
        still = np.zeros((len(state), 2))
        return propagator.advance(system, state, np.ones_like(still), still, periods)

    def monodromy(system, state, periods):
        return propagator.monodromy(system, state, np.ones((len(state), 2)), periods)

    def sizes(state):
        out = np.ones(state.shape[1])
        out[propagator.CLOCK :] = 0.0  # and, of the exact one, the work of unfinished contacts
        return out

    scattered = ("contact_stiffness", "force_amplitude", "initial_gap", "length")
    rows = rows_of(Beam, scattered)
    return Carried(propagator, rows, groups, start, advance, monodromy, sizes)


def carried_mole():
    def groups(rows):
        return mole_lanes.groups(Mole._make(rows.T), MoleSettings(tolerance=1e-10))

    def start(system, rows):
        p = Mole._make(rows.T)
        return mole_lanes.start(system, p.initial_displacement, p.initial_velocity)

    def limit(state, periods):
        return (state[:, HALF] / 2).astype(int) + periods

    def advance(system, state, periods):
        return mole_lanes.advance(system, state, limit(state, periods))

    def monodromy(system, state, periods):
        return mole_lanes.monodromy(system, state, limit(state, periods))

    def sizes(state):
        sticks = state[0, :3] == 0
        return np.array([1e-2, 1.0, 0.1, 1.0, 80.0]) * [*~sticks, True, True]

    rows = rows_of(Mole, ("bar_friction", "spring_stiffness", "resistance", "stop_gap"))
    rng = np.random.default_rng(11)
    rows[:, Mole._fields.index("control_frequency")] = rng.uniform(2.5, 13, N)
    rows[:, Mole._fields.index("supply_phase")] = rng.uniform(0, 6, N)
    # Some bars meet the stop in 2 us: then the step with which a lane begins counts.
    rows[::4, Mole._fields.index("initial_displacement")] = -2.002e-3
    rows[::4, Mole._fields.index("stop_gap")] = -2e-3
    rows[::4, Mole._fields.index("initial_velocity")] = 1.0
    return Carried(
        mole_lanes, rows, groups, start, advance, monodromy, sizes, close=1e-4, in_parts=1e-6
    )


def carried_vibrator():
    per_turn = 96

    def turns(state, count):
        return np.full(len(state), count * 2 * np.pi / 157)

    def groups(rows):
        return vibrator_lanes.groups(Vibrator._make(rows.T.copy()), VibratorSettings())

    def start(system, rows):
        state = vibrator_lanes.start(system)
        state[:, 8:] = 150.0  # under way, where bearings keep their sign
        return state

    def advance(system, state, periods):
        nowhere, h = np.full(len(state), np.nan), turns(state, 1) / per_turn
        return vibrator_lanes.advance(system, state, h, nowhere, periods * per_turn, 0.05, False)

    def monodromy(system, state, periods):
        return vibrator_lanes.monodromy(system, state, turns(state, periods), periods * per_turn)

    def sizes(state):
        return np.isin(np.arange(state.shape[1]), FREE) * np.repeat([1e-2, 1.0], 5)

    rows = rows_of(Vibrator, ("body_mass", "unbalance_1", "stiffness_x"))
    return Carried(vibrator_lanes, rows, groups, start, advance, monodromy, sizes, close=1e-5)


CARRIED = {
    "beam, lanes": carried_beam(beam_lanes),
    "beam, exact": carried_beam(beam_exact),
    "mole, lanes": carried_mole(),
    "vibrator, lanes": carried_vibrator(),
}


class Followed(NamedTuple):
    """A reference propagator and a machine; `clock` and `numbers` read time and components."""

    propagator: Any
    params: Any
    system: Any
    scales: np.ndarray
    seconds: float
    clock: Callable[[Any], float]
    numbers: Callable[[Any], np.ndarray]

    def propagate(self, state, seconds, tolerance=1e-9, times=()):
        at = self.clock(state)
        times = at + np.asarray(times, float)
        return self.propagator.propagate(self.system, state, at + seconds, tolerance, times=times)


def followed_mole():
    p = Mole(control_frequency=7.0)
    q = mole_system(p, "physical")
    scales = np.array([1e-2, 1.0, 0.1, 1.0, 80.0, 1e-2])
    return Followed(mole_exact, p, q, scales, 0.5, lambda s: s.time, lambda s: s.y[:6])


def followed_vibrator():
    p = Vibrator()
    m = vibrator_system(p)
    degrees = len(vibrator_exact.start(p, m)) // 2
    scales = scales_of(m, degrees)
    return Followed(vibrator_exact, p, m, scales, 0.3, lambda s: 0.0, lambda s: s)


FOLLOWED = {"mole, exact": followed_mole(), "vibrator, exact": followed_vibrator()}
