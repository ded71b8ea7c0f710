"""Statistics of plain outputs: by design, by kind, with failed rows."""

import numpy as np
import pytest
from computed import asking, kinds, linear, summarised, with_output, with_status
from described import described

import uq
from uq.contract import Status

THRESHOLDS = {"y": [2.0, 6.0]}


def test_moments_quantiles_and_shares_of_a_plain_sample():
    ds = linear(samples=200, analysis={"thresholds": THRESHOLDS, "quantiles": [0.25]})
    y, entry = ds["y"].values, described(ds)
    assert entry["mean"] == pytest.approx(y.mean())
    assert entry["sd"] == pytest.approx(y.std(ddof=1))
    assert entry["mean_interval"]["low"] < y.mean() < entry["mean_interval"]["high"]
    quantile = entry["quantiles"]["0.25"]
    assert quantile["low"] in y and quantile["high"] in y
    assert quantile["low"] < quantile["value"] < quantile["high"]
    above, below = entry["thresholds"]["6.0"]["above"], entry["thresholds"]["6.0"]["below"]
    assert above["value"] == (y > 6).mean() and below["value"] == (y < 6).mean()
    assert above["low"] < above["value"] < above["high"]
    assert entry["thresholds"]["6.0"]["undefined"] == 0
    assert [entry[count] for count in ("never", "censored", "undefined", "failed")] == [0] * 4
    assert entry["tolerance"] is None


def test_replicates_of_a_plain_sample_are_just_rows():
    parts = described(linear(samples=50, replicates=4))
    assert parts["quantiles"]["0.5"]["low"] in linear(samples=50, replicates=4)["y"].values


def test_saltelli_is_described_by_its_independent_rows_and_counted_by_all():
    ds = linear("saltelli", samples=32, replicates=4, settings={"fail_above": 0.9})
    statistics = summarised(ds)
    ends = ds.isel(row=np.isin(ds["block"], [0, 5]))
    assert statistics["samples"] == 32 * 4 * 6 and statistics["rows_used"] == 32 * 4 * 2
    assert statistics["outputs"]["y"]["mean"] == pytest.approx(float(ends["y"].mean()))
    assert statistics["outputs"]["y"]["failed"] == int(ends["y"].isnull().sum())
    assert statistics["status"]["non-finite"] == int(ds["y"].isnull().sum())
    assert sum(statistics["status"].values()) == ds.sizes["row"]


@pytest.mark.parametrize("method", ["latin-hypercube", "sobol", "halton", "saltelli"])
def test_designs_that_are_not_independent_need_replicates(method):
    analysis = {"thresholds": {"y": 6.0}}
    alone = summarised(linear(method, samples=64, analysis=analysis))
    (note,) = alone["notes"]
    assert method in note and "replicates" in note
    entry = alone["outputs"]["y"]
    assert entry["mean"] is not None and entry["mean_interval"] == {"low": None, "high": None}
    assert entry["quantiles"]["0.5"]["low"] is None
    assert entry["thresholds"]["6.0"]["above"]["low"] is None

    several = summarised(linear(method, samples=64, replicates=8, analysis=analysis))
    assert several["notes"] == []
    entry = several["outputs"]["y"]
    assert entry["mean_interval"]["low"] < 5 < entry["mean_interval"]["high"]
    assert entry["quantiles"]["0.5"]["low"] < 5 < entry["quantiles"]["0.5"]["high"]
    assert entry["thresholds"]["6.0"]["above"]["low"] is not None


def test_intervals_follow_the_design_not_the_rows():
    # The independent-rows interval of a Sobol' design would be several times too wide.
    sobol = described(linear("sobol", samples=128, replicates=8))["quantiles"]["0.5"]
    plain = described(linear("monte-carlo", samples=128, replicates=8))["quantiles"]["0.5"]
    assert sobol["high"] - sobol["low"] < 0.7 * (plain["high"] - plain["low"])


@pytest.mark.parametrize("how", ["nan", "inf", "raise", "shape"])
def test_failed_rows_are_counted_and_left_out(how):
    settings = {"fail_above": 0.75, "fail_how": how}
    ds = linear(samples=200, settings=settings, analysis={"thresholds": {"y": 5.0}})
    sound = ds["x1"].values <= 0.75
    entry = described(ds)
    assert entry["failed"] == (~sound).sum() > 0
    assert entry["undefined"] == 0
    assert entry["mean"] == pytest.approx(ds["y"].values[sound].mean())
    assert entry["thresholds"]["5.0"]["above"]["value"] == (ds["y"].values[sound] > 5).mean()


