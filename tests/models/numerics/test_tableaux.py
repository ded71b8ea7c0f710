"""Coefficients of Runge-Kutta methods against the conditions of order, one for each rooted tree.

A tree is the sorted tuple of the subtrees at its root. See E. Hairer, S. P. Norsett, G. Wanner,
"Solving Ordinary Differential Equations I", Sec. II.2 and, of the dense output, II.6.
"""

from functools import cache
from itertools import combinations_with_replacement, product

import numpy as np
import pytest

from models.numerics.tableaux import (
    BOGACKI_SHAMPINE_3,
    DENSE_STAGES,
    DENSE_WEIGHTS,
    DORMAND_PRINCE_8,
    ERROR_2,
    ERROR_3,
    ERROR_5,
    TSITOURAS_5,
)

METHODS = {3: BOGACKI_SHAMPINE_3, 5: TSITOURAS_5, 8: DORMAND_PRINCE_8}
ROUNDING = 3e-14  # of the sums in the conditions


@cache
def trees(order):
    """Return all rooted trees of so many vertices."""
    return {tuple(sorted(forest)) for forest in forests(order - 1, order - 1)}


@cache
def forests(vertices, largest):
    """Return all sets of trees of so many vertices together, none with more than `largest`."""
    if vertices == 0:
        return [()]
    all_forests = []
    for size in range(1, min(vertices, largest) + 1):
        for count in range(1, vertices // size + 1):
            some = combinations_with_replacement(sorted(trees(size)), count)
            others = forests(vertices - count * size, size - 1)
            all_forests += [first + rest for first, rest in product(some, others)]
    return all_forests


def size(tree):
    return 1 + sum(map(size, tree))


def density(tree):
    return size(tree) * np.prod([density(branch) for branch in tree], initial=1)


def stages(tree, a):
    """Return the products of a that the condition of a tree weights, one for each stage."""
    return np.prod([a @ stages(branch, a) for branch in tree], axis=0, initial=1) * np.ones(len(a))


def largest_error(weights, a, order, theta=1.0):
    """Return the largest error in the conditions of one order."""
    return max(
        abs(weights @ stages(tree, a) - theta**order / density(tree)) for tree in trees(order)
    )


def test_all_rooted_trees_are_found():
    assert [len(trees(order)) for order in range(1, 9)] == [1, 1, 2, 4, 9, 20, 48, 115]


@pytest.mark.parametrize(
    "method", [BOGACKI_SHAMPINE_3, TSITOURAS_5, DENSE_STAGES], ids=["3", "5", "8"]
)
def test_each_row_sums_to_the_time_of_its_stage(method):
    np.testing.assert_allclose(method.matrix().sum(axis=1), method.c, rtol=0, atol=1e-14)


@pytest.mark.parametrize("order", METHODS)
def test_a_method_has_its_order_and_no_higher_one(order):
    a, b = METHODS[order].matrix(), np.array(METHODS[order].b)
    assert max(largest_error(b, a, n) for n in range(1, order + 1)) < ROUNDING
    assert largest_error(b, a, order + 1) > 1e-6


@pytest.mark.parametrize(
    ("method", "order", "error"), [(3, 2, ERROR_2), (8, 3, ERROR_3), (8, 5, ERROR_5)]
)
def test_an_error_estimate_compares_with_a_step_of_lower_order(method, order, error):
    a, lower = METHODS[method].matrix(), np.array(METHODS[method].b) - error
    assert max(largest_error(lower, a, n) for n in range(1, order + 1)) < ROUNDING
    assert largest_error(lower, a, order + 1) > 1e-6


def dense_weights(theta):
    """Return the weights of the dense output, of 16 stages, at a fraction of the step."""
    first, new = np.eye(16)[0], np.eye(16)[12]
    b = np.array(DENSE_STAGES.b)
    total = np.zeros(16)
    for i, part in enumerate([*DENSE_WEIGHTS[::-1], 2 * b - first - new, first - b, b]):
        total = (total + part) * (1 - theta if i % 2 else theta)
    return total


@pytest.mark.parametrize("theta", [0.1, 0.5, 0.8, 1.0])
def test_the_dense_output_has_order_7_throughout_the_step(theta):
    a, weights = DENSE_STAGES.matrix(), dense_weights(theta)
    assert max(largest_error(weights, a, n, theta) for n in range(1, 8)) < 10 * ROUNDING
    if theta < 1:
        assert largest_error(weights, a, 8, theta) > 1e-9
