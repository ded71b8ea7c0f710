"""Small linear systems: solved to rounding, and singular ones harm no other."""

import numpy as np

from models.numerics.linear import product, solve


def test_solutions_are_those_of_lapack_in_any_units():
    rng = np.random.default_rng(1)
    matrix = rng.normal(size=(50, 10, 10)) * 10.0 ** rng.uniform(-6, 6, (50, 10, 1))
    matrix[:, 0, 0] = 0.0  # no pivot where one would start
    right = rng.normal(size=(50, 10, 3)) * np.abs(matrix).max(axis=2, keepdims=True)
    expected = np.linalg.solve(matrix, right)
    solution, regular = solve(matrix, right)
    assert regular.all()
    np.testing.assert_allclose(solution, expected, rtol=0, atol=1e-10 * np.abs(expected).max())


def test_singular_matrices_are_flagged_and_harm_no_other():
    rng = np.random.default_rng(2)
    matrix, right = rng.normal(size=(6, 4, 4)), rng.normal(size=(6, 4, 1))
    matrix[1, 2], matrix[3, :, 1], matrix[4, 0, 0] = 0.0, 0.0, np.nan
    regular = np.isin(np.arange(6), (0, 2, 5))
    expected = np.linalg.solve(matrix[regular], right[regular])
    solution, solvable = solve(matrix, right)
    np.testing.assert_array_equal(solvable, regular)
    np.testing.assert_allclose(solution[regular], expected, rtol=1e-12)
    assert np.all(solution[~regular] == 0)


def test_products_are_those_of_numpy():
    rng = np.random.default_rng(3)
    matrix, right = rng.normal(size=(7, 3, 5)), rng.normal(size=(7, 4, 5)).transpose(0, 2, 1)
    np.testing.assert_allclose(product(matrix, right), matrix @ right, rtol=1e-13, atol=1e-13)
