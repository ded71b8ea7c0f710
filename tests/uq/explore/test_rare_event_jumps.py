"""Rare events: a part that no trend leads to is found, or the limit of what is seen is stated."""

import numpy as np
import pytest
from limit_states import PLANE, STANDARD
from rare_studies import branches, close, interval, linear, study
from scipy import stats

from uq.cli.rare_event import as_json, show
from uq.explore.importance_sampling import WideSearch, wide_search
from uq.explore.rare_events import _Outcome, estimate_of, rare_event
from uq.explore.subset_simulation import SubsetReplicate, disagreement, subset_simulation
from uq.stats.intervals import log_scatter_interval

CLIFF = stats.norm.sf(4.0) + stats.norm.sf(5.0)
TWENTY = {f"x{i}": STANDARD for i in range(1, 21)}
SQUARE = stats.chi2.isf(1e-5, 20)


def cliff(seed):
    design = {"method": "monte-carlo", "samples": 64, "seed": seed}
    return study("limit_states:CLIFF", PLANE, design=design)


@pytest.mark.parametrize("seed", [0, 1, 2])
def test_a_cause_behind_a_cliff_is_within_the_interval(seed):
    ds = rare_event(cliff(seed), "stress", 5.0, workers=0)
    assert close(ds, CLIFF)
    if ds.attrs["estimated_by"] == "wide":
        assert "missed a part of the event" in ds.attrs["notes"]
    else:
        assert "replicates differ by a factor" in ds.attrs["notes"]


def test_importance_sampling_around_a_few_points_of_a_sphere_is_contradicted():
    of = study("limit_states:SPHERE", TWENTY)
    ds = rare_event(of, "square", SQUARE, method="importance", workers=0)
    assert float(ds["estimate"].mean()) < 2e-6  # of 1e-5
    assert interval(ds)[0] <= 1e-5 <= interval(ds)[1]
    assert ds.attrs["estimated_by"] == "wide" and "design points" not in ds.attrs["notes"]


def test_the_limit_of_what_is_seen_stands_beside_the_number(capsys):
    of = branches()
    ds = rare_event(of, "sum", 4.753424, workers=0)
    assert ds.attrs["estimated_by"] == "subset"
    assert float(ds["hidden_high"]) == pytest.approx(1 - 0.05 ** (1 / 10_000), rel=1e-3)
    assert "excluded only above 0.0003" in ds.attrs["notes"]
    document = as_json(ds)
    assert document["hidden_high"] == float(ds["hidden_high"])
    assert document["interval_of"] == "of the part that the method reaches"
    assert document["wide"]["rows"] == 8000 and document["wide"]["hits"] > 20
    assert document["wide"]["low"] < 1e-6 < 3 * document["wide"]["value"]
    show(ds, False, of, 4.753424)
    shown = capsys.readouterr().out
    assert "a hidden part" in shown and "rows drawn wide" in shown
    assert "only of the part that the method reaches" in " ".join(shown.split())


def test_a_share_of_plain_rows_needs_no_search():
    ds = rare_event(linear(), "y", 5.0, workers=0)
    assert "hidden_high" not in ds and "hidden_high" not in as_json(ds)


def of_cliff(u):
    return np.where(u[:, 1] < -4.0, 10.0, u[:, 0]) - 5.0


def replicates(*estimates):
    return [
        SubsetReplicate(estimate, 6, np.zeros((1, 2)), 10 * estimate, 0, "event")
        for estimate in estimates
    ]


def test_replicates_that_enter_by_luck_disagree():
    by_slope = (3e-7, 4e-7, 2e-7, 5e-7, 3e-7, 6e-7, 2e-7, 4e-7)
    assert disagreement(replicates(*by_slope), 1000) == 1
    assert disagreement(replicates(*by_slope[1:], 1e-3), 1000) == pytest.approx(5000)
    assert disagreement(replicates(*by_slope[1:], 0.0), 1000) == 1  # one that did not get there
    assert disagreement(replicates(1e-3), 1000) == 1


@pytest.mark.slow
def test_replicates_of_a_plane_agree():
    def margin(u):
        return u.sum(axis=1) / u.shape[1] ** 0.5 - stats.norm.isf(1e-5)

    for samples in (100, 1000):
        for seed in range(40):
            generators = np.random.default_rng(seed).spawn(8)
            assert disagreement(subset_simulation(margin, 4, samples, generators), samples) == 1


@pytest.mark.slow
@pytest.mark.parametrize("seed", [0, 1])
@pytest.mark.parametrize("inputs", [2, 6])
def test_rows_drawn_wide_hold_a_cliff(inputs, seed):
    held = 0
    for number in range(100):
        generators = np.random.default_rng((seed, number)).spawn(8)
        low, high = wide_search(of_cliff, inputs, 1000, generators).interval
        held += low <= CLIFF and not high < CLIFF
    assert held >= 92


@pytest.mark.slow
def test_rows_drawn_wide_hold_a_sphere():
    def margin(u):
        return (u**2).sum(axis=1) - stats.chi2.isf(1e-5, u.shape[1])

    for inputs in (3, 20, 100):
        held = 0
        for number in range(100):
            generators = np.random.default_rng((3, number)).spawn(8)
            low, high = wide_search(margin, inputs, 1000, generators).interval
            held += low <= 1e-5 <= high
        assert held >= 90


def outcome(estimates, interval, factor):
    return _Outcome(np.array(estimates), interval, 5e-4, 5e-4, 8000, factor, {})


def test_the_low_end_does_not_follow_a_replicate_that_enters_by_luck():
    estimates = np.array([0.36, 0.47, 0.53, 0.22, 0.58, 0.27, 0.5, 91.0]) * 1e-5
    interval = log_scatter_interval(estimates)
    assert interval[0] > 1e-5
    _, (low, high) = estimate_of(outcome(estimates, interval, 400.0), None)
    assert low < 1e-5 < high


def test_enough_rows_drawn_wide_above_the_interval_raise_its_high_end():
    weights = np.full(40, 1.0 / 40)
    wide = WideSearch(np.array([0.8, 1.2, 0.9, 1.4, 0.5, 1.3, 0.7, 1.2]), weights, 2000)
    above = outcome([0.5] * 8, (0.4, 0.8), 1.0)
    assert estimate_of(above, wide) == (0.5, (0.4, wide.interval[1]))
    within = outcome([0.9] * 8, (0.7, 1.1), 1.0)
    assert estimate_of(within, wide) == (pytest.approx(0.9), (0.7, 1.1))
