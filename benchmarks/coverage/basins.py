"""Basins with known uncertainty exponents: a flat boundary, Cantor's, and no boundary at all."""

from functools import cache

import numpy as np
from scipy.optimize import brentq

from benchmarks.coverage.tally import Tally
from uq.stats.uncertainty_exponent import FARTHEST, uncertainty_exponent

CANTOR = 1 - np.log(2) / np.log(3)
"""The exponent of Cantor's set in the limit; at the distances compared, see `cantor_exponent`."""

SHAPES = ((1000, 2), (3000, 3))
"""Rows and coordinates."""


def flat(points, rng):
    """Return the side of a plane."""
    return (points[:, 0] > 0.5).astype(int)


def oblique(points, rng):
    """Return the side of a plane across all coordinates."""
    return (points.sum(axis=1) > points.shape[1] / 2).astype(int)


def cantor(points, rng=None):
    """Return the parity of the step at which the first coordinate leaves Cantor's set."""
    rest, step = points[:, 0].copy(), np.zeros(len(points), int)
    for k in range(1, 25):
        digit = np.floor(3 * rest)
        rest = 3 * rest - digit
        step[(digit == 1) & (step == 0)] = k
    return step % 2


def scattered(points, rng):
    """Return basins without a boundary: chance."""
    return rng.integers(2, size=len(points))


@cache
def cantor_exponent(d):
    """Return the exponent of Cantor's set up to `FARTHEST` in d coordinates, by the midpoint rule.

    The share of pairs that differ at a shift h of the first coordinate is F(h); the largest of d
    shifts is that of the first coordinate in a d-th of the pairs, else h is uniform below it.
    """
    n = 2000
    shifts = FARTHEST * (np.arange(n) + 0.5) / n
    inside = FARTHEST + (1 - 2 * FARTHEST) * (np.arange(20_000) + 0.5) / 20_000
    here = cantor(inside[:, None])
    apart = np.array([(here != cantor(inside[:, None] + h)).mean() for h in shifts])
    below = np.cumsum(apart) / np.arange(1, n + 1)
    share = (apart + (d - 1) * below) / d
    log, pairs = np.log(shifts / FARTHEST), shifts ** (d - 1)
    goal = np.average(log, weights=pairs * share)
    return brentq(lambda a: np.average(log, weights=pairs * np.exp(a * log)) - goal, -2, 4)


KNOWN = {
    flat: lambda d: 1.0,
    oblique: lambda d: 1.0,
    cantor: cantor_exponent,
    scattered: lambda d: 0.0,
}
"""Basins -> their exponent in d coordinates."""


def estimates(basins, shape, repetitions):
    """Yield the estimate from fresh points, again and again."""
    for seed in range(repetitions):
        rng = np.random.default_rng((7, seed))
        points = rng.random(shape)
        yield uncertainty_exponent(points, basins(points, rng))


def exponents(repetitions):
    """Count the intervals of all known exponents."""
    return [line for shape in SHAPES for line in _of(shape, repetitions)]


def _of(shape, repetitions):
    rows, d = shape
    tally = Tally(f"basins, {rows} independent rows of {d} inputs")
    for basins, exponent in KNOWN.items():
        for estimate in estimates(basins, shape, repetitions):
            tally.estimate(f"uncertainty exponent, {basins.__name__}", exponent(d), estimate)
    return tally.lines()
