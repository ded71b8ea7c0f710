"""Sobol' indices: their values, their intervals, and what is made of rows without a value."""

from itertools import combinations

import numpy as np
import pytest
from asked_indices import INPUTS, indices, ishigami, sensitivities, values
from computed import linear, with_output
from SALib.analyze import sobol as salib
from scipy import stats

from uq.errors import InputError


def test_indices_of_ishigami_lie_near_the_published_ones_and_within_their_intervals():
    entry = indices(ishigami(samples=1024))["outputs"]["y"]
    for kind, published in {"S1": (0.3139, 0.4424, 0), "ST": (0.5576, 0.4424, 0.2437)}.items():
        assert values(entry, kind) == pytest.approx(published, abs=0.02)
        for index in entry[kind].values():
            assert index["low"] < index["value"] < index["high"]
    assert entry["notes"] == []


@pytest.mark.parametrize("second_order", [False, True])
def test_values_are_those_of_salib_on_all_rows(second_order):
    ds = ishigami(samples=64, replicates=4, second_order=second_order)
    entry = indices(ds)["outputs"]["y"]
    problem = {"num_vars": 3, "names": list(INPUTS)}
    expected = salib.analyze(problem, ds["y"].values, calc_second_order=second_order, seed=1)
    assert values(entry, "ST") == pytest.approx(expected["ST"], rel=1e-12)
    assert values(entry, "S1") == pytest.approx(expected["S1"], abs=0.1)
    assert ("S2" in entry) == second_order
    if second_order:
        assert list(entry["S2"]) == ["x1,x2", "x1,x3", "x2,x3"]
        pairs = [expected["S2"][pair] for pair in combinations(range(3), 2)]
        assert values(entry, "S2") == pytest.approx(pairs, abs=1e-2)


def test_values_are_those_of_scipy():
    ds = ishigami(samples=256, replicates=1)
    entry = indices(ds)["outputs"]["y"]
    rows = ds["y"].values.reshape(256, 5)
    rows = rows - rows[:, [0, 4]].mean()
    blocks = {"f_A": rows[:, 0], "f_B": rows[:, 4], "f_AB": rows[:, 1:4].T}
    func = {name: np.atleast_2d(block) for name, block in blocks.items()}
    func["f_AB"] = func["f_AB"][:, None, :]
    expected = stats.sobol_indices(func=func, n=256)
    a, *mixed, b = rows.T
    assert values(entry, "ST") == pytest.approx(np.ravel(expected.total_order), rel=1e-9)
    # With the product of A and B as it is, and over the variance of A and B, S1 would be scipy's.
    change = [
        np.mean(b * a) * np.mean((a - ab) ** 2) / 2 / np.var([a, ab]) / np.var([a, b])
        for ab in mixed
    ]
    first_order = [np.var([a, b]) / np.var([b, ab]) for ab in mixed]
    scipys = np.array(values(entry, "S1")) / first_order - change
    assert scipys == pytest.approx(np.ravel(expected.first_order), abs=1e-3)


def test_order_of_rows_does_not_matter():
    ds = ishigami(samples=16, replicates=4)
    shuffled = ds.isel(row=np.random.default_rng(0).permutation(ds.sizes["row"]))
    assert sensitivities(shuffled) == sensitivities(ds)


def test_interval_is_students_of_the_replicates():
    ds = ishigami(samples=128, replicates=5)  # of 64, so few rows count that it is widened
    entry = indices(ds)["outputs"]["y"]
    alone = [ds.isel(row=ds["replicate"].values == r).assign_attrs(replicates=1) for r in range(5)]
    values_alone = [indices(replicate)["outputs"]["y"]["ST"]["x2"]["value"] for replicate in alone]
    half = stats.t.ppf(0.975, 4) * np.std(values_alone, ddof=1) / np.sqrt(5)
    index = entry["ST"]["x2"]
    assert index["high"] - index["value"] == pytest.approx(half, rel=1e-6)
    assert index["value"] - index["low"] == pytest.approx(half, rel=1e-6)


def test_one_replicate_gives_values_without_intervals_and_says_so():
    entry = indices(ishigami(replicates=1))["outputs"]["y"]
    assert entry["ST"]["x1"]["value"] == pytest.approx(0.5576, abs=0.15)
    assert entry["ST"]["x1"]["low"] is entry["ST"]["x1"]["high"] is None
    assert "replicates" in entry["notes"][0]


