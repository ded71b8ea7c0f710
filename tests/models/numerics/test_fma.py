"""Fused multiply-adds, compiled and plain, against exact rational arithmetic."""

import itertools
import math
import sys
from fractions import Fraction

import numpy as np
import pytest

from models.numerics.fma import exact_fma, fma
from models.numerics.jit import kernel

RNG = np.random.default_rng(754)
TINY, HUGE = 5e-324, sys.float_info.max
SPECIAL = [0.0, 1.0, 1.5, TINY, sys.float_info.min, HUGE, 2.0**-537, 2.0**537, math.inf]
SPECIAL = [sign * x for x in SPECIAL for sign in (1.0, -1.0)] + [math.nan]


@kernel
def _fuse(a, b, c, out):
    for i in range(len(a)):
        out[i] = fma(a[i], b[i], c[i])


@kernel
def _of_mixed_types(n, x):
    return fma(n, x, 1) + fma(-n, 2, x)


def fused(a, b, c):
    out = np.empty(len(a))
    _fuse(a, b, c, out)
    return out


def bits(values):
    """Return the bits of numbers; all NaN are one."""
    values = np.array(values, float)
    return np.where(np.isnan(values), np.nan, values).view(np.int64)


def scattered(n):
    """Return numbers of all sizes, subnormal ones included."""
    return RNG.choice([-1.0, 1.0], n) * RNG.uniform(1, 2, n) * 2.0 ** RNG.integers(-1074, 1024, n)


def cancelling(n):
    """Return a, b and c = -a b but for its rounding: only what is lost is left."""
    a, b = RNG.uniform(-2, 2, (2, n)) * 2.0 ** RNG.integers(-260, 260, (2, n))
    return a, b, -a * b


@pytest.mark.parametrize(
    "numbers",
    [
        RNG.uniform(-2, 2, (3, 2000)),
        scattered((3, 2000)),
        cancelling(2000),
        RNG.uniform(1, 2, (3, 2000)) * 2.0 ** np.array([[-530], [-530], [-1074]]),
    ],
    ids=["alike", "of all sizes", "cancelling", "subnormal"],
)
def test_there_is_one_rounding(numbers):
    a, b, c = numbers
    triples = list(zip(a.tolist(), b.tolist(), c.tolist(), strict=True))
    plain = [exact_fma(*triple) for triple in triples]
    np.testing.assert_array_equal(bits(fused(a, b, c)), bits(plain))
    for (x, y, z), result in zip(triples, plain, strict=True):
        truth = Fraction(x) * Fraction(y) + Fraction(z)
        if math.isfinite(result):
            off = abs(Fraction(result) - truth)
            for neighbour in (math.nextafter(result, -math.inf), math.nextafter(result, math.inf)):
                assert not math.isfinite(neighbour) or off <= abs(Fraction(neighbour) - truth)
        else:
            assert abs(truth) >= Fraction(HUGE) + Fraction(math.ulp(HUGE)) / 2
            assert (result > 0) == (truth > 0)


def test_zeros_infinities_and_what_is_no_number():
    triples = np.array(list(itertools.product(SPECIAL, repeat=3))).T.copy()
    plain = [exact_fma(*triple) for triple in triples.T]
    np.testing.assert_array_equal(bits(fused(*triples)), bits(plain))


def test_a_product_that_overflows_alone_does_not():
    assert exact_fma(2.0**1000, 2.0**24, -HUGE) == 2.0**971
    assert exact_fma(HUGE, 2.0, -math.inf) == -math.inf


def test_any_types_are_taken():
    assert _of_mixed_types(3, 0.5) == exact_fma(3, 0.5, 1) + exact_fma(-3, 2, 0.5)
