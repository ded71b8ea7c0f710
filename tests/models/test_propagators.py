"""What every propagator of every machine promises; see `models.numerics.propagator`."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
import pytest

from models import beam, mole, vibrator
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
from models.numerics.dop853 import REACHED_END
from models.numerics.propagator import Propagator, Yardstick
from models.vibrator import exact as vibrator_exact
from models.vibrator import lanes as vibrator_lanes
from models.vibrator.equations.system import system as vibrator_system
from models.vibrator.exact.propagator import scales_of
from models.vibrator.lanes.tangents import FREE
from models.vibrator.parameters import Params as Vibrator
from models.vibrator.parameters import Settings as VibratorSettings

N = LANES + 5  # more than a block, and not a whole one
PERIODS = 6


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


@pytest.fixture(params=CARRIED)
def carried(request):
    return CARRIED[request.param]


def begun(carried, rows):
    """Yield places, system and state of each group."""
    for places, system in carried.groups(rows):
        yield places, system, carried.start(system, rows[places])


def after(carried, rows, *parts):
    """Return the state of each row after so many periods, in parts."""
    out = {}
    for places, system, state in begun(carried, rows):
        for periods in parts:
            carried.advance(system, state, periods)
        out |= zip(places.tolist(), state, strict=True)
    return [out[i] for i in range(len(rows))]


def same_bits(one, other):
    return all(np.array_equal(a, b, equal_nan=True) for a, b in zip(one, other, strict=True))


def test_it_has_the_functions_of_a_propagator(carried):
    assert isinstance(carried.propagator, Propagator)


def test_each_machine_is_in_one_group(carried):
    places = np.concatenate([places for places, _ in carried.groups(carried.rows)])
    assert sorted(places) == list(range(N))


def test_a_start_is_the_same_again_and_belongs_to_the_caller(carried):
    for places, system, state in begun(carried, carried.rows):
        again = carried.start(system, carried.rows[places])
        assert np.array_equal(state, again)
        assert not np.shares_memory(state, again)


def test_bits_depend_neither_on_company_nor_on_order(carried):
    together = after(carried, carried.rows, PERIODS)
    order = np.random.default_rng(6).permutation(N)
    shuffled = after(carried, carried.rows[order], PERIODS)
    assert same_bits(shuffled, [together[i] for i in order])
    for i in (0, 7, N - 1):
        assert same_bits(after(carried, carried.rows[[i]], PERIODS), [together[i]])
    for places, system, state in begun(carried, carried.rows):
        half = np.arange(0, len(places), 2)
        part = state[half]
        carried.advance(system.take(half), part, PERIODS)
        assert same_bits(part, [together[i] for i in places[half]])


def test_a_machine_that_cannot_be_followed_harms_no_other(carried):
    for _, system, state in begun(carried, carried.rows):
        spoilt = state.copy()
        spoilt[0, 0] = np.inf
        carried.advance(system, state, PERIODS)
        carried.advance(system, spoilt, PERIODS)
        assert same_bits(spoilt[1:], state[1:])
        assert not np.isfinite(spoilt[0]).all()


def test_in_parts_it_comes_where_it_comes_in_one_go(carried):
    first = PERIODS // 2
    whole = after(carried, carried.rows, PERIODS)
    parts = after(carried, carried.rows, first, PERIODS - first)
    assert carried.in_parts or same_bits(parts, whole)
    for one, other in zip(parts, whole, strict=True):
        size = carried.sizes(one[None])
        apart = (one - other)[: len(size)][size > 0] / size[size > 0]
        assert np.abs(apart).max() <= carried.in_parts


def test_the_monodromy_is_the_derivative_of_the_advance(carried):
    """Along random directions, on the way from rest."""
    _, system, state = next(begun(carried, carried.rows[1:2]))
    carried.advance(system, state, 20)
    before = state.copy()
    found = carried.monodromy(system, state, 2)[0]
    assert np.array_equal(state, before)
    sizes, both = carried.sizes(state), np.zeros(2, int)
    rng = np.random.default_rng(8)
    for _ in range(3):
        change = 1e-6 * sizes * rng.normal(size=len(sizes))
        ends = state[both]
        ends[:, : len(change)] += np.outer([1.0, -1.0], change)
        carried.advance(system.take(both), ends, 2)
        expected = (ends[0] - ends[1])[: len(change)] / 2
        wanted = sizes > 0
        apart = (found @ change - expected)[wanted] / sizes[wanted]
        assert np.abs(apart).max() < carried.close * np.abs(expected[wanted] / sizes[wanted]).max()


class Followed(NamedTuple):
    """A yardstick and one machine; `clock` and `numbers` read time and components off a state."""

    yardstick: Any
    params: Any
    system: Any
    scales: np.ndarray
    seconds: float
    clock: Callable[[Any], float]
    numbers: Callable[[Any], np.ndarray]

    def propagate(self, state, seconds, tolerance=1e-9, times=()):
        at = self.clock(state)
        times = at + np.asarray(times, float)
        return self.yardstick.propagate(self.system, state, at + seconds, tolerance, times=times)


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


@pytest.fixture(params=FOLLOWED)
def followed(request):
    return FOLLOWED[request.param]


def apart(followed, one, other):
    return np.abs((followed.numbers(one) - followed.numbers(other)) / followed.scales).max()


def test_it_has_the_functions_of_a_yardstick(followed):
    assert isinstance(followed.yardstick, Yardstick)


def test_what_is_followed_is_left_as_it_is_and_goes_the_same_way_again(followed):
    state, again = (followed.yardstick.start(followed.params, followed.system) for _ in range(2))
    assert np.array_equal(followed.numbers(state), followed.numbers(again))
    motion = followed.propagate(state, followed.seconds)
    assert motion.status == REACHED_END
    assert np.array_equal(followed.numbers(state), followed.numbers(again))
    twice = followed.propagate(state, followed.seconds)
    assert np.array_equal(followed.numbers(motion.state), followed.numbers(twice.state))
    assert apart(followed, state, motion.state) > 0.1


def test_it_goes_on_as_if_it_had_never_stopped_and_samples_the_way(followed):
    start = followed.yardstick.start(followed.params, followed.system)
    stops = followed.seconds * np.array([0.3, 0.77, 1.0])
    whole = followed.propagate(start, followed.seconds, 1e-11, stops)
    state, begin = start, 0.0
    for stop, sample in zip(stops, whole.samples, strict=True):
        state = followed.propagate(state, stop - begin, 1e-11).state
        begin = stop
        found = sample[: len(followed.scales)]
        np.testing.assert_allclose(
            found / followed.scales, followed.numbers(state) / followed.scales, rtol=0, atol=1e-7
        )


def test_its_error_shrinks_with_the_tolerance(followed):
    start = followed.yardstick.start(followed.params, followed.system)
    known, *others = (
        followed.propagate(start, followed.seconds, tolerance).state
        for tolerance in (1e-13, 1e-9, 1e-6)
    )
    near, far = (apart(followed, known, other) for other in others)
    assert near < 0.1 * far < 1e-3


def test_every_machine_that_moves_is_among_them():
    machines = {model.MODEL.name for model in (beam, mole, vibrator)}
    assert {name.partition(",")[0] for name in CARRIED} == machines
