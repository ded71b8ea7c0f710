"""What every propagator of every machine promises; see `models.numerics.propagator`."""

import numpy as np
import pytest
from propagators import CARRIED, FOLLOWED, N

from models import beam, mole, vibrator
from models.numerics.dop853 import REACHED_END
from models.numerics.propagator import Propagator, ReferencePropagator

PERIODS = 6


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


def same_bits(state, other):
    return all(np.array_equal(a, b, equal_nan=True) for a, b in zip(state, other, strict=True))


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


@pytest.mark.parametrize("broken", [np.inf, np.nan])
def test_a_machine_that_cannot_be_followed_harms_no_other(carried, broken):
    for _, system, state in begun(carried, carried.rows):
        spoilt = state.copy()
        spoilt[0, 0] = broken
        carried.advance(system, state, PERIODS)
        carried.advance(system, spoilt, PERIODS)
        assert same_bits(spoilt[1:], state[1:])
        assert not np.isfinite(spoilt[0]).all()


def test_in_parts_it_comes_where_it_comes_in_one_go(carried):
    first = PERIODS // 2
    whole = after(carried, carried.rows, PERIODS)
    parts = after(carried, carried.rows, first, PERIODS - first)
    assert carried.in_parts or same_bits(parts, whole)
    for part, other in zip(parts, whole, strict=True):
        size = carried.sizes(part[None])
        apart = (part - other)[: len(size)][size > 0] / size[size > 0]
        assert np.abs(apart).max() <= carried.in_parts


def test_the_monodromy_is_the_derivative_of_the_advance(carried):
    """Along random directions, on the way from rest."""
    _, system, state = next(begun(carried, carried.rows[1:2]))
    carried.advance(system, state, 20)
    before = state.copy()
    matrix = carried.monodromy(system, state, 2)[0]
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
        apart = (matrix @ change - expected)[wanted] / sizes[wanted]
        assert np.abs(apart).max() < carried.close * np.abs(expected[wanted] / sizes[wanted]).max()


@pytest.fixture(params=FOLLOWED)
def followed(request):
    return FOLLOWED[request.param]


def apart(followed, state, other):
    return np.abs((followed.numbers(state) - followed.numbers(other)) / followed.scales).max()


def test_it_has_the_functions_of_a_reference_propagator(followed):
    assert isinstance(followed.propagator, ReferencePropagator)


def test_what_is_followed_is_left_as_it_is_and_goes_the_same_way_again(followed):
    state, again = (followed.propagator.start(followed.params, followed.system) for _ in range(2))
    assert np.array_equal(followed.numbers(state), followed.numbers(again))
    motion = followed.propagate(state, followed.seconds)
    assert motion.status == REACHED_END
    assert np.array_equal(followed.numbers(state), followed.numbers(again))
    twice = followed.propagate(state, followed.seconds)
    assert np.array_equal(followed.numbers(motion.state), followed.numbers(twice.state))
    assert apart(followed, state, motion.state) > 0.1


def test_it_goes_on_as_if_it_had_never_stopped_and_samples_the_way(followed):
    start = followed.propagator.start(followed.params, followed.system)
    stops = followed.seconds * np.array([0.3, 0.77, 1.0])
    whole = followed.propagate(start, followed.seconds, 1e-11, stops)
    state, begin = start, 0.0
    for stop, sample in zip(stops, whole.samples, strict=True):
        state = followed.propagate(state, stop - begin, 1e-11).state
        begin = stop
        scaled_state = sample[: len(followed.scales)]
        np.testing.assert_allclose(
            scaled_state / followed.scales,
            followed.numbers(state) / followed.scales,
            rtol=0,
            atol=1e-7,
        )


def test_its_error_shrinks_with_the_tolerance(followed):
    start = followed.propagator.start(followed.params, followed.system)
    accurate, *others = (
        followed.propagate(start, followed.seconds, tolerance).state
        for tolerance in (1e-13, 1e-9, 1e-6)
    )
    near, far = (apart(followed, accurate, other) for other in others)
    assert near < 0.1 * far < 1e-3


def test_every_machine_that_moves_is_among_them():
    machines = {model.MODEL.name for model in (beam, mole, vibrator)}
    assert {name.partition(",")[0] for name in CARRIED} == machines
