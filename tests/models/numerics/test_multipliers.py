"""The largest multiplier of linear maps, against all their eigenvalues."""

import numpy as np
import pytest

from models.numerics.linear import inverse
from models.numerics.multipliers import largest_multiplier, log_radius


def all_of_them(flow):
    return np.abs(np.linalg.eigvals(flow)).max(axis=1)


@pytest.mark.parametrize("size", [1, 5, 8, 29])
def test_random_maps(size):
    flow = np.random.default_rng(size).normal(size=(50, size, size))
    assert np.allclose(largest_multiplier(flow), all_of_them(flow), rtol=1e-8)


def test_a_pair_that_turns_beside_real_ones_of_nearly_its_modulus_in_skew_directions():
    rng = np.random.default_rng(2)
    blocks = np.zeros((12, 12))
    blocks[:2, :2] = 0.98 * np.array([[np.cos(1.1), -np.sin(1.1)], [np.sin(1.1), np.cos(1.1)]])
    blocks[range(2, 12), range(2, 12)] = [0.979, -0.979, 0.9, 0.7, 0.1, 1e-3, 0, 0, 0, 0]
    skew = np.eye(12) + 3 * np.triu(rng.normal(size=(12, 12)), 1)
    flow = skew @ blocks @ np.linalg.inv(skew)
    assert largest_multiplier(flow[None])[0] == pytest.approx(0.98, rel=1e-7)


def test_many_multipliers_of_one_modulus_leave_no_few_directions():
    rotation, _ = np.linalg.qr(np.random.default_rng(3).normal(size=(20, 20)))
    assert largest_multiplier(0.5 * rotation[None])[0] == pytest.approx(0.5, rel=1e-12)


def test_each_map_is_on_its_own():
    flow = np.random.default_rng(4).normal(size=(4, 6, 6))
    flow[1] = 0
    flow[2, 3, 3] = np.nan
    largest = largest_multiplier(flow)
    assert largest[1] == 0 and np.isnan(largest[2])
    assert np.array_equal(largest[3:], largest_multiplier(flow[3:]))


@pytest.mark.parametrize("size", [1, 2, 5, 8])
def test_the_radius_is_that_of_all_eigenvalues(size):
    matrix = np.random.default_rng(size).normal(size=(200, size, size))
    np.testing.assert_allclose(np.exp(log_radius(matrix)), all_of_them(matrix), rtol=1e-11)


def test_radii_of_what_grows_without_bound_fades_away_or_only_shears():
    shear = np.array([[1.0, 1e3], [0.0, 1.0]])
    matrix = np.stack([1e200 * np.eye(2), 1e-300 * np.eye(2), shear, 0 * shear, shear])
    matrix[4, 0, 1] = np.inf
    radius = log_radius(matrix)
    np.testing.assert_allclose(radius[:3], np.log([1e200, 1e-300, 1.0]), rtol=1e-15, atol=1e-12)
    assert radius[3] == -np.inf and np.isnan(radius[4])


def test_inverses_and_a_singular_matrix_among_them():
    matrix = np.random.default_rng(5).normal(size=(6, 29, 29))
    matrix[2, :, 4] = 0
    matrix[4, 0, 0] = 0
    inverted, regular = inverse(matrix)
    assert regular.tolist() == [True, True, False, True, True, True]
    assert np.allclose(inverted[regular] @ matrix[regular], np.eye(29), atol=1e-9)
    assert (inverted[2] == 0).all()
    assert np.array_equal(inverted[4], inverse(matrix[4:5])[0][0])
