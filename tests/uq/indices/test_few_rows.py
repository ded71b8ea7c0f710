"""Indices of events and regimes that few rows decide."""

import re

import numpy as np
import pytest
from asked_indices import sensitivities
from computed import linear, with_output

from uq.indices.groups import effective_rows

ATTRS = {
    "role": "output",
    "kind": "category",
    "units": "1",
    "long_name": "which regime",
    "may_be_undefined": 0,
    "flag_values": np.array([-1, 0, 1], np.int8),
    "flag_meanings": "none low high",
}


def with_event(ds, share):
    """Return a result whose regime is high in a corner of x1 and x2, of this probability."""
    high = ds["x1"].values + ds["x2"].values > 2 - np.sqrt(2 * share)
    return ds.assign(regime=("row", high.astype(np.int8), ATTRS))


def of_event(share, samples=128, method=None, design="saltelli"):
    ds = with_event(linear(design, samples=samples, replicates=8), share)
    return sensitivities(ds, method, "P(regime=high)")["outputs"]["P(regime=high)"]


def test_an_event_with_fewer_than_five_hits_in_each_replicate_is_refused():
    refusal = of_event(0.013)["refused"]
    assert "hits in 2 048 rows" in refusal and "5 are needed" in refusal
    hits = int(re.match(r"only (\d+) hits", refusal)[1])
    wanted = int(re.search(r"about (\d+) samples instead of 128 would give 20", refusal)[1])
    assert wanted == pytest.approx(128 * 20 * 8 / hits, rel=0.05)
    assert "'regional' of a 'monte-carlo' design needs 10 in all" in refusal


def test_an_event_with_fewer_than_twenty_hits_is_warned_of():
    entry = of_event(0.05)
    assert "hits in 2 048 rows, 1" in entry["notes"][0] and "rough" in entry["notes"][0]
    assert "too narrow" not in entry["notes"][0] and "are conservative" in entry["notes"][1]
    assert entry["S1"]["x1"]["value"] == pytest.approx(0.169, abs=0.15)
    assert not any("rough" in note for note in of_event(0.3)["notes"])


def test_few_misses_are_as_bad_as_few_hits():
    ds = linear("saltelli", samples=128, replicates=8)
    high = with_event(ds, 0.013)["regime"].values
    ds = ds.assign(regime=("row", (1 - high).astype(np.int8), ATTRS))
    refusal = sensitivities(ds, None, "P(regime=high)")["outputs"]["P(regime=high)"]["refused"]
    assert "misses in 2 048 rows" in refusal


def test_methods_without_replicates_count_their_hits_too():
    ds = with_event(linear("monte-carlo", samples=512, replicates=1), 0.005)
    refusal = sensitivities(ds, "pawn", "P(regime=high)")["outputs"]["P(regime=high)"]["refused"]
    assert "in 512 rows: 5 are needed" in refusal


@pytest.mark.slow
@pytest.mark.parametrize("share", [0.05, 0.1])
def test_s1_of_an_input_that_acts_in_a_rare_regime_alone_is_covered(share):
    held, repetitions = 0, 40
    mean = (1 + 29 * share) / 2
    truth = mean**2 / 3 / ((1 + 899 * share) / 3 - mean**2)
    for seed in range(repetitions):
        ds = linear("saltelli", samples=128, replicates=8, seed=seed)
        high = ds["x1"].values + ds["x2"].values > 2 - np.sqrt(2 * share)
        ds = with_output(ds, "y", np.where(high, 30 * ds["x3"].values, ds["x3"].values))
        entry = sensitivities(ds, None, "y")["outputs"]["y"]
        held += entry["S1"]["x3"]["low"] <= truth <= entry["S1"]["x3"]["high"]
        assert any("variance rests on" in note for note in entry["notes"])
    assert held >= 0.93 * repetitions


def test_rows_that_a_variance_rests_on():
    rng = np.random.default_rng(0)
    assert effective_rows(rng.standard_normal(30_000)) == pytest.approx(10_000, rel=0.05)
    event = (np.arange(10_000) < 100) - 0.01
    assert effective_rows(event) == pytest.approx(100, rel=0.05)


@pytest.mark.parametrize(("hits", "refused"), [(1, True), (4, True), (40, False)])
@pytest.mark.parametrize("values", [(0.0, 1.0), (-3.0, 7.0)])
def test_an_output_of_two_values_is_an_event(hits, refused, values):
    ds = linear("saltelli", samples=64, replicates=2)
    some = ds["x1"].values < hits / 128
    sensitivity_result = sensitivities(
        with_output(ds, "hit", np.where(some, values[1], values[0])), "sobol"
    )
    (entry,) = [indices for name, indices in sensitivity_result["outputs"].items() if "hit" in name]
    assert ("needed for an index" in entry.get("refused", "")) is refused


def of_paths(values, samples=33):
    ds = linear("shapley", samples=samples)
    sensitivity_result = sensitivities(with_output(ds, "z", values(ds)), None, "z")
    (entry,) = sensitivity_result["outputs"].values()
    return entry


def test_an_event_that_only_rows_between_the_independent_ones_see_has_no_indices():
    entry = of_paths(lambda ds: ds["block"].values == 1)
    assert "in all independent rows, though not in those between" in entry["refused"]
    ds = linear("saltelli", samples=64, replicates=4)
    ds = with_output(ds, "z", ds["block"].values == 1)
    assert "though not in those between" in sensitivities(ds, None, "z")["outputs"]["z"]["refused"]


def test_shares_of_a_variance_that_may_be_zero_are_refused():
    ds = linear("shapley", samples=40, seed=9)
    y = ds["y"].values
    (entry,) = sensitivities(with_output(ds, "z", y > np.quantile(y, 0.9)), None, "z")[
        "outputs"
    ].values()
    assert entry["refused"].startswith("40 paths do not distinguish the variance from zero")


def test_one_path_is_too_few_and_its_output_no_event():
    assert of_paths(lambda ds: ds["y"].values, samples=1)["refused"] == (
        "only 1 whole path; 32 are needed"
    )


def test_one_hit_is_singular():
    entry = of_paths(lambda ds: ds["row"].values == 5)
    assert entry["refused"].startswith("only 1 hit in 66 rows: 5 are needed")


def test_shares_that_all_paths_agree_on_say_why_they_have_no_interval():
    entry = of_paths(lambda ds: ds["x1"].values)
    assert entry["shapley"]["x1"] == {"value": 1.0, "low": None, "high": None}
    assert entry["notes"][-2:] == [
        "no effect in any row, hence no interval: x2, x3, x4",
        "the same share along each path, hence no interval: x1",
    ]


def test_few_rows_with_an_event_are_told_from_few_rows():
    ds = linear("monte-carlo", samples=256, analysis={"thresholds": {"y": [7.0]}})
    (entry,) = sensitivities(ds, "hsic-conditional", "P(y>7.0)")["outputs"].values()
    hits = int((ds["y"].values > 7).sum())
    assert entry["refused"].startswith(f"only {hits} rows with a value where the event happens (of")
