"""Statistics of lifetimes: rows that never end, and censored ones."""

import numpy as np
import pytest
from computed import asking, linear, with_output
from described import described


def lifetimes(values, censored=None, analysis=None):
    ds = with_output(linear(samples=len(values)), "life", values, "lifetime", censored)
    return asking(ds, **(analysis or {}))


def test_never_makes_quantiles_infinite_and_the_mean_meaningless():
    values = np.r_[np.arange(1.0, 61.0), np.full(40, np.inf)]
    analysis = {"quantiles": [0.1, 0.55, 0.9], "thresholds": {"life": 30.5}}
    entry = described(lifetimes(values, analysis=analysis), "life")
    assert entry["never"] == 40 and entry["mean"] is entry["sd"] is None
    early, middle, late = entry["quantiles"].values()
    assert early["low"] < early["value"] < early["high"] and "never" not in early
    assert middle["value"] == pytest.approx(55.4, abs=0.2)
    assert middle["low"] > 40 and middle["high"] is None and middle["high_never"] is True
    nothing = dict.fromkeys(("value", "low", "high"))
    assert late == nothing | {"never": True, "low_never": True, "high_never": True}
    assert entry["thresholds"]["30.5"]["above"]["value"] == 0.7
    assert entry["thresholds"]["30.5"]["below"]["value"] == 0.3


def test_censored_rows_give_bounds_where_they_give_no_values():
    values = np.minimum(np.arange(1.0, 101.0), 60.0)
    censored = values == 60.0
    analysis = {"quantiles": [0.1, 0.55, 0.9], "thresholds": {"life": [30.0, 60.0, 80.0]}}
    entry = described(lifetimes(values, censored, analysis), "life")
    assert entry["censored"] == 41 and entry["never"] == 0 and entry["mean"] is None
    early, middle, late = entry["quantiles"].values()
    assert early["value"] == pytest.approx(10, abs=0.5) and "censored" not in early
    assert middle["value"] is not None
    assert middle["high"] is None and middle["high_censored"] is True
    assert late["value"] is None and late["censored"] is True
    assert late["low"] == 60.0  # it lives at least that long
    assert late["high"] is None and "never" not in late
    before, at, beyond = entry["thresholds"].values()
    assert before["above"]["value"] == 0.7 and before["below"]["value"] == 0.29
    assert at["above"]["value"] == 0.41 and at["below"]["value"] == 0.59
    assert beyond["above"]["value"] is beyond["below"]["low"] is None
    assert "41 of 100 rows were censored before that time" in beyond["reason"]


def test_early_censoring_widens_the_upper_bound_only():
    values = np.arange(1.0, 201.0)
    censored = np.arange(200) < 10
    analysis = {"quantiles": [0.5]}
    free = described(lifetimes(values, analysis=analysis), "life")["quantiles"]["0.5"]
    held = described(lifetimes(values, censored, analysis), "life")["quantiles"]["0.5"]
    assert held["low"] == free["low"]
    assert held["high"] == free["high"] + 10
    assert held["value"] is None and held["censored"] is True


def test_tolerance_bound_on_never_or_censored_rows():
    analysis = {"tolerance": {"coverage": 0.5, "confidence": 0.95}}
    values = np.r_[np.arange(1.0, 51.0), np.full(50, np.inf)]
    bounds = described(lifetimes(values, analysis=analysis), "life")["tolerance"]
    assert bounds["lower"] < 50 and bounds["upper"] is None and bounds["upper_never"] is True
    censored = np.isinf(values)
    values[censored] = 51.0
    bounds = described(lifetimes(values, censored, analysis), "life")["tolerance"]
    assert bounds["lower"] < 50 and bounds["upper"] is None and bounds["upper_censored"] is True
