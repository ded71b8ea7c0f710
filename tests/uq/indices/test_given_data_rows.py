"""Given-data methods: how they rank, and which rows they take."""

import warnings

import numpy as np
import pytest
from asked_indices import INPUTS, indices, ishigami, of_plain_sample, sensitivities, values
from computed import asking, linear, with_output
from SALib.analyze import pawn, rbd_fast
from SALib.analyze.delta import calc_delta
from scipy import stats

from uq.indices.given_data import DUMMIES
from uq.indices.methods import METHODS


@pytest.mark.parametrize("design", ["monte-carlo", "latin-hypercube", "sobol", "halton"])
@pytest.mark.parametrize(
    ("method", "index", "expected", "tolerance"),
    [
        ("rbd-fast", "S1", (0.3139, 0.4424, 0.0), 0.06),
        # Histograms of four million rows; slices of 1024 rows are coarse, and delta comes out low.
        ("delta", "delta", (0.25, 0.40, 0.20), 0.17),
        ("pawn", "pawn", (0.24, 0.39, 0.09), 0.06),
    ],
)
def test_given_data_methods_rank_ishigami_and_carry_no_interval(
    design, method, index, expected, tolerance
):
    entry = indices(ishigami(design, samples=1024, replicates=1), method)["outputs"]["y"]
    assert values(entry, index) == pytest.approx(expected, abs=tolerance)
    x1, x2, x3 = values(entry, index)
    assert x2 > x1 > x3
    assert all(
        estimate["low"] is None and estimate["high"] is None for estimate in entry[index].values()
    )
    assert 0 < entry["dummy"][index] < min(expected[:2])


@pytest.mark.parametrize(
    ("method", "index"), [("rbd-fast", "S1"), ("delta", "delta"), ("pawn", "pawn")]
)
def test_dummy_is_passed_by_one_input_in_twenty_that_plays_no_part(method, index):
    rng = np.random.default_rng(5)
    passed = []
    for _ in range(12):
        ds = with_output(linear(samples=100), "noise", rng.random(100))
        entry = indices(asking(ds, outputs=["noise"]), method)["outputs"]["noise"]
        passed += [value > entry["dummy"][index] for value in values(entry, index)]
    assert DUMMIES == 19
    assert stats.binomtest(sum(passed), len(passed), 0.05).pvalue > 0.01


@pytest.mark.parametrize("method", ["rbd-fast", "pawn"])
def test_the_null_of_the_largest_is_passed_in_one_study_of_twenty_at_most(method):
    rng, alarms, single, repetitions = np.random.default_rng(5), 0, 0, 40
    (kind,) = METHODS[method].kinds
    for _ in range(repetitions):
        x = {f"x{i}": column for i, column in enumerate(rng.random((60, 100)))}
        result = of_plain_sample(method, x, rng.random(100), {})
        largest = max(index.value for index in result.values[kind].values())
        alarms += largest > result.nulls[kind].largest
        single += largest > result.nulls[kind].limit
    assert alarms <= 5 and single > 20  # of sixty inputs some three pass that for one
    alone = of_plain_sample(method, {"x0": x["x0"]}, rng.random(100), {})
    assert list(alone.nulls) == [kind] and np.isnan(alone.nulls[kind].largest)


