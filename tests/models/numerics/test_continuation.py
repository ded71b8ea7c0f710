"""Continuation on curves that are known: around a circle, over two folds, through a pitchfork."""

from itertools import islice

import numpy as np
import pytest

from models.numerics.continuation import Steps, begin, follow, locate, step
from models.numerics.newton import Linear

STEPS = Steps(first=0.02, smallest=1e-8, largest=0.1, tolerance=1e-13)


def circle(y, parameter):
    return Linear(y**2 + parameter**2 - 1, np.diag(2 * y), np.array([2 * parameter]))


def cubic(y, parameter):
    return Linear(parameter - y + y**3, np.diag(3 * y**2 - 1), np.ones(1))


def pitchfork(y, parameter):
    return Linear(parameter * y - y**3, np.diag(parameter - 3 * y**2), y)


def coupled(y, parameter):
    """A cubic in many unknowns: y_i = (i + 1) y_0."""
    n = len(y)
    residual = y - y[0] * np.arange(1, n + 1)
    residual[0] = parameter - y[0] + y[0] ** 3
    by_state = np.eye(n)
    by_state[:, 0] -= np.arange(1, n + 1)
    by_state[0, 0] = 3 * y[0] ** 2 - 1
    by_parameter = np.zeros(n)
    by_parameter[0] = 1
    return Linear(residual, by_state, by_parameter)


def turned(a):
    return lambda p: (p.tangent[-1] > 0) != (a.tangent[-1] > 0)


def turns(function, points, nearness=1e-7):
    """Return the two points at each fold."""
    return [
        locate(function, a, b, turned(a), nearness, STEPS.tolerance)
        for a, b in zip(points, points[1:], strict=False)
        if turned(a)(b)
    ]


def test_it_goes_around_a_circle():
    first = begin(circle, np.array([0.9]), 0.1, 1.0, STEPS.tolerance)
    points = list(islice(follow(circle, first, STEPS), 80))
    angle = np.unwrap([np.arctan2(p.parameter, p.state[0]) for p in points])
    radius = np.hypot([p.parameter for p in points], [p.state[0] for p in points])
    np.testing.assert_allclose(radius, 1, rtol=1e-12)
    assert angle[-1] - angle[0] > 2 * np.pi
    assert (np.diff(angle) > 0).all()
    assert np.diff(angle).max() <= 2 * STEPS.largest
    for p in points:
        tangent = [-p.parameter, p.state[0]]
        np.testing.assert_allclose(p.tangent, tangent, atol=1e-12)


@pytest.mark.parametrize(("function", "size"), [(cubic, 1), (coupled, 5)])
def test_folds_are_passed_and_located(function, size):
    first = begin(function, 1.5 * np.arange(1, size + 1), -2.0, 1.0, STEPS.tolerance)
    points = [first]
    for point in follow(function, first, STEPS):
        points.append(point)
        if point.parameter > 2:
            break
    assert points[-1].state[0] < -1.5
    fold = 1 / np.sqrt(3)
    folds = turns(function, points)
    np.testing.assert_allclose([a.state[0] for a, _ in folds], [fold, -fold], atol=1e-6)
    extreme = 2 / 3 * fold
    np.testing.assert_allclose([a.parameter for a, _ in folds], [extreme, -extreme], atol=1e-12)
    for a, b in folds:
        assert np.linalg.norm(b.state - a.state) <= 1e-7 * size**1.5


def test_a_branch_goes_straight_on_through_a_pitchfork():
    first = begin(pitchfork, np.zeros(1), -1.0, 1.0, STEPS.tolerance)
    points = []
    for point in follow(pitchfork, first, STEPS):
        points.append(point)
        if point.parameter > 1:
            break
    assert all(p.state[0] == 0 for p in points)
    assert all(p.tangent[-1] == 1 for p in points)


def test_the_way_to_set_out_is_the_callers():
    for direction in (-1.0, 1.0):
        first = begin(cubic, np.array([1.5]), -2.0, direction, STEPS.tolerance)
        assert np.sign(first.tangent[-1]) == direction
        assert np.sign(next(follow(cubic, first, STEPS)).parameter + 2) == direction


def test_where_nothing_can_be_found_it_says_so():
    assert begin(circle, np.array([0.3]), 1.5, 1.0, STEPS.tolerance) is None
    assert begin(circle, np.zeros(1), 1.0, 1.0, STEPS.tolerance) is None  # a fold
    first = begin(circle, np.array([0.9]), 0.1, 1.0, STEPS.tolerance)
    assert step(circle, first, 10.0, STEPS.tolerance) is None


def test_a_branch_that_ends_is_followed_to_its_end():
    """Beyond the parameter 0.5 the function is not defined."""

    def function(y, parameter):
        residual = y - 1 if parameter <= 0.5 else np.array([np.nan])
        return Linear(residual, np.eye(1), np.zeros(1))

    first = begin(function, np.ones(1), 0.0, 1.0, STEPS.tolerance)
    last = list(follow(function, first, STEPS))[-1]
    assert last.parameter == pytest.approx(0.5, abs=2 * STEPS.smallest)
