"""Sums over power series: products and values, the same bits compiled and in plain Python."""

import numpy as np
import pytest

from models.numerics import series
from models.numerics.blocks import aligned
from models.numerics.jit import kernel

LANES, TERMS = 8, 7
products, value, value_and_slope = series.sums(LANES)
A, B, C, AT, OUT, MORE = (i * TERMS * LANES for i in range(6))
ROOM = 6 * TERMS * LANES
RNG = np.random.default_rng(4)


@kernel
def multiply(w, k):
    last = k * LANES
    products(w, k + 1, A, B + last, OUT, C + last, MORE)


@kernel
def evaluate(w):
    value(w, TERMS, A, AT, OUT)
    value_and_slope(w, TERMS, B, AT, MORE, OUT + LANES)


def numbers():
    w = aligned(ROOM)
    w[:] = RNG.normal(size=ROOM)
    return w


def coefficients(w, start):
    return w[start : start + TERMS * LANES].reshape(TERMS, LANES).T


@pytest.mark.parametrize("k", range(TERMS))
def test_coefficients_of_products(k):
    w = numbers()
    multiply(w, k)
    for lane in range(LANES):
        a, b, c = (coefficients(w, start)[lane] for start in (A, B, C))
        np.testing.assert_allclose(w[OUT + lane], np.convolve(a, b)[k], rtol=1e-12)
        np.testing.assert_allclose(w[MORE + lane], np.convolve(a, c)[k], rtol=1e-12)


def test_values_and_slopes():
    w = numbers()
    evaluate(w)
    for lane in range(LANES):
        a, b = (np.polynomial.Polynomial(coefficients(w, start)[lane]) for start in (A, B))
        at = w[AT + lane]
        np.testing.assert_allclose(w[OUT + lane], a(at), rtol=1e-11)
        np.testing.assert_allclose(w[MORE + lane], b(at), rtol=1e-11)
        np.testing.assert_allclose(w[OUT + LANES + lane], b.deriv()(at), rtol=1e-11)


def test_plain_python_agrees_to_the_bit():
    plain = series._plain(LANES)
    values = numbers()
    other = values.copy()
    multiply(values, TERMS - 1)
    last = (TERMS - 1) * LANES
    plain.products(other, TERMS, A, B + last, OUT, C + last, MORE)
    np.testing.assert_array_equal(values, other)
    evaluate(values)
    plain.value(other, TERMS, A, AT, OUT)
    plain.value_and_slope(other, TERMS, B, AT, MORE, OUT + LANES)
    np.testing.assert_array_equal(values, other)
