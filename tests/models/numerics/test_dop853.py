"""The integrator on systems whose motion is known."""

import math

import numpy as np
import pytest
from scipy.integrate import DOP853, solve_ivp
from scipy.linalg import expm

from models.numerics.dop853 import GUARDED, OUT_OF_BUDGET, REACHED_END, STUCK, integrator
from models.numerics.jit import kernel

RNG = np.random.default_rng(853)
NEVER = np.empty(0)


@kernel
def _cubic_rates(t, y, p, dy):
    matrix, cubic = p
    for i in range(len(y)):
        dy[i] = cubic * y[0] ** 3 * (2 + math.cos(t)) if i == len(y) - 1 else 0.0
        for j in range(len(y)):
            dy[i] += matrix[i, j] * y[j]


@kernel
def _spring_rates(t, y, p, dy):
    stiffness, gravity, _ = p
    dy[0], dy[1] = y[1], -stiffness * y[0] - gravity


@kernel
def _within(t, y, p, guard):
    guard[0], guard[1] = p[2] - abs(y[0]), y[0]


@kernel
def _pulse_rates(t, y, p, dy):
    dy[0] = math.exp(-(((t - 500) / p) ** 2))


@kernel
def _near_the_pulse(t, y, p):
    return max(500 - t - 6 * p, p)


_integrate_pulse = integrator(_pulse_rates, longest=_near_the_pulse)
_integrate_cubic = integrator(_cubic_rates)
_integrate_spring = integrator(_spring_rates, _within, 2)


@kernel
def cubic(end, y, step, matrix, factor, relative, absolute, budget, times, samples):
    p = (matrix, factor)
    return _integrate_cubic(0.0, end, y, step, p, relative, absolute, budget, times, samples)


@kernel
def spring(t, y, step, p, tolerance, times, samples):
    absolute = np.full(2, tolerance)
    return _integrate_spring(t, 100.0, y, step, p, tolerance, absolute, 10_000, times, samples)


@kernel
def bounces(y, restitution, count, tolerance, out):
    """Set out to the times at which a ball meets the ground."""
    t = step = 0.0
    for i in range(count):
        ended = spring(t, y, step, (0.0, 1.0, 1e9), tolerance, out[:0], np.empty((0, 2)))
        t, step = ended.time, ended.step
        y[0], y[1] = 0.0, -restitution * y[1]
        out[i] = t


@kernel
def pulse(y, width, tolerance, times, samples):
    absolute = np.full(1, tolerance)
    return _integrate_pulse(
        0.0, 500 + 6 * width, y, 0.0, width, tolerance, absolute, 1000, times, samples
    )


def one_step(matrix, y, h, times=NEVER):
    """Take a single step of size h, whatever its error."""
    y, samples = y.copy(), np.full((len(times), len(y)), np.nan)
    allowed = np.full(len(y), 1e9)
    ended = cubic(h, y, h, matrix, 0.0, 0.0, allowed, 10, times, samples)
    assert (ended.status, ended.time, ended.steps) == (REACHED_END, h, 1)
    return y, samples


def test_a_step_has_order_8_and_its_dense_output_order_7():
    matrix, y0 = RNG.normal(size=(4, 4)), RNG.normal(size=4)
    steps, inside = np.array([0.1, 0.2]), np.array([0.3, 0.5, 0.8])
    errors = []
    for h in steps:
        y, samples = one_step(matrix, y0, h, inside * h)
        exact = np.array([expm(matrix * theta * h) @ y0 for theta in inside])
        errors.append([abs(y - expm(matrix * h) @ y0).max(), abs(samples - exact).max()])
    orders = np.log2(np.divide(errors[1], errors[0]))
    np.testing.assert_allclose(orders, [9, 8], atol=0.35)


