"""Replicates of designs that spread evenly hide the error of a jump; intervals hold it."""

import pytest
from computed import linear, summarised


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