def test_a_row_out_of_budget_failed_where_a_value_is_lacking():
    y = np.arange(64.0)
    y[:5] = np.nan
    ds = with_output(linear(samples=64), "late", y)
    late = described(with_status(ds, slice(10), Status.OUT_OF_BUDGET), "late")
    assert late["failed"] == 5 and late["undefined"] == 0
    assert late["mean"] == pytest.approx(np.mean(y[5:]))


def test_a_study_of_which_every_row_failed_has_no_numbers():
    for method, replicates in (("monte-carlo", 1), ("sobol", 4)):
        settings = {"fail_above": -1.0}
        analysis = {"thresholds": {"y": 5.0}}
        ds = linear(method, 16, replicates, settings=settings, analysis=analysis)
        entry = described(ds)
        assert entry["failed"] == 16 * replicates
        assert entry["mean"] is entry["sd"] is entry["quantiles"]["0.5"]["value"] is None
        assert "never" not in entry["quantiles"]["0.5"]
        nothing = dict.fromkeys(("value", "low", "high"))
        open_ = {"failed_low": 0.0, "failed_high": 1.0}
        assert entry["thresholds"]["5.0"]["above"] == nothing | open_
        assert uq.summary(ds)["failed"].item() == 16 * replicates


def test_tolerance_counts_failed_rows_as_the_worst():
    analysis = {"tolerance": {"coverage": 0.95, "confidence": 0.95}}
    entry = described(linear(samples=59, analysis=analysis))
    y = np.sort(linear(samples=59, analysis=analysis)["y"].values)
    assert entry["tolerance"] == {"lower": y[0], "upper": y[-1], "rows_needed": 59}
    entry = described(linear(samples=58, analysis=analysis))
    assert entry["tolerance"] == {"lower": None, "upper": None, "rows_needed": 59}
    ds = linear(samples=124, analysis=analysis)
    y = np.sort(ds["y"].values)
    assert described(ds)["tolerance"]["lower"] == y[2]
    ds["y"][ds["y"].argsort()[60]] = np.nan
    failed = with_status(ds, np.isnan(ds["y"].values), Status.RAISED)
    assert described(failed)["tolerance"] == {"lower": y[1], "upper": y[-2], "rows_needed": 93}


def test_tolerance_is_for_independent_rows_only():
    asked = {"tolerance": {"coverage": 0.95, "confidence": 0.95}}
    assert (
        described(asking(linear("sobol", samples=64, replicates=8), **asked))["tolerance"] is None
    )
    assert described(asking(linear(samples=64), **asked))["tolerance"]["lower"] is not None


# Kinds of outputs --------------------------------------------------------------------------------


def test_every_kind_of_output_is_described_by_element():
    ds = kinds(samples=300, analysis={"thresholds": {"angle": 0.5}})
    statistics = summarised(ds)
    lives = [
        f"life[side={side},depth={depth}]" for side in ("left", "right") for depth in (0.5, 1.5)
    ]
    assert list(statistics["outputs"]) == ["work[side=left]", "work[side=right]", *lives, "angle"]
    assert statistics["outputs"]["work[side=left]"]["units"] == "W"
    x1, x2 = ds["x1"].values, ds["x2"].values
    for name in lives:
        assert statistics["outputs"][name]["never"] == (x1 < 0.2).sum()
        assert statistics["outputs"][name]["censored"] == (x1 > 0.8).sum()
    angle = statistics["outputs"]["angle"]
    assert angle["undefined"] == (x2 < 0.2).sum() > 0
    assert angle["failed"] == 0
    shares = angle["thresholds"]["0.5"]
    parts = shares["above"]["value"] + shares["below"]["value"] + shares["undefined"]
    assert parts == pytest.approx(1)
    assert shares["undefined"] == pytest.approx(angle["undefined"] / (300 - angle["failed"]))
    assert set(statistics["status"]) == {"ok", "out-of-budget"}


def test_thresholds_of_an_angle_are_about_its_magnitude():
    ds = with_output(linear(samples=100), "angle", np.linspace(-1, 1, 100), "angle")
    entry = described(asking(ds, thresholds={"angle": 0.7}), "angle")
    assert entry["thresholds"]["0.7"]["above"]["value"] == 0.3
    assert entry["mean"] == pytest.approx(0)


