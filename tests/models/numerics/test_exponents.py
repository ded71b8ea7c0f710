"""Exponents of systems whose exponents are known."""

import numpy as np
import pytest
from scipy.linalg import expm

from models.numerics.exponents import grown, log_multiplier


def test_a_tangent_of_arnold_s_cat_map_grows_by_the_golden_section_squared():
    cat, tangents, growth = np.array([[2.0, 1.0], [1.0, 1.0]]), np.array([[1.0, 0.0]]), []
    for _ in range(300):
        tangents = tangents @ cat
        growth.append(grown(tangents)[0])
    assert np.abs(tangents).max() == 1
    assert np.mean(growth[50:]) == pytest.approx(np.log((3 + np.sqrt(5)) / 2))


def test_the_multiplier_of_a_damped_oscillator():
    damping, frequency = 0.3, 2.0
    rates = np.array([[0.0, 1.0], [-(frequency**2) - damping**2, -2 * damping]])
    time = np.array([0.7, 5.0, 2000.0])
    flow = np.array([expm(rates * t) for t in time[:2]])
    np.testing.assert_allclose(log_multiplier(flow), -damping * time[:2], rtol=1e-9)
    # So long that the flow itself would underflow.
    tangents, growth = np.eye(2).reshape(1, 4), 0.0
    for _ in range(2000):
        tangents = (tangents.reshape(2, 2) @ expm(rates)).reshape(1, 4)
        growth += grown(tangents)[0]
    total = growth + log_multiplier(tangents.reshape(1, 2, 2))[0]
    assert total == pytest.approx(-damping * 2000.0, rel=1e-9)


def test_what_has_died_is_a_number():
    tangents = np.zeros((2, 3))
    assert np.all(np.isfinite(grown(tangents)))
    assert np.all(tangents == 0)
    assert np.all(np.isfinite(log_multiplier(np.zeros((2, 3, 3)))))
