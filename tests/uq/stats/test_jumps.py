"""Replicates of designs that spread evenly hide the error of a jump; intervals hold it."""

import numpy as np
import pytest
from computed import linear, summarised
from scipy.special import ndtri
from scipy.stats import qmc

from uq.sampling.unit_cube import sobol
from uq.stats.dependent_rows import Dependence
from uq.stats.jumps import jumps
from uq.stats.moments import moments


@pytest.mark.parametrize(
    "method", [pytest.param("sobol", marks=pytest.mark.slow), "latin-hypercube"]
)
def test_the_mean_of_a_function_that_jumps_is_within_its_interval(method):
    """All replicates often have the same number of rows beyond the jump."""
    place, held = 19.1 / 64, 0
    for seed in range(12):
        ds = linear(method, samples=64, replicates=8, seed=seed)
        ds["y"].values[:] = 6.0 * (ds["x1"] > place) + 0.5 * ds["x2"] + 0.3 * ds["x3"]
        ends = summarised(ds)["outputs"]["y"]["mean_interval"]
        held += ends["low"] <= 6.0 * (1 - place) + 0.4 <= ends["high"]
    assert held >= 11


def test_a_smooth_function_keeps_its_narrow_interval():
    ds = linear("sobol", samples=1024, replicates=8)
    ends = summarised(ds)["outputs"]["y"]["mean_interval"]
    assert ends["low"] <= 5.0 <= ends["high"] and ends["high"] - ends["low"] < 1e-3


def test_a_jump_near_an_end_is_not_taken_for_a_polynomial():
    """Polynomials of degree 6 follow much of a step in the last strata."""
    place = 1 - 2.72 / 64
    u = sobol(0, 8, 4, 64, 0, 64).reshape(-1, 4)
    y = 4.0 * (u[:, 0] > place) + 0.2 * ndtri(u[:, 1])
    marked = Dependence(np.tile(np.arange(8), 64), u)
    assert jumps(y, marked.neighbours)[0] > 3.0


def test_a_slab_that_each_replicate_meets_once_is_found():
    """Of 1.28 strata: in 7 % of designs all replicates have one row in it, and show no scatter."""
    held = []
    for seed in range(120):
        u = qmc.LatinHypercube(3, rng=seed).random(64)
        u = np.concatenate(
            [u, *(qmc.LatinHypercube(3, rng=[seed, i]).random(64) for i in range(7))]
        )
        inside = np.abs(u[:, 0] - 0.337) < 0.01
        if (inside.reshape(8, 64).sum(axis=1) == 1).all():
            of = Dependence(np.repeat(np.arange(8), 64), u)
            ends = moments(6.0 * inside + 0.3 * u[:, 1], of).mean
            held.append(ends.low <= 6 * 0.02 + 0.15 <= ends.high)
    assert len(held) > 3 and all(held)
