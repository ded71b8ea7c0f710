"""Eigenvalues of symmetric matrices and one row of their eigenvectors, against LAPACK's."""

import numpy as np
import pytest

from models.numerics.symmetric import eigenvalues


@pytest.mark.parametrize("size", [1, 2, 3, 8, 22])
def test_values_and_products_are_those_of_lapack(size):
    rng = np.random.default_rng(size)
    matrix, row = rng.normal(size=(40, size, size)), rng.normal(size=size)
    matrix += matrix.transpose(0, 2, 1)
    values, products = eigenvalues(matrix, row)
    reference, vectors = np.linalg.eigh(matrix)
    np.testing.assert_allclose(values, reference[:, ::-1], rtol=0, atol=1e-13 * size)
    expected = np.abs(row @ vectors)[:, ::-1]
    np.testing.assert_allclose(np.abs(products), expected, rtol=0, atol=1e-10)


def test_what_is_diagonal_or_has_equal_values_is_no_special_case():
    matrix = np.array([np.diag([3.0, 1.0, 2.0, 0.0]), 2 * np.eye(4), np.ones((4, 4))])
    values, products = eigenvalues(matrix, np.array([1.0, 10.0, 100.0, 1000.0]))
    np.testing.assert_allclose(values[0], [3, 2, 1, 0], atol=1e-15)
    np.testing.assert_allclose(np.abs(products[0]), [1, 100, 10, 1000])
    np.testing.assert_allclose(values[1:], [[2, 2, 2, 2], [4, 0, 0, 0]], atol=1e-14)
    # A row's length is that of its products, and the mean of it the vector of ones'.
    np.testing.assert_allclose((products**2).sum(axis=1), 1010101.0)
    assert abs(products[2, 0]) == pytest.approx(1111 / 2)


def test_large_values_are_right_beside_tiny_ones():
    rng = np.random.default_rng(7)
    turn, _ = np.linalg.qr(rng.normal(size=(12, 12)))
    expected = 10.0 ** -np.arange(12.0)
    values, _ = eigenvalues((turn * expected @ turn.T)[None], np.ones(12))
    np.testing.assert_allclose(values[0], expected, rtol=1e-14, atol=1e-15)


def test_a_matrix_that_is_not_finite_harms_no_other():
    matrix = np.stack([np.eye(3), np.full((3, 3), np.nan), np.eye(3)])
    values, _ = eigenvalues(matrix, np.ones(3))
    assert np.isnan(values[1]).any()
    np.testing.assert_array_equal(values[[0, 2]], 1.0)
