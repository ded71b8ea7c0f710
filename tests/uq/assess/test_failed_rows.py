"""Failed rows: the bounds that hold whatever their values would have been."""

import numpy as np
import pytest
from computed import asking, linear, summarised, with_output, with_status
from scipy import stats

import uq
from uq.assess.failed_rows import failed_share_bounds
from uq.assess.summary import summarise
from uq.assess.summary_table import summary
from uq.result.result import Result
from uq.stats.dependent_rows import Dependence
from uq.stats.estimate import Estimate, failed_bounds_text
from uq.stats.intervals import share_interval

ROWS = 1000
LIVES = stats.weibull_min(1.5, scale=3.5)
TRUTH = LIVES.sf(5.0)  # 0.18


def lives(method="monte-carlo", failing="long", **more):
    """Return a result in which 8 % of the rows fail, all among the longest lives."""
    replicates = 1 if method == "monte-carlo" else 8
    ds = linear(method, samples=ROWS // replicates, replicates=replicates)
    life = LIVES.ppf(np.random.default_rng(1).random(ROWS))
    lost = np.argsort(life)[-80:] if failing == "long" else np.argsort(life)[:80]
    whole = life.copy()
    life[lost] = np.nan
    ds = with_status(with_output(ds, "life", life, "lifetime", **more), lost, 2)
    return asking(ds, thresholds={"life": 5.0}, quantiles=[0.05, 0.5, 0.95]), whole, lost


@pytest.mark.parametrize("method", ["monte-carlo", "latin-hypercube"])
@pytest.mark.parametrize("failing", ["long", "short"])
def test_bounds_hold_what_the_interval_misses(method, failing):
    ds, whole, _ = lives(method, failing)
    statistics = summarised(ds)
    life = statistics["outputs"]["life"]
    above, below = (life["thresholds"]["5.0"][side] for side in ("above", "below"))
    if failing == "long":
        assert above["high"] < TRUTH  # of the rows that did not fail
    assert above["failed_low"] <= TRUTH <= above["failed_high"]
    assert below["failed_low"] <= 1 - TRUTH <= below["failed_high"]
    assert above["failed_low"] == pytest.approx(1 - below["failed_high"])
    for name, p in (("B1", 0.01), ("B10", 0.1), ("B50", 0.5)):
        bounds = life["b_lives"][name]
        assert bounds["failed_low"] <= LIVES.ppf(p), name
        assert bounds.get("failed_high_never") or bounds["failed_high"] >= LIVES.ppf(p), name
    assert life["b_lives"]["B1"]["failed_low"] == 0.0  # 8 % may have ended at once
    assert life["quantiles"]["0.95"]["failed_high_never"]
    assert [
        note
        for note in statistics["notes"]
        if note.startswith("80 of 1000 independent rows are invalid")
    ]


def test_bounds_are_the_ends_of_the_interval_with_failed_rows_on_that_side():
    ds, whole, lost = lives()
    above = summarised(ds)["outputs"]["life"]["thresholds"]["5.0"]["above"]
    hits = whole > 5.0
    assert above["failed_high"] == pytest.approx(share_interval(hits)[1])  # they were long
    hits[lost] = False
    assert above["failed_low"] == pytest.approx(share_interval(hits)[0])


def test_without_failed_rows_nothing_stands_beside():
    ds = asking(linear(), thresholds={"y": 5.0})
    statistics = summarised(ds)
    assert "failed_low" not in str(statistics) and statistics["notes"] == []
    assert not any("failed_" in column for column in summary(ds).columns)


def test_values_and_angles_have_bounds_too():
    ds = linear(samples=200)
    lost = np.argsort(ds["y"].values)[-20:]
    y = ds["y"].values.copy()
    y[lost] = np.nan
    ds = with_output(ds, "y", y)
    ds = with_output(ds, "turn", np.where(np.isnan(y), np.nan, y - 5.0))
    ds = ds.assign(turn=ds["turn"].assign_attrs(kind="angle"))
    ds = asking(with_status(ds, lost, 2), thresholds={"y": 7.0, "turn": 2.0}, quantiles=[0.05, 0.5])
    outputs = summarised(ds)["outputs"]
    value = outputs["y"]["quantiles"]
    assert value["0.05"]["failed_low"] is None and value["0.05"]["failed_high"] > 2.0
    assert value["0.5"]["failed_low"] < 5.0 < value["0.5"]["failed_high"]
    bounds = summarise(Result(ds)).outputs["y"].find("quantiles", "0.05").failed
    assert failed_bounds_text(bounds).startswith("up to")
    highest = summarised(asking(ds, quantiles=[0.95]))["outputs"]["y"]["quantiles"]["0.95"]
    assert highest["failed_high"] is None and "failed_high_never" not in highest
    highest = (
        summarise(Result(asking(ds, quantiles=[0.95])))
        .outputs["y"]
        .find("quantiles", "0.95")
        .failed
    )
    assert failed_bounds_text(highest).startswith("from")
    truth = (whole := linear(samples=100_000)["y"].values > 7.0).mean()
    assert len(whole) and outputs["y"]["thresholds"]["7.0"]["above"]["failed_high"] > truth
    turn = outputs["turn"]["thresholds"]["2.0"]
    assert turn["above"]["failed_high"] == pytest.approx(1 - turn["below"]["failed_low"])
    assert turn["above"]["failed_high"] - turn["above"]["failed_low"] > 0.1


def test_rows_that_all_failed_leave_everything_open():
    ds = with_status(with_output(linear(), "y", np.full(64, np.nan)), slice(None), 2)
    ds = asking(ds, thresholds={"y": 5.0})
    above = summarised(ds)["outputs"]["y"]["thresholds"]["5.0"]["above"]
    assert above["value"] is None and (above["failed_low"], above["failed_high"]) == (0.0, 1.0)


def test_censored_lives_keep_their_bounds():
    ds, whole, lost = lives(censored=np.zeros(ROWS))
    life, flag = ds["life"].values.copy(), np.zeros(ROWS, np.int8)
    cut = life > 4.0
    life[cut], flag[cut] = 4.0, 1
    ds = with_output(ds, "life", life, "lifetime", flag)
    entry = summarised(ds)["outputs"]["life"]
    guess = entry["thresholds"]["5.0"]["kaplan_meier"]
    assert entry["b_lives"]["B10"]["failed_low"] < LIVES.ppf(0.1)
    assert entry["b_lives"]["B10"]["failed_high"] > LIVES.ppf(0.1)
    assert guess["above"]["value"] is None or guess["above"]["failed_high"] >= TRUTH


def test_survival_has_a_band_with_the_failed_rows():
    ds, _, _ = lives()
    curve = uq.survival(ds, "life").sel(time=5.0, method="ffill")
    assert float(curve["high"]) < TRUTH < float(curve["failed_high"])
    assert float(curve["failed_low"]) < float(curve["low"])
    assert "failed_high" not in uq.survival(asking(with_output(
        linear(), "life", np.arange(1, 65), "lifetime")), "life")  # fmt: skip


def test_regimes_count_rows_that_failed_before_they_had_one():
    ds = linear(samples=400)
    lost = np.arange(40)
    attrs = {
        "role": "output",
        "kind": "category",
        "units": "1",
        "long_name": "which regime",
        "may_be_undefined": 0,
        "flag_values": np.array([-1, 0, 1], np.int8),
        "flag_meanings": "none low high",
    }
    codes = (np.arange(400) < 100).astype(np.int8)
    codes[lost] = -1
    ds = with_status(ds.assign(regime=("row", codes, attrs)), lost, 2)
    high = summarised(ds)["regime"]["high"]
    assert high["share"] == pytest.approx(60 / 360)
    assert high["failed_low"] < 0.15 < 0.25 < high["failed_high"]


def test_words_say_what_the_failed_rows_leave_open():
    bounds = Estimate(low=0.107, high=0.23)
    assert failed_bounds_text(bounds) == "0.107 to 0.23"
    assert failed_bounds_text(None) == ""
    assert failed_bounds_text(Estimate()) == "no bound"


def test_the_table_has_columns_of_the_bounds():
    ds, _, _ = lives()
    line = summary(ds).loc["life"]
    assert line["P(>5.0)_failed_low"] < TRUTH < line["P(>5.0)_failed_high"]
    assert line["q0.95_failed_high"] == np.inf and line["B1_failed_low"] == 0


def test_bounds_are_never_within_the_interval_where_replicates_scatter_less_with_failed_rows():
    # One failed row makes up for the one hit that the first replicate has less than the others.
    ds = linear("sobol", samples=64, replicates=4)
    hit = np.tile(np.repeat([0.0, 1.0], 32), 4)
    hit[32] = 0.0
    ds = with_status(with_output(ds, "life", 2.0 - hit, "lifetime"), [32], 2)
    ds["life"][32] = np.nan
    entry = summarised(asking(ds, thresholds={"life": 1.5}))["outputs"]["life"]
    for side in entry["thresholds"]["1.5"].values():
        if isinstance(side, dict):
            assert side["failed_low"] <= side["low"] and side["high"] <= side["failed_high"]
    curve = uq.survival(ds, "life")
    assert not (curve["failed_low"] > curve["low"]).any()
    assert not (curve["failed_high"] < curve["high"]).any()
    hits, failed = hit == 1.0, np.arange(256) == 32
    of = Dependence(np.repeat(np.arange(4), 64))
    bounds, plain = (
        failed_share_bounds(hits, failed, of),
        share_interval(hits[~failed], of[~failed]),
    )
    assert bounds.low <= plain[0] and plain[1] <= bounds.high