def test_shares_of_regimes_have_intervals_and_sum_to_one():
    ds = kinds(samples=100)
    regimes = summarised(ds)["regime"]
    fast = (ds["x1"].values > 0.5).sum()
    assert regimes["fast"]["count"] == fast and regimes["slow"]["count"] == 100 - fast
    assert regimes["fast"]["share"] == fast / 100
    assert regimes["fast"]["low"] < fast / 100 < regimes["fast"]["high"]
    assert summarised(linear())["regime"] == {}
    # Rows that failed have no regime and no part in the shares.
    ds["regime"][:10] = -1
    part = summarised(with_status(ds, slice(10), Status.RAISED))["regime"]
    assert part["fast"]["count"] + part["slow"]["count"] == 90
    assert part["fast"]["share"] + part["slow"]["share"] == pytest.approx(1)


def test_outputs_that_the_study_names_are_shown():
    ds = kinds(analysis={"outputs": ["angle"], "quantiles": [0.5]})
    assert list(summarised(ds)["outputs"]) == ["angle"]
    table = uq.summary(kinds(analysis={"quantiles": [0.5]}))
    assert table.index[0] == "work[side=left]"
    expected = ["units", "mean", "mean_low", "mean_high", "sd", "sd_low", "sd_high", "tail_k"]
    expected += ["q0.5", "q0.5_low", "q0.5_high"]
    lives = [f"{name}{end}" for name in ("B1", "B10", "B50") for end in ("", "_low", "_high")]
    counts = ["never", "censored", "undefined", "failed"]
    ordered = [*expected, *counts, *lives]
    assert [column for column in table.columns if column in ordered] == ordered
    assert table.loc["work[side=left]", "mean"] == pytest.approx(0.5, abs=0.2)


def test_the_table_says_what_the_command_prints():
    n = 100
    values = np.r_[np.arange(1.0, 61.0), np.full(40, np.inf)]
    ds = with_output(linear(samples=n), "life", values, "lifetime")
    ds = asking(
        ds,
        outputs=["y", "life"],
        quantiles=[0.1, 0.9],
        tolerance={"coverage": 0.95, "confidence": 0.95},
        thresholds={"life": [30.5, 1e6]},
    )
    table, outputs = uq.summary(ds), summarised(ds)["outputs"]
    shares = [column for column in table.columns if column.startswith("P(")]
    assert shares == [
        f"P({sign}{threshold}){end}"
        for threshold in ("30.5", "1000000.0")
        for sign in "><"
        for end in ("", "_low", "_high")
    ]
    assert table.loc["y", shares].isna().all()
    y, life = table.loc["y"], table.loc["life"]
    bounds = outputs["y"]["tolerance"]
    assert (y["tolerance_lower"], y["tolerance_upper"]) == (bounds["lower"], bounds["upper"])
    assert life["tolerance_lower"] == 2.0 and life["tolerance_upper"] == np.inf
    assert list(table["tolerance_rows_needed"]) == [59, 59]
    assert (life["P(>30.5)"], life["P(<30.5)"]) == (0.7, 0.3)
    assert life["P(>30.5)_low"] == outputs["life"]["thresholds"]["30.5"]["above"]["low"]
    assert np.isnan(life["mean"]) and life["never"] == 40
    b10 = outputs["life"]["b_lives"]["B10"]
    assert (life["B10_low"], life["B10"], life["B10_high"]) == (
        b10["low"],
        b10["value"],
        b10["high"],
    )
    assert 10 <= life["B10"] <= 11 and np.isnan(y["B10"])
    assert life["q0.9"] == life["q0.9_low"] == life["q0.9_high"] == np.inf
    numbers = table.drop(columns="units")
    assert all(dtype.kind in "if" for dtype in numbers.dtypes)
    assert "tolerance_lower" not in uq.summary(asking(ds))


def test_describing_does_not_change_the_result():
    ds = kinds(samples=64)
    before = ds.copy(deep=True)
    summarised(ds)
    assert ds.identical(before)


def test_mixed_rows_of_either_kind_are_not_independent():
    ds = linear("saltelli", samples=64, second_order=True)
    assert summarised(ds)["samples"] == 64 * (2 + 2 * 4)
    assert summarised(ds)["rows_used"] == 128
