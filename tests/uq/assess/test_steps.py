"""Which input changes from one row to the next: read from the design, not from rounded values."""

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import computed, study_of

from uq.assess.row_inputs import independent_inputs
from uq.assess.sampled_laws import compare, laws_and_values
from uq.errors import InputError
from uq.result.result import Result

A = {"distribution": "normal", "mean": 10.0, "sd": 1.0}
C = {"distribution": "normal", "mean": 0.0, "sd": 1.0}


def result(method, samples, replicates=1, a=A, factor=None, c=C):
    factor = factor or {"distribution": "normal", "mean": 1.0, "sd": 0.1}
    return computed(
        study_of(
            {
                "study": {"name": "sum", "model": "linear"},
                "design": {"method": method, "samples": samples, "replicates": replicates},
                "uncertain": {"a": a, "b": factor | {"times": "a"}, "c": c},
            },
            "sample_models:ADDED",
        )
    )


def entry_of(ds):
    return sensitivities(ds)["outputs"]["y"]


def test_shapley_effects_of_a_factor_are_those_of_what_varies_on_its_own():
    # y = a (1 + f) + c: what a does alone 4, f alone 1, both together 0.01, c 1.
    parts = np.array([4 + 0.005, 1 + 0.005, 1])
    effects = entry_of(result("shapley", 4096))["shapley"]
    for estimate, truth in zip(effects.values(), parts / parts.sum(), strict=True):
        assert estimate["low"] <= truth <= estimate["high"]
        assert estimate["value"] == pytest.approx(truth, abs=0.03)


def test_effects_of_an_input_that_varies_by_a_tiny_part_of_its_size_are_seen():
    # A step of c moves y by 1e-10 of c, beyond the rounding of c by far.
    far = {"distribution": "uniform", "lower": 900.0, "upper": 900.0 + 1e-10}
    entry = entry_of(result("morris", 32, c=far))
    # y is rounded to 1e-13.
    assert entry["mu_star"]["c"]["value"] == pytest.approx(1e-10, rel=0.02)


def test_no_interval_is_made_of_rounding():
    # The sum is rounded, so that equal effects differ by 1e-14.
    entry = entry_of(result("morris", 50, 4, factor=A))
    assert entry["sigma"]["c"] == {"value": 0.0, "low": None, "high": None}
    assert entry["mu"]["c"]["low"] is None


def test_steps_of_a_factor_are_counted_once_each():
    # Steps of the factor alone move b by a, by half of b's range and down where a is negative.
    below = {"distribution": "uniform", "lower": -12.0, "upper": -8.0}
    factor = {"distribution": "uniform", "lower": 1.0, "upper": 2.0}
    entry = entry_of(result("morris", 64, a=below, factor=factor))
    assert entry["mu"]["b"]["value"] == pytest.approx(-10.0, abs=0.7)
    assert entry["mu"]["a"]["value"] == pytest.approx(4 * 2.5, abs=0.7)


@pytest.mark.parametrize("method", ["shapley", "morris"])
def test_rows_that_are_not_those_of_the_design_are_refused(method):
    ds = result(method, 64)
    a = ds["a"].values.copy()
    a[5] += 1e-3
    with pytest.raises(InputError, match="the rows differ from those of a"):
        sensitivities(ds.assign(a=("row", a, ds["a"].attrs)))


@pytest.mark.parametrize(
    "factor",
    [
        {"distribution": "discrete-choice", "values": [0.1, 0.7, 1.3]},
        {"distribution": "integer-range", "lower": 1, "upper": 3},
        {"distribution": "empirical", "values": [0.1, 0.7, 1.3]},
    ],
    ids=["choice", "integer", "empirical"],
)
def test_a_factor_of_listed_values_has_these_and_no_others(factor):
    ds = result("monte-carlo", 300, factor=factor)
    expected = factor.get("values", [1.0, 2.0, 3.0])
    assert np.unique(independent_inputs(Result(ds))["b"]).tolist() == expected
    law, values = laws_and_values(Result(ds))["b"]
    assert compare(law, values).distance < 0.1