@pytest.mark.parametrize(("relative", "absolute"), [(1e-4, 1e-7), (1e-9, 1e-12), (0.0, 1e-6)])
def test_steps_are_those_of_scipy(relative, absolute):
    """A forced Duffing oscillator, per-component tolerances: the same steps to rounding."""
    matrix = np.array([[0.0, 1.0], [-1.0, -0.1]])
    allowed = absolute * np.array([1.0, 3.0])

    def rates(t, y):
        return matrix @ y + [0, -2 * y[0] ** 3 * (2 + np.cos(t))]

    solver = DOP853(rates, 0.0, [1.0, 0.5], 30.0, rtol=max(relative, 1e-13), atol=allowed)
    while solver.status == "running":
        solver.step()
    y = np.array([1.0, 0.5])
    ended = cubic(30.0, y, 0.0, matrix, -2.0, relative, allowed, 10_000, NEVER, np.empty((0, 2)))
    evaluations = 2 + 11 * ended.steps  # and one more for each step that is accepted
    assert ended.status == REACHED_END
    assert 0 < solver.nfev - evaluations <= ended.steps
    np.testing.assert_allclose(y, solver.y, rtol=0, atol=1e-9 * max(relative, absolute) / 1e-12)


def test_samples_are_taken_where_asked_and_no_further():
    times = np.array([0.0, 0.1, 0.1, 3.0, 9.999, 10.0, 10.001])
    samples = np.full((7, 2), np.nan)
    matrix = np.array([[0.0, 1.0], [-1.0, 0.0]])
    y = np.array([0.0, 1.0])
    ended = cubic(10.0, y, 0.0, matrix, 0.0, 0.0, np.full(2, 1e-13), 10_000, times, samples)
    assert ended.sampled == 6
    expected = np.stack([np.sin(times[:6]), np.cos(times[:6])], axis=1)
    np.testing.assert_allclose(samples[:6], expected, rtol=0, atol=1e-11)
    np.testing.assert_array_equal(samples[5], y)
    assert np.isnan(samples[6]).all()


def test_the_end_is_reached_to_the_bit():
    for end in RNG.uniform(1, 10, size=100):
        samples, y = np.full((1, 1), np.nan), np.array([1.0])
        allowed, at_end = np.full(1, 1e-7), np.array([end])
        ended = cubic(end, y, 0.0, -np.eye(1), 0.0, 0.0, allowed, 1000, at_end, samples)
        assert ended.time == end
        np.testing.assert_allclose(samples[0], y, rtol=1e-14)


@pytest.mark.parametrize("limit", [0.0, 0.6, 0.999])
def test_an_oscillator_leaves_its_range_on_time(limit):
    """From zero, opening: up to a limit, or else down to zero again after half a period."""
    y = np.array([0.0, 1.0])
    ended = spring(0.0, y, 0.0, (1.0, 0.0, limit or 2.0), 1e-13, NEVER, np.empty((0, 2)))
    expected = math.asin(limit) if limit else math.pi
    assert (ended.status, ended.guard) == (GUARDED, 0 if limit else 1)
    # Near the top the guard falls slowly: an error of the state is amplified in time.
    np.testing.assert_allclose(ended.time, expected, rtol=0, atol=1e-12 / abs(math.cos(expected)))
    np.testing.assert_allclose(y[0], limit, rtol=0, atol=1e-15)
    np.testing.assert_allclose(y[1], math.cos(expected), rtol=0, atol=1e-12)


def test_a_state_at_an_event_samples_like_any_other():
    times = np.array([3.0, math.pi + 1e-6])
    samples = np.full((2, 2), np.nan)
    spring(0.0, np.array([0.0, 1.0]), 0.0, (1.0, 0.0, 2.0), 1e-12, times, samples)
    np.testing.assert_allclose(samples[0], [math.sin(3), math.cos(3)], rtol=0, atol=1e-11)
    assert np.isnan(samples[1]).all()


