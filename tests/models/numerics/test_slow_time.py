"""Slow time on rates whose growth is known: a law of ageing, duty, closing gaps, noise."""

import math

import numpy as np
import pytest

from models.numerics.jit import kernel
from models.numerics.slow_time import (
    ENDED,
    NEVER,
    OUT_OF_BUDGET,
    PENDING,
    REACHED,
    integrator,
)

# EDF's law of tube wear: dV/dt = S_inf + (A U^b - S_inf) exp(-n t).
S_INF, AGEING = 1.14e-16, 2.44e-8
FIRST = 1e-13 * 5e-3**1.2

AGED, MIXED, SEQUENCE, CLOSING, NOISY, RANDOM = range(6)


@kernel
def _coordinates(v, t, state, p, x):
    kind, closes, _, _ = p
    x[0] = 1.0 + v[0]
    if kind == CLOSING:
        x[0] -= closes * t


@kernel
def _rates(v, x, t, state, p, rate, noise):
    kind, share, _, draws = p
    rate[0] = 0.5
    if kind == AGED:
        rate[0] = S_INF / FIRST + (1 - S_INF / FIRST) * math.exp(-AGEING * t)
    elif kind == MIXED:
        rate[0] = share * 3.0 + (1 - share) * 1.0
    elif kind == SEQUENCE:
        rate[0] = 3.0 if state % 2 == 0 else 1.0
    elif kind == NOISY:
        noise[0] = 0.1
    elif kind == RANDOM:
        draws[0] += 1
        rate[0] = (1 + v[0]) * (1 + 0.1 * draws[int(draws[0])])
        noise[0] = 0.1 * (1 + v[0])


@kernel
def _marks(v, x, t, p, mark):
    mark[0] = v[0] - p[2]


@kernel
def _ends(state, p):
    kind, share, _, _ = p
    if kind != SEQUENCE:
        return np.inf
    return state // 2 + (share if state % 2 == 0 else 1.0)


@kernel
def _clock(t, p):
    return 1 / AGEING if p[0] == AGED else np.inf


@kernel
def _awakes(v, t, p):
    return np.inf if p[0] == CLOSING else t


_integrate = integrator(_coordinates, _rates, _marks, _ends, _clock, _awakes)


@kernel
def _run(end, p, accuracy, budget, v, fate, times, errors):
    floor = np.ones(1)
    instants, seen = np.empty(0), np.empty((0, 1))
    return _integrate(0.0, end, v, p, accuracy, floor, budget, fate, times, errors, instants, seen)


def run(kind, share=0.0, goal=1.0, accuracy=0.05, end=1e12, budget=100_000, draws=None):
    """Return how a run ended, its quantity, and the fate, time and error of its event."""
    v, fate = np.zeros(1), np.zeros(1, np.int8)
    times, errors = np.empty((2, 1))
    draws = np.zeros(1) if draws is None else draws
    ended = _run(end, (kind, share, goal, draws), accuracy, budget, v, fate, times, errors)
    return ended, v[0], fate[0], times[0], errors[0]


def test_a_rate_that_ages_is_integrated_to_second_order():
    end, known_errors = 3e8, []
    worn = S_INF * end + (FIRST - S_INF) * -math.expm1(-AGEING * end) / AGEING
    for accuracy in (0.1, 0.05, 0.025, 0.0125):
        ended, v, *_ = run(AGED, goal=1e30, accuracy=accuracy, end=end)
        assert (ended.status, ended.time) == (ENDED, end)
        known_errors.append(abs(v * FIRST / worn - 1))
        assert known_errors[-1] < accuracy**2
    orders = np.log2(np.divide(known_errors[:-1], known_errors[1:]))
    np.testing.assert_allclose(orders[1:], 2, atol=0.3)


@pytest.mark.parametrize("share", [0.25, 0.6])
@pytest.mark.parametrize("goal", [0.3, 7.77, 20.0])
def test_duty_in_sequence_differs_from_mixed_duty_by_less_than_a_cycle(share, goal):
    mean = share * 3.0 + (1 - share) * 1.0
    assert run(MIXED, share, goal)[3] == pytest.approx(goal / mean, rel=1e-12)
    cycles = math.floor(goal / mean)
    rest = goal - cycles * mean
    in_cycle = rest / 3 if rest <= 3 * share else share + (rest - 3 * share)
    time = run(SEQUENCE, share, goal)[3]
    assert time == pytest.approx(cycles + in_cycle, rel=1e-12)
    assert abs(mean * time - goal) <= share * (1 - share) * 2.0 * (1 + 1e-9)


def test_a_gap_that_closes_wears_no_more():
    """X = 1 + t/2 - t closes at t = 2, when V = 1."""
    _, v, fate, time, _ = run(CLOSING, 1.0, goal=0.5)
    assert (fate, time) == (REACHED, pytest.approx(1.0, rel=1e-12))
    _, v, fate, time, _ = run(CLOSING, 1.0, goal=1.5)
    assert (fate, time) == (NEVER, np.inf)
    assert v == pytest.approx(1.0, rel=1e-12)


def test_noise_of_a_rate_is_in_the_error_of_a_time():
    """A time of n independent steps h has the standard error h noise sqrt(n)/rate."""
    ended, _, fate, time, error = run(NOISY, goal=50.0, accuracy=0.05)
    assert (fate, time) == (REACHED, pytest.approx(100.0, rel=1e-12))
    assert 0 < error < 1.645 * 0.1 * time / 0.5
    assert run(MIXED, goal=50.0)[4] == 0


def test_noisy_rates_are_asked_for_once_a_step_and_errors_cover_nine_in_ten():
    """dV/dt = 1 + V, each rate with 10 % noise: T = ln(1 + V)."""
    rng = np.random.default_rng(7)
    known_time, within, asked, steps = math.log(6.0), 0, 0.0, 0
    for _ in range(400):
        draws = np.concatenate([[0.0], rng.normal(size=999)])
        ended, *_, time, error = run(RANDOM, goal=5.0, accuracy=0.3, draws=draws)
        within += abs(time - known_time) <= error
        asked, steps = asked + draws[0], steps + ended.steps
    assert 0.86 <= within / 400 <= 0.97
    assert asked < 1.5 * steps


def test_an_event_beyond_the_end_or_the_steps_is_pending():
    ended, _, fate, time, _ = run(MIXED, goal=50.0, end=10.0)
    assert (ended.status, ended.time, fate, time) == (ENDED, 10.0, PENDING, np.inf)
    assert run(MIXED, goal=50.0, budget=1)[0].status == OUT_OF_BUDGET
