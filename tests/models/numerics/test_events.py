"""Where a cubic falls through zero, and where it is lowest."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial

from models.numerics.events import crossing, dip

RNG = np.random.default_rng(5)


def ends(cubic):
    slope = cubic.deriv()
    return cubic(0.0), slope(0.0), cubic(1.0), slope(1.0)


@pytest.mark.parametrize("root", [1e-6, 0.2, 0.5, 0.999])
def test_a_crossing_is_found(root):
    crossings = 0
    for _ in range(50):
        # Falls through its one root in (0, 1): the other two are a complex pair.
        cubic = Polynomial([root, -1.0]) * Polynomial([RNG.uniform(0.3, 2), 0, 1])
        cubic = cubic(Polynomial([0.0, 1.0])) * RNG.uniform(0.1, 10)
        assert crossing(*ends(cubic)) == pytest.approx(root, abs=1e-8)
        crossings += 1
    assert crossings == 50


def test_the_lowest_point_is_found():
    lowest = 0
    for _ in range(500):
        cubic = Polynomial(RNG.normal(size=4))
        g_0, d_0, g_1, d_1 = ends(cubic)
        if d_0 < 0 < d_1:
            at = np.linspace(0, 1, 10_001)
            place, value = dip(g_0, d_0, g_1, d_1)
            assert value == pytest.approx(cubic(at).min(), abs=1e-7)
            assert cubic(place) == pytest.approx(value)
            lowest += 1
    assert lowest > 50
