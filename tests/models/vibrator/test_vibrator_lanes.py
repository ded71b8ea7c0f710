"""The fast propagator against the error-controlled one, and the notes it takes."""

import numpy as np
import pytest
from machines import plausible

from models.numerics.blocks import LANES
from models.vibrator import lanes
from models.vibrator.equations import rigid_motion
from models.vibrator.equations.system import systems
from models.vibrator.exact import propagator
from models.vibrator.lanes import notes as noted
from models.vibrator.lanes.machines import prepared
from models.vibrator.theory.averaged import disphasing

ROWS, TURNS, DURATION = 6, 25, 1.0
BAND, DENSER = 0.05, 10
RIGID = {
    "mount_stiffness": np.inf,
    "mount_rotational_stiffness": np.inf,
    "feed_mass": 0.0,
}
MACHINES = plausible(ROWS, seed=1, **RIGID)
LOWS = [noted.ALPHA_LOW, noted.LEFT_LOW, noted.RIGHT_LOW, noted.ANGLE_LOW]
HIGHS = [
    noted.ALPHA_HIGH,
    noted.LEFT_HIGH,
    noted.RIGHT_HIGH,
    noted.ANGLE_HIGH,
]
SYSTEMS = systems(MACHINES)
PREPARED = prepared(MACHINES)
TARGET = disphasing(MACHINES).angle


def at_rest():
    return rigid_motion.initial_state(MACHINES)


def under_way():
    """Return vibrators at full speed, a body at rest, and many turns between the angles."""
    state = at_rest()
    state[:, 3], state[:, 4] = 0.1 + 6 * np.pi, 0.6 - TARGET
    state[:, 8] = state[:, 9] = disphasing(MACHINES).speed
    return state


STARTS = {"at rest": at_rest(), "under way": under_way()}


def advance(start, steps, target=TARGET, accurate=False):
    """Return the states after a second, and the notes."""
    state = start.copy()
    h = np.full(len(state), DURATION / steps)
    return state, lanes.advance(PREPARED, state, h, target, steps, BAND, accurate)


@pytest.fixture(scope="module", params=STARTS)
def start(request):
    return STARTS[request.param]


@pytest.fixture(scope="module")
def ends(start):
    return np.array(
        [propagator.propagate(SYSTEMS.row(i), start[i], DURATION, 1e-13).state for i in range(ROWS)]
    )


def scaled_errors(state, expected):
    scales = [propagator.scales_of(SYSTEMS.row(i), rigid_motion.DEGREES) for i in range(ROWS)]
    return (abs(state - expected) / scales).max(axis=1)


def test_it_agrees_with_the_exact_propagator(start, ends):
    assert np.all(ends[:, 3] - start[:, 3] > 20)
    state, _ = advance(start, 48 * TURNS)
    np.testing.assert_allclose(state[:, 3:5], ends[:, 3:5], rtol=0, atol=1e-8)
    assert np.all(scaled_errors(state, ends) < 1e-8)


def test_it_agrees_with_the_exact_propagator_under_gravity():
    p, state = MACHINES._replace(gravity=np.full(ROWS, 9.81)), at_rest()
    ends = np.array(
        [propagator.propagate(systems(p).row(i), state[i], 1.0, 1e-13).state for i in range(ROWS)]
    )
    steps = 48 * TURNS
    h = np.full(ROWS, DURATION / steps)
    lanes.advance(prepared(p), state, h, TARGET, steps, BAND, accurate=False)
    assert np.all(scaled_errors(state, ends) < 1e-8)


@pytest.mark.parametrize(
    ("order", "per_turn"), [(5, (10, 14, 20)), pytest.param(8, (4, 6, 9), marks=pytest.mark.slow)]
)
def test_its_errors_fall_with_the_order_of_the_method(start, ends, order, per_turn):
    """The machines' geometric mean."""
    errors = [
        scaled_errors(advance(start, TURNS * n, accurate=order == 8)[0], ends) for n in per_turn
    ]
    means = np.exp(np.log(errors).mean(axis=1))
    finer = np.divide(per_turn[1:], per_turn[:-1])
    assert np.all(means[:-1] / means[1:] > finer**order)


def some(rows):
    """Return that many machines, each with a step of its own, for 60 steps."""
    p = plausible(rows, seed=4, **RIGID)
    rng = np.random.default_rng(5)
    state = rigid_motion.initial_state(p)
    state[:, 3:5] += rng.uniform(-4, 4, size=(rows, 2))
    state[:, 8:] = rng.uniform(100, 160, size=(rows, 2))
    h = rng.uniform(5e-4, 1e-3, rows)
    return prepared(p), h, state, rng.uniform(-1, 1, rows)


def bits(machines, h, state, target, accurate, rows):
    """Return states and notes of those rows, run together."""
    out = state[rows]
    notes = lanes.advance(machines.take(rows), out, h[rows], target[rows], 60, 0.3, accurate)
    return np.concatenate([out, notes], axis=1)


@pytest.mark.parametrize("accurate", [False, True])
def test_a_row_has_the_same_bits_in_any_company(accurate):
    count = 2 * LANES + 5
    case = *some(count), accurate
    sound = np.array([i for i in range(count) if i not in (3, 20, 36)])
    together = bits(*case, np.arange(count))
    assert np.isfinite(together).all() and (together[:, -1] >= 0).any()
    machines, h, state = case[:3]
    for numbers, row in ((machines.constants, 3), (h, 20), (state, 36)):
        numbers[row] = np.nan
    order = np.random.default_rng(6).permutation(count)
    np.testing.assert_array_equal(bits(*case, np.arange(count))[sound], together[sound])
    shuffled = bits(*case, order)[np.argsort(order)]
    np.testing.assert_array_equal(shuffled[sound], together[sound])
    for i in sound[::5]:
        np.testing.assert_array_equal(bits(*case, [i])[0], together[i])