@pytest.mark.parametrize("tolerance", [1e-6, 1e-12])
def test_a_ball_bounces_on_time(tolerance):
    """Gravity 1, from height 1/2; a parabola is integrated without error at any tolerance."""
    restitution, count = 0.8, 60
    out = np.empty(count)
    y = np.array([0.5, 0.0])
    bounces(y, restitution, count, tolerance, out)
    flights = 2 * restitution ** np.arange(1, count)
    np.testing.assert_allclose(np.diff(out), flights, rtol=0, atol=5e-13)
    np.testing.assert_allclose(out[0], 1.0, rtol=0, atol=5e-13)
    np.testing.assert_allclose(y[1], restitution**count, rtol=0, atol=1e-14)


@pytest.mark.parametrize("speed", [1e-3, 1e-6, 1e-9])
def test_a_hop_much_shorter_than_a_step_is_seen(speed):
    y = np.array([0.0, speed])
    ended = spring(0.0, y, 1.0, (0.0, 1.0, 1e9), 1e-3, NEVER, np.empty((0, 2)))
    assert (ended.status, ended.guard) == (GUARDED, 1)
    np.testing.assert_allclose(ended.time, 2 * speed, rtol=1e-6, atol=1e-15)
    np.testing.assert_allclose(y[1], -speed, rtol=1e-6)


def test_the_first_of_two_guards_counts():
    """A step so long that the ball has fallen past both before it is looked at."""
    y = np.array([0.5, 0.0])
    ended = spring(0.0, y, 8.0, (0.0, 1.0, 1.0), 1e-9, NEVER, np.empty((0, 2)))
    assert ended.guard == 1
    np.testing.assert_allclose(ended.time, 1.0, rtol=1e-12)


def test_a_guard_that_shuts_at_once_stops_at_once():
    y = np.array([0.0, -1.0])
    ended = spring(3.0, y, 0.1, (0.0, 1.0, 1e9), 1e-6, NEVER, np.empty((0, 2)))
    assert (ended.status, ended.guard, ended.time) == (GUARDED, 1, 3.0)
    np.testing.assert_array_equal(y, [0.0, -1.0])


def test_every_integration_ends():
    blowing_up = np.zeros((1, 1))

    def run(factor, budget):
        y, none = np.array([1.0]), np.empty((0, 1))
        allowed = np.full(1, 1e-9)
        return cubic(10.0, y, 0.0, blowing_up, factor, 0.0, allowed, budget, NEVER, none)

    singular = run(1.0, 100_000)  # where 1/(2 y^2) = 1/2 - 2 t - sin t is zero
    assert singular.status == STUCK
    np.testing.assert_allclose(2 * singular.time + math.sin(singular.time), 0.5, atol=1e-6)
    assert run(math.nan, 1000).status == STUCK
    assert run(-1.0, 7)._replace(step=0, time=0) == (OUT_OF_BUDGET, 0, -1, 0, 7, 0)


def test_scipy_agrees_on_a_guarded_flight():
    """A spring too soft to hold the ball up: numbers that no formula of ours has produced."""

    def ground(t, y):
        return y[0]

    ground.terminal, ground.direction = True, -1
    solution = solve_ivp(
        lambda t, y: [y[1], -0.3 * y[0] - 1.0],
        (0, 100),
        [0.2, 1.3],
        "DOP853",
        events=ground,
        rtol=1e-13,
        atol=1e-13,
    )
    y = np.array([0.2, 1.3])
    ended = spring(0.0, y, 0.0, (0.3, 1.0, 1e9), 1e-13, NEVER, np.empty((0, 2)))
    np.testing.assert_allclose(ended.time, solution.t[-1], rtol=0, atol=1e-12)
    np.testing.assert_allclose(y, solution.y[:, -1], rtol=0, atol=1e-12)


@pytest.mark.parametrize("width", [1e-3, 1.0])
def test_steps_no_longer_than_the_system_wants_miss_no_pulse(width):
    y = np.zeros(1)
    ended = pulse(y, width, 1e-10, NEVER, np.empty((0, 1)))
    assert ended.status == REACHED_END
    np.testing.assert_allclose(y, np.sqrt(np.pi) * width, rtol=1e-8)
