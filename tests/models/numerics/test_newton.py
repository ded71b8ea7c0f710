"""Newton's method: known roots, no root, no derivative, and a start that full steps would leave."""

import numpy as np
import pytest

from models.numerics.newton import Linear, find_root


def scalar(f, slope):
    return lambda y: Linear(f(y), np.diag(slope(y)), np.zeros(1))


def test_it_finds_where_a_circle_meets_a_line():
    def function(y):
        residual = np.array([y @ y - 25, y[0] - 0.75 * y[1]])
        return Linear(residual, np.array([2 * y, [1, -0.75]]), np.zeros(2), about="both")

    root = find_root(function, np.array([1.0, 1.0]), 1e-12)
    assert root.outcome == "converged"
    assert root.linear.about == "both"
    np.testing.assert_allclose(root.state, [3, 4], rtol=1e-13)
    assert root.residual <= 1e-12
    assert 3 < root.iterations < 9


def test_from_a_root_it_takes_no_step():
    root = find_root(scalar(np.sin, np.cos), np.zeros(1), 1e-12)
    assert (root.outcome, root.iterations) == ("converged", 0)


def test_damping_keeps_it_from_diverging():
    """From beyond 1.39 full steps towards the root of the arc tangent overshoot ever farther."""
    function = scalar(np.arctan, lambda y: 1 / (1 + y**2))
    root = find_root(function, np.array([5.0]), 1e-12)
    assert root.outcome == "converged"
    assert abs(root.state[0]) < 1e-12


def test_short_steps_stay_with_the_nearest_root():
    function = scalar(np.sin, np.cos)
    start = np.array([0.49 * np.pi])
    far = find_root(function, start, 1e-12)
    near = find_root(function, start, 1e-12, longest=0.5)
    assert near.outcome == "converged"
    assert abs(near.state[0]) < 1e-12
    assert far.outcome != "converged" or abs(far.state[0]) > 1


def test_without_a_root_it_says_so():
    function = scalar(lambda y: y**2 + 1, lambda y: 2 * y)
    root = find_root(function, np.array([3.0]), 1e-12)
    assert root.outcome == "stalled"
    assert root.residual >= 1
    assert find_root(function, np.zeros(1), 1e-12).outcome == "singular"
    assert find_root(function, np.array([np.inf]), 1e-12).outcome == "stalled"


@pytest.mark.parametrize("iterations", [1, 3])
def test_it_counts_its_steps(iterations):
    function = scalar(lambda y: y**3, lambda y: 3 * y**2)  # converges by a third at a time
    root = find_root(function, np.ones(1), 1e-12, iterations=iterations)
    assert (root.outcome, root.iterations) == ("stalled", iterations)
    np.testing.assert_allclose(root.state, (2 / 3) ** iterations)