def test_given_data_values_are_those_of_salib():
    ds = ishigami("monte-carlo", samples=303, replicates=1)
    x, y = np.column_stack([ds[name].values for name in INPUTS]), ds["y"].values
    problem = {"num_vars": 3, "names": list(INPUTS)}
    fast = indices(ds, "rbd-fast")["outputs"]["y"]
    assert values(fast, "S1") == pytest.approx(rbd_fast.analyze(problem, x, y, seed=1)["S1"])
    for dataset, name in ((ds, "y"), (with_output(ds, "rounded", y.round(0)), "rounded")):
        # Which leaves out the row with the largest value of an input.
        expected = pawn.analyze(problem, x, dataset[name].values)["median"]
        assert values(indices(dataset, "pawn")["outputs"][name], "pawn") == pytest.approx(expected)
    scores = stats.norm.ppf((stats.rankdata(y) - 0.5) / 303)
    grid, ends = np.linspace(scores.min(), scores.max(), 100), np.linspace(0, 303, 6)
    assert values(indices(ds, "delta")["outputs"]["y"], "delta") == pytest.approx(
        [calc_delta(scores, grid, column, ends) for column in x.T]
    )
    dummies = np.random.default_rng(0).random((303, DUMMIES))
    problem = {"num_vars": DUMMIES, "names": [str(i) for i in range(DUMMIES)]}
    largest = max(rbd_fast.analyze(problem, dummies, y, seed=1)["S1"])
    assert fast["dummy"]["S1"] == pytest.approx(largest)


def test_given_data_depends_on_nothing_but_the_rows():
    ds = ishigami("monte-carlo", samples=200, replicates=1)
    state = np.random.get_state()[1].copy()  # noqa: NPY002
    shown = warnings.formatwarning
    filters = list(warnings.filters)
    first = [sensitivities(ds, method) for method in ("rbd-fast", "delta", "pawn")]
    assert (np.random.get_state()[1] == state).all()  # noqa: NPY002
    assert warnings.formatwarning is shown and warnings.filters == filters
    assert [sensitivities(ds, method) for method in ("rbd-fast", "delta", "pawn")] == first


def test_delta_and_pawn_do_not_depend_on_the_scale_of_the_output():
    ds = ishigami("monte-carlo", samples=500, replicates=1)
    ds = with_output(ds, "grown", np.exp(3 * ds["y"].values))
    for method in ("delta", "pawn"):
        outputs = indices(ds, method)["outputs"]
        assert values(outputs["grown"], method) == pytest.approx(values(outputs["y"], method))
        assert max(values(outputs["grown"], method)) < 1


def test_quantile_indices_of_noise_are_about_zero():
    # Without a correction each would be about 0.03: every slice has its quantile fitted to it.
    noise = np.random.default_rng(5).random(1500)
    ds = asking(with_output(linear(samples=1500), "noise", noise), quantiles=[0.5])
    entry = indices(ds, "quantile", "noise")["outputs"]["noise"]
    assert np.mean(values(entry, "Q0.5")) == pytest.approx(0, abs=0.01)


def test_given_data_drops_rows_and_counts_them():
    ds = linear(samples=200, settings={"fail_above": 0.8})
    for method in ("rbd-fast", "delta", "pawn"):
        sensitivity_result = indices(ds, method)
        assert sensitivity_result["groups_dropped"] == int(ds["y"].isnull().sum()) > 0
        assert sensitivity_result["rows_used"] == 200 - sensitivity_result["groups_dropped"]
        assert sensitivity_result["outputs"]["y"]["rows_used"] == sensitivity_result["rows_used"]
        sound = ds.isel(row=~np.isnan(ds["y"].values))
        alone = indices(sound, method)["outputs"]["y"]
        assert alone == sensitivity_result["outputs"]["y"] | {"groups_dropped": 0}


def test_given_data_judges_64_rows():
    for method in ("rbd-fast", "delta", "pawn"):
        assert "refused" not in indices(linear(samples=64), method)["outputs"]["y"]


def test_given_data_refuses_what_it_cannot_judge():
    ds = linear(samples=200)
    y = ds["y"].values
    ds = with_output(ds, "flat", np.full(200, 3.0))
    ds = with_output(ds, "short", np.where(np.arange(200) < 63, y, np.nan))
    ds = with_output(ds, "event", y > 5)
    for method in ("rbd-fast", "delta", "pawn"):
        outputs = indices(ds, method)["outputs"]
        assert "same value" in outputs["flat"]["refused"]
        assert "63 rows with a value (of 200)" in outputs["short"]["refused"]
        assert ("refused" in outputs["event"]) == (method == "delta")
