"""Elementary functions number by number: the C library's, whatever numpy has for this processor."""

import math

import numpy as np
import pytest

from models.numerics import elementary

RNG = np.random.default_rng(8)


@pytest.mark.parametrize(
    ("name", "reference", "low", "high"),
    [
        ("exp", math.exp, -700, 700),
        ("expm1", math.expm1, -5, 5),
        ("log", math.log, 1e-300, 1e3),
        ("log1p", math.log1p, -0.9, 9),
    ],
)
def test_they_have_the_bits_of_the_c_library(name, reference, low, high):
    x = RNG.uniform(low, high, (3, 500))
    expected = [[reference(value) for value in row] for row in x.tolist()]
    np.testing.assert_array_equal(getattr(elementary, name)(x), expected)


def test_sine_and_cosine_are_right_to_the_last_bits():
    x = RNG.uniform(-100, 100, (3, 500))
    np.testing.assert_allclose(elementary.sin(x), np.sin(x), rtol=0, atol=4e-16)
    np.testing.assert_allclose(elementary.cos(x), np.cos(x), rtol=0, atol=4e-16)


def test_the_logarithm_of_nothing_and_single_numbers():
    np.testing.assert_array_equal(elementary.log([0.0, 1.0]), [-np.inf, 0.0])
    assert elementary.exp(0.0) == 1.0
    assert np.isnan(elementary.log(np.nan))