def test_a_run_in_two_parts_is_the_run_in_one():
    parts, steps, start = (700, 500), 1200, STARTS["under way"]
    whole, notes = advance(start, steps)
    state, h = start.copy(), np.full(ROWS, DURATION / steps)
    first, second = (lanes.advance(PREPARED, state, h, TARGET, n, BAND, False) for n in parts)
    np.testing.assert_array_equal(state, whole)
    for i in (noted.POWER_1, noted.POWER_2):
        np.testing.assert_allclose(first[:, i] + second[:, i], notes[:, i], rtol=1e-13)
    for i in LOWS:
        lower = np.minimum(first[:, i], second[:, i])
        np.testing.assert_array_equal(lower, notes[:, i])
    for i in HIGHS:
        higher = np.maximum(first[:, i], second[:, i])
        np.testing.assert_array_equal(higher, notes[:, i])
    peak = np.maximum(first[:, noted.EXCURSION], second[:, noted.EXCURSION])
    np.testing.assert_array_equal(peak, notes[:, noted.EXCURSION])
    early, late = first[:, noted.LAST_ENTRY], second[:, noted.LAST_ENTRY]
    assert (early >= 0).any() and (late >= 0).any()
    last = np.where(late >= 0, late + parts[0], early)
    np.testing.assert_allclose(last, notes[:, noted.LAST_ENTRY], rtol=1e-14)


@pytest.fixture(scope="module")
def path(start):
    """Return the exact states at ten instants of each of 1200 steps, the start first."""
    times = np.linspace(0, DURATION, 48 * TURNS * DENSER + 1)
    return np.array(
        [
            propagator.propagate(SYSTEMS.row(i), start[i], DURATION, 1e-12, times=times).samples
            for i in range(ROWS)
        ]
    )


@pytest.fixture(scope="module")
def notes(start):
    return advance(start, 48 * TURNS)[1]


def seen(path):
    """Return rotation, displacements of the deck's ends along xi, and disphasing angle."""
    p = MACHINES
    x, y, alpha, psi_1, psi_2 = np.moveaxis(path, 2, 0)[:5]
    cos, sin = np.cos(p.working_angle)[:, None], np.sin(p.working_angle)[:, None]
    left, right = (
        x * cos + (y + side * p.support_half_spacing[:, None] * alpha) * sin for side in (-1, 1)
    )
    return np.array([alpha, left, right, psi_1 - psi_2])


def test_extremes_are_those_of_the_steps_and_near_those_of_the_motion(path, notes):
    lows, highs = notes[:, LOWS].T, notes[:, HIGHS].T
    at_steps, always = seen(path[:, DENSER::DENSER]), seen(path)
    span = np.ptp(always, axis=2)
    assert np.all(span > 1e-5)
    assert np.all(abs(lows - at_steps.min(axis=2)) < 1e-7 * span)
    assert np.all(abs(highs - at_steps.max(axis=2)) < 1e-7 * span)
    assert np.all(abs(lows - always.min(axis=2)) < 5e-3 * span)
    assert np.all(abs(highs - always.max(axis=2)) < 5e-3 * span)


def test_powers_are_those_of_the_motors(path, notes):
    p, steps = MACHINES, 48 * TURNS
    for i, note in ((1, noted.POWER_1), (2, noted.POWER_2)):
        speed = path[:, :, 7 + i]
        w_s = getattr(p, f"synchronous_speed_{i}")[:, None]
        slip, lag = w_s - getattr(p, f"breakdown_speed_{i}")[:, None], w_s - speed
        breakdown = (p.overload_capacity * getattr(p, f"rated_torque_{i}"))[:, None]
        power = 2 * breakdown * slip * lag / (slip**2 + lag**2) * speed
        at_steps, mean = power[:, DENSER::DENSER].sum(axis=1), power.mean(axis=1)
        size = abs(power).mean(axis=1)
        assert np.all(abs(notes[:, note] - at_steps) < 1e-8 * steps * size)
        assert np.all(abs(notes[:, note] / steps - mean) < 5e-3 * size)


def test_the_largest_displacement_is_found_between_steps(path, notes):
    squared = path[:, :, 0] ** 2 + path[:, :, 1] ** 2
    np.testing.assert_allclose(notes[:, noted.EXCURSION], squared.max(axis=1), rtol=1e-5)


def test_the_last_time_into_the_band(path, notes):
    off = abs(np.angle(np.exp(1j * (seen(path)[3] - TARGET[:, None]))))
    came = (off[:, :-1] > BAND) & (off[:, 1:] <= BAND)
    assert 1 < came.any(axis=1).sum() < ROWS
    for i in range(ROWS):
        last = -1.0
        if came[i].any():
            j = np.flatnonzero(came[i])[-1]
            last = (j + (off[i, j] - BAND) / (off[i, j] - off[i, j + 1])) / DENSER
        np.testing.assert_allclose(notes[i, noted.LAST_ENTRY], last, rtol=0, atol=0.2)


def test_without_a_target_there_is_no_band():
    _, notes = advance(STARTS["under way"], 48 * TURNS, np.full(ROWS, np.nan))
    assert np.all(notes[:, noted.LAST_ENTRY] == -1)
    assert np.isfinite(notes).all()
