"""Laws that are cut, discrete or measured: what rows they give, what is refused."""

import numpy as np
import pytest
from computed import study_of
from hypothesis import given
from hypothesis import strategies as st
from input_studies import BELL, inputs_of, refusal, tables
from scipy import stats
from scipy_counterparts import of_scipy

from uq.sampling.laws import law_of


@pytest.mark.parametrize(
    "entry",
    [
        BELL | {"truncate": [0.48, 0.7]},
        {"distribution": "gumbel", "mode": 0.5, "scale": 0.1, "truncate": [0.4, 0.8]},
        {"distribution": "weibull", "shape": 2.0, "scale": 0.5, "truncate": [0.4, 1.0]},
        {"distribution": "truncated-normal", "mean": 0.5, "sd": 1.0, "lower": 0.2, "upper": 0.9}
        | {"truncate": [0.0, 0.6]},
    ],
    ids=lambda entry: entry["distribution"],
)
def test_a_truncated_law_is_the_law_given_that_it_falls_between(entry):
    x = inputs_of(study_of(tables({"x1": entry}, "sobol")))["x1"]
    plain = of_scipy(law_of({k: v for k, v in entry.items() if k != "truncate"}))
    low, high = entry["truncate"]
    low = max(low, entry.get("lower", low))
    share = (plain.cdf(x) - plain.cdf(low)) / (plain.cdf(high) - plain.cdf(low))
    assert low <= x.min() and x.max() <= high
    assert stats.kstest(share, "uniform").statistic < 2 / 4096


def test_discrete_laws_take_their_values_with_their_weights():
    entries = {
        "x1": {"distribution": "discrete-choice", "values": [0.5, 0.1], "weights": [3.0, 1.0]},
        "x2": {"distribution": "integer-range", "lower": 0, "upper": 1},
        "x3": {"distribution": "empirical", "values": [0.2, 0.4, 0.4, 0.9, 7.0]}
        | {"truncate": [0.0, 1.0]},
    }
    inputs = inputs_of(study_of(tables(entries, "sobol")))
    expected = {
        "x1": {0.1: 0.25, 0.5: 0.75},
        "x2": {0.0: 0.5, 1.0: 0.5},
        "x3": {0.2: 0.25, 0.4: 0.5, 0.9: 0.25},
    }
    for name, shares in expected.items():
        values, counts = np.unique(inputs[name], return_counts=True)
        assert dict(zip(values, counts / 4096, strict=True)) == pytest.approx(shares, abs=1e-3)


@given(
    values=st.lists(st.floats(0, 1), min_size=2, max_size=6, unique=True),
    ends=st.tuples(st.floats(0, 1), st.floats(0, 1)),
    u=st.lists(st.floats(2.0**-54, 1 - 2.0**-53), min_size=1, max_size=5),
)
def test_a_discrete_law_gives_none_but_its_values(values, ends, u):
    from uq.sampling.truncation import ppf_within

    law = law_of({"distribution": "discrete-choice", "values": values})
    low, high = sorted(ends)
    inside = [value for value in values if low <= value <= high]
    if inside:
        assert set(ppf_within(law, np.array(u), (low, high))) <= set(inside)


def test_a_histogram_fills_its_bins_as_counted():
    entry = {"distribution": "histogram", "edges": [0.0, 0.2, 1.0], "counts": [3, 1]}
    x = inputs_of(study_of(tables({"x1": entry}, "sobol")))["x1"]
    assert (x < 0.2).mean() == pytest.approx(0.75, abs=1e-3)
    assert (x < 0.1).mean() == pytest.approx(0.375, abs=1e-3)


def test_values_outside_the_bounds_are_refused_with_a_remedy():
    entry = {"distribution": "discrete-choice", "values": [0.5, 2.0]}
    sentence = "has 0.5 of its probability outside the parameter's bounds, 0.0 to 1.0 [1]"
    remedy = "add truncate = [lower, upper] within them, or use other numbers"
    assert sentence in refusal(tables({"x1": entry})) and remedy in refusal(tables({"x1": entry}))
    wrong = entry | {"values": [2.0, 3.0]}
    assert "has no value within the parameter's bounds" in refusal(tables({"x1": wrong}))
    cut = BELL | {"truncate": [-1.0, 0.45]}
    assert study_of(tables({"x1": cut})).uncertain["x1"].truncate == (-1.0, 0.45)
    far = BELL | {"truncate": [80.0, 90.0]}
    assert "too extreme" in refusal(tables({"x1": far}))
    both = refusal(tables({"x1": BELL | {"truncate": [2.0, 1.0]}}))
    assert both.startswith("[uncertain.x1]: truncate must have lower < upper: [2.0, 1.0]")


def test_a_published_wear_coefficient_suits_no_other_parameter():
    entry = {"distribution": "wear-coefficient", "pair": "inconel-690/steel-405"}
    assert refusal(tables({"x1": entry})) == (
        '[uncertain.x1] distribution = "wear-coefficient": is of a parameter in m2 N-1, not in 1'
    )
    mistaken = entry | {"pair": "inconel-609/steel-405"}
    assert "did you mean 'inconel-690/steel-405'?" in refusal(tables({"x1": mistaken}))
