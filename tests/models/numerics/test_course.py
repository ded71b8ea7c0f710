"""Times along a coordinate whose rate is known at nodes."""

import math

import numpy as np
import pytest

from models.numerics.course import NEVER, OPEN, REACHED, Course, elapsed


def travel(rate, end, steps, targets=()):
    """Return a course driven over equal steps."""
    course, now = Course((*targets, end)), 0.0
    places = np.linspace(0.0, end, steps + 1)
    for start, stop in zip(places[:-1].tolist(), places[1:].tolist(), strict=True):
        first, last = rate(start), rate(stop)

        def when(part, length=stop - start, first=first, last=last):
            return elapsed(part, length, first, last)

        span = when(stop - start)
        course.step(stop, now, span, (first, last), (0.0, 0.0), when)
        now += span
    return course


def test_elapsed_is_the_integral_of_the_slowness():
    places = np.linspace(0, 3, 20_001)
    for first, last in (0.5, 0.1), (0.2, 0.2), (0.2, 0.2 * (1 + 1e-12)), (0.1, 2.0):
        slowness = 1 / (first + (last - first) * places / 3)
        expected = np.trapezoid(slowness, places)
        np.testing.assert_allclose(elapsed(3.0, 3.0, first, last), expected, rtol=1e-6)


@pytest.mark.parametrize(
    "rate",
    [lambda z: math.exp(-0.4 * z), lambda z: 1 / (1 + z * z), lambda z: 1 + math.sin(z) ** 2],
)
@pytest.mark.parametrize("steps", [10, 20])
def test_where_the_rate_is_smooth_the_error_is_stated_and_not_much_more(rate, steps):
    places = np.linspace(0, 3, 100_001)
    expected = np.trapezoid([1 / rate(z) for z in places], places)
    course = travel(rate, 3.0, steps)
    error = abs(course.times[0] - expected)
    assert error < course.errors[0] < 6 * error + 1e-3 * expected / steps


def test_a_jump_is_within_the_error():
    for jump in np.random.default_rng(4).uniform(0.3, 2.7, 50):
        course = travel(lambda z, jump=jump: 4.0 if z < jump else 1.0, 3.0, 12)
        expected = jump / 4 + (3.0 - jump)
        assert abs(course.times[0] - expected) <= course.errors[0]


def test_targets_are_decided_once():
    course = travel(lambda z: 2.0, 3.0, 3, (1.5,))
    assert course.fates == [REACHED, REACHED] and course.times == [0.75, 1.5]
    assert course.errors == [0.0, 0.0] and course.pending == []
    course = Course((1.0, 2.0))
    course.decide(NEVER, 5.0)
    course.decide(OPEN, 6.0)
    assert course.fates == [NEVER, NEVER] and course.times == [math.inf, math.inf]
