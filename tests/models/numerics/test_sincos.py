"""Sine and cosine for lanes, against the system's."""

import numpy as np
import pytest

from models.numerics.jit import kernel
from models.numerics.sincos import cosine_sine, nearest

RNG = np.random.default_rng(271)


@kernel
def _cosines_sines(x, cosine, sine):
    for i in range(len(x)):
        cosine[i], sine[i] = cosine_sine(x[i])


@kernel
def _nearest(x, out):
    for i in range(len(x)):
        out[i] = nearest(x[i])


def cosines_sines(x):
    cosine, sine = np.empty((2, len(x)))
    _cosines_sines(x, cosine, sine)
    return cosine, sine


def assert_right(x):
    cosine, sine = cosines_sines(x)
    np.testing.assert_allclose(cosine, np.cos(x), rtol=0, atol=4e-16)
    np.testing.assert_allclose(sine, np.sin(x), rtol=0, atol=4e-16)


@pytest.mark.parametrize("largest", [1e-9, 1.0, 10.0, 1e3, 1e5])
def test_they_are_right_to_the_last_bits(largest):
    assert_right(RNG.uniform(-largest, largest, 300_000))


def test_they_are_right_at_the_borders_of_eighths_of_a_turn():
    """Where the argument is reduced to 0, and where one polynomial takes over from the other."""
    border = np.arange(-127_000, 127_001) * (np.pi / 4)
    for ulps in (-3, -1, 0, 1, 3):
        assert_right(border + ulps * np.spacing(border))


def test_small_sines_are_right_relative_to_themselves():
    x = RNG.choice([-1.0, 1.0], 10_000) * 10 ** RNG.uniform(-300, 0, 10_000)
    np.testing.assert_allclose(cosines_sines(x)[1], np.sin(x), rtol=4e-16)


def test_the_cosine_is_even_and_the_sine_odd_to_the_bit():
    x = RNG.uniform(-1e5, 1e5, 100_000)
    (cosine, sine), (even, odd) = cosines_sines(x), cosines_sines(-x)
    np.testing.assert_array_equal(even, cosine)
    np.testing.assert_array_equal(odd, -sine)


def test_vectors_and_single_arguments_have_the_same_bits():
    x = RNG.uniform(-1e3, 1e3, 1000)
    singly = np.array([cosines_sines(x[i : i + 1]) for i in range(len(x))])[:, :, 0]
    np.testing.assert_array_equal(np.stack(cosines_sines(x), axis=1), singly)


def test_what_is_not_a_number_stays_so():
    cosine, sine = cosines_sines(np.array([np.nan, np.inf, -np.inf, 1.0]))
    assert np.isnan(cosine[:3]).all() and np.isnan(sine[:3]).all()
    np.testing.assert_allclose([cosine[3], sine[3]], [np.cos(1), np.sin(1)], rtol=4e-16)


def test_nearest_rounds_as_numpy_does():
    halves = np.arange(-1000, 1001) / 2
    wide = RNG.choice([-1.0, 1.0], 100_000) * 2 ** RNG.uniform(-60, 51, 100_000)
    x = np.concatenate([halves, np.nextafter(halves, np.inf), wide, [2.0**51 - 0.5]])
    out = np.empty_like(x)
    _nearest(x, out)
    np.testing.assert_array_equal(out, np.rint(x))
