"""The largest Floquet multiplier is the spectral radius, whatever the matrix looks like."""

import numpy as np
import pytest

from models.numerics.blocks import LANES, aligned
from models.vibrator.lanes.multiplier import largest_multiplier, rooms
from models.vibrator.lanes.packed import load
from models.vibrator.lanes.tangents import ANCHOR, COLUMNS, FREE

KINDS = ["real", "complex pair", "opposite", "two pairs", "close third"]
RADII = np.array([0.03, 0.7, 0.999999, 1.000001, 1.3, 40.0])


def with_passage(passage, units):
    """Return derivatives of ends whose passages have the given ones, in other units."""
    n = len(passage)
    rng = np.random.default_rng(5)
    rates = rng.uniform(1.0, 200.0, (n, COLUMNS + 1))
    late = rng.normal(size=(n, COLUMNS))
    end = np.zeros((n, COLUMNS + 1, COLUMNS + 2))
    rates[:, FREE] *= units
    late /= units
    passage = passage * units[:, None] / units
    end[:, :, -1] = rates
    end[:, ANCHOR, 1:-1] = late * rates[:, ANCHOR, None]
    end[:, FREE, 1:-1] = passage + rates[:, FREE, None] * late[:, None, :]
    return end


def matrices(kind):
    """Return matrices of known spectral radius in a basis that is not orthogonal."""
    rng = np.random.default_rng(6)
    core = np.zeros((len(RADII), COLUMNS, COLUMNS))
    for a, radius in zip(core, RADII, strict=True):
        np.fill_diagonal(a, radius * rng.uniform(-0.9, 0.9, COLUMNS))
        if kind == "complex pair":
            angle = rng.uniform(0.1, 3.0)
            turn = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
            a[:2, :2] = radius * np.array(turn)
        elif kind == "two pairs":
            a[:4, :4] = 0.0
            for i, angle in ((0, 0.4), (2, 2.1)):
                turn = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
                a[i : i + 2, i : i + 2] = radius * np.array(turn)
        elif kind == "close third":
            a[0, 0], a[1, 1], a[2, 2] = radius, -radius * 0.99999, 0.9999 * radius
        elif kind == "opposite":
            a[0, 0], a[1, 1] = radius, -radius
        else:
            a[0, 0] = radius
    basis = np.eye(COLUMNS) + 0.3 * rng.normal(size=core.shape)
    return basis @ core @ np.linalg.inv(basis)


def largest(end):
    """Return the largest multipliers of fewer ends than there are lanes."""
    lanes, radius = aligned(end[0].size * LANES), np.empty(LANES)
    load(end.reshape(len(end), -1), 0, lanes)
    largest_multiplier(lanes, np.ones(LANES, bool), radius, rooms())
    return radius[: len(end)]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("decades", [0, 8])
def test_it_is_the_spectral_radius(kind, decades):
    """In units that differ by up to so many decades."""
    units = 10.0 ** np.linspace(-decades / 2, decades / 2, COLUMNS)
    radii = largest(with_passage(matrices(kind), units))
    np.testing.assert_allclose(radii, RADII, rtol=1e-9)


def test_of_a_map_that_forgets_everything_it_is_0():
    end = np.zeros((1, COLUMNS + 1, COLUMNS + 2))
    end[:, :, -1] = 1.0
    assert largest(end) == 0