@pytest.mark.parametrize("how", ["nan", "inf", "raise"])
def test_a_failed_row_removes_its_whole_group_and_is_counted(how):
    settings = {"fail_above": 0.97, "fail_how": how}
    ds = linear("saltelli", samples=64, replicates=4, settings=settings)
    sensitivity_result = indices(ds)
    lacking = np.isnan(ds["y"].values.reshape(64 * 4, 6)).any(axis=1)
    assert (
        0
        < lacking.sum()
        == sensitivity_result["groups_dropped"]
        == sensitivity_result["outputs"]["y"]["groups_dropped"]
    )
    assert (
        sensitivity_result["rows_used"]
        == sensitivity_result["outputs"]["y"]["rows_used"]
        == (~lacking).sum() * 6
    )
    kept = ds["y"].values.reshape(64 * 4, 6)[~lacking]
    problem = {"num_vars": 4, "names": ["x1", "x2", "x3", "x4"]}
    expected = salib.analyze(problem, kept.ravel(), calc_second_order=False, seed=1)
    assert values(sensitivity_result["outputs"]["y"], "ST") == pytest.approx(
        expected["ST"], rel=1e-12
    )


def test_an_undefined_row_removes_its_group_like_a_failed_one():
    ds = ishigami(samples=64, replicates=4)
    ds["y"][7] = np.nan
    assert indices(ds)["groups_dropped"] == 1


def test_constant_failed_and_missing_rows_are_refused_not_zero():
    ds = linear("saltelli", samples=16, replicates=4)
    ds = with_output(ds, "flat", np.full(ds.sizes["row"], 0.1))
    ds = with_output(ds, "gone", np.full(ds.sizes["row"], np.nan))
    few = np.where(ds["group"].values + ds["replicate"].values > 1, np.nan, ds["y"].values)
    outputs = indices(with_output(ds, "few", few))["outputs"]
    assert "same value" in outputs["flat"]["refused"]
    assert "no whole groups (of 64)" in outputs["gone"]["refused"]
    assert "3 whole groups (of 64)" in outputs["few"]["refused"]
    for name in ("flat", "gone", "few"):
        assert "S1" not in outputs[name]
    assert outputs["y"]["ST"]["x4"]["value"] == pytest.approx(16 / 30, abs=0.1)
    # Outputs without indices do not count against those with.
    assert indices(ds)["groups_dropped"] == 0
    for rows in (slice(1, None), [0, 1, 2, 9, 10, 11]):
        with pytest.raises(InputError, match="rows of the design are missing"):
            sensitivities(ds.assign_attrs(replicates=1).isel(row=rows))
    with pytest.raises(InputError, match="rows of the design are missing"):
        sensitivities(ds.isel(row=np.r_[0:6, 6:12, 12:18, 18:23, 29]))


def test_an_input_without_any_effect_is_zero_without_interval():
    ds = linear("saltelli", samples=256, replicates=4)
    product = ds["x1"].values * ds["x2"].values * ds["x4"].values
    entry = indices(with_output(ds, "product", product))["outputs"]["product"]
    assert entry["ST"]["x3"] == entry["S1"]["x3"] == {"value": 0.0, "low": None, "high": None}
    assert entry["notes"] == ["no effect in any row, hence no interval: x3"]


def test_a_share_that_all_replicates_agree_on_says_why_it_has_no_interval():
    ds = linear("saltelli", samples=256, replicates=4)
    entry = indices(with_output(ds, "side", np.where(ds["x1"] > 0.5, 1.0, 0.0)))["outputs"]["side"]
    assert entry["ST"]["x1"] == {"value": 1.0, "low": None, "high": None}
    assert entry["notes"] == [
        "no effect in any row, hence no interval: x2, x3, x4",
        "the same ST in each replicate, hence no interval: x1",
    ]


def test_a_replicate_without_rows_takes_the_intervals_away():
    ds = linear("saltelli", samples=16, replicates=4)
    ds["y"][ds["replicate"].values == 2] = np.nan
    entry = indices(ds)["outputs"]["y"]
    assert entry["ST"]["x1"]["value"] is not None and entry["ST"]["x1"]["low"] is None
    assert "replicates" in entry["notes"][0]


def test_mean_far_from_zero_does_not_spoil_the_indices():
    ds = ishigami(samples=128, replicates=4)
    far = with_output(ds, "far", ds["y"].values + 1e6)
    outputs = indices(far)["outputs"]
    assert values(outputs["far"], "S1") == pytest.approx(values(outputs["y"], "S1"), abs=1e-6)
