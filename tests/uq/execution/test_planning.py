"""A plan says what a run takes, and how wide its intervals will be."""

import json
import os

import numpy as np
import pytest
from computed import summarised
from in_memory import compute

from uq.assess.expected_widths import Widths, expected_widths
from uq.cli.check import _widths
from uq.execution import planning, runner
from uq.result.result import Result
from uq.study.definition import load_study

NORMAL = 'distribution = "uniform", lower = 0.0, upper = 1.0'


@pytest.mark.slow
def test_the_cost_of_rows_that_sleep(write_study, monkeypatch):
    monkeypatch.setattr(planning, "PILOT_SECONDS", 0.5)
    more = "[settings]\nseconds = 0.01"
    study = load_study(
        write_study(uncertain=("x1",), samples=3000, more=more), "process_models:SLEEPING"
    )
    cost, pilot = planning.pilot(study, workers=2)
    assert cost.rows == 3000
    assert cost.workers == 2
    assert 0.01 <= cost.row_seconds < 0.02
    assert cost.seconds > 3000 * cost.row_seconds / 2
    assert cost.pilot_rows == pilot.sizes["row"] < 1000
    # From all of the study, not its beginning.
    assert pilot["row"].size == len(np.unique(pilot["group"].values))
    assert pilot["group"].values.max() > 2000


def test_a_small_study_is_run_whole(write_study):
    study = load_study(write_study(method="saltelli", samples=16, replicates=2))
    cost, pilot = planning.pilot(study, workers=1)
    assert cost.pilot_rows == cost.rows == 160
    assert pilot["y"].values.tolist() == compute(study, workers=0)["y"].values.tolist()


@pytest.mark.slow
def test_the_size_of_the_result_is_right(write_study, folder):
    study = load_study(write_study(samples=20_000))
    cost, _ = planning.pilot(study, workers=1)
    runner.run(study, "out.nc", workers=0)
    assert 1 / 1.5 < cost.result_bytes / os.path.getsize("out.nc") < 1.5


@pytest.mark.parametrize("replicates", [1, 8])
@pytest.mark.parametrize("method", ["monte-carlo", "saltelli"])
def test_widths_are_those_that_come_out(write_study, method, replicates):
    more = "[analysis]\nthresholds = {y = 5.0}\nquantiles = [0.25, 0.5]"
    study = load_study(
        write_study(
            model="linear",
            method=method,
            samples=1024,
            replicates=replicates,
            uncertain=("x1", "x2"),
            law=NORMAL,
            more=more,
        )
    )
    whole = compute(study, workers=0)
    pilot = whole.isel(row=slice(0, 400))
    expected = expected_widths(Result(pilot))["y"]
    statistics = summarised(whole)["outputs"]["y"]
    pairs = [(expected.mean, statistics["mean_interval"])]
    pairs += [(width, statistics["quantiles"][repr(p)]) for p, width in expected.quantiles.items()]
    pairs += [
        (width, statistics["thresholds"][repr(t)]["above"])
        for t, width in expected.thresholds.items()
    ]
    assert len(pairs) == 4
    for width, interval in pairs:
        if method == "monte-carlo":
            assert width / (interval["high"] - interval["low"]) == pytest.approx(1.0, abs=0.3)
        elif replicates == 1:
            assert width is None and interval["low"] is None
        elif interval["low"] is not None:  # scrambled designs are better than independent rows
            assert width > interval["high"] - interval["low"]
    assert ("S1" in expected.indices) == (method == "saltelli")


def test_plan_says_that_scrambled_designs_may_be_better(uq, write_study):
    design = {"method": "saltelli", "samples": 8, "replicates": 4}
    path = write_study(model="linear", uncertain=("x1", "x2"), **design)
    assert "\nLargest width to expect of the 95 % intervals" in uq("plan", path, "--workers", 0).out


def test_plan_shows_all_of_it(uq, write_study, monkeypatch):
    monkeypatch.setattr(planning, "_load_seconds", lambda: 1.0)
    path = write_study(model="linear", uncertain=("x1",), more="[settings]\nfail_above = 0.6")
    shown = uq("plan", path, "--workers", 1)
    assert shown.code == 0
    for word in ("rows", "64", "estimated from", "invalid", "one process", "on disk"):
        assert word in shown.out
    header, *lines = shown.out[shown.out.index("Expected width") :].splitlines()[1:]
    assert header.split() == ["mean", "0.05", "0.5", "0.95"]
    assert any(line.startswith("  y ") and len(line.split()) == 5 for line in lines)
    assert max(map(len, shown.out.splitlines())) <= 80
    plan = json.loads(uq("plan", path, "--json", "--samples", 128, "--workers", 1).out)
    assert plan["rows"] == 128
    assert plan["pilot"]["failed"] > 0
    assert set(plan) == {
        "rows",
        "workers",
        "pilot",
        "row_seconds",
        "seconds",
        "seconds_low",
        "seconds_high",
        "disk",
        "rows_needed",
        "widths",
    }
    assert plan["disk"]["run"] >= plan["disk"]["result"] > 0
    assert plan["widths"]["y"]["mean"] > 0


def test_a_quantile_at_a_life_that_never_ends_has_no_width(write_study):
    path = write_study(samples=200, uncertain=("x1",), law=NORMAL)
    ds = compute(load_study(path, "sample_models:KINDS"), workers=0)
    quantiles = expected_widths(Result(ds))["life[side=left,depth=0.5]"].quantiles
    assert quantiles[0.95] is None
    assert quantiles[0.05] > 0


def test_plan_shows_widths_of_quantiles_in_the_unit_of_the_life():
    widths = {"life": Widths("s", None, {0.05: 1.55e5, 0.5: 1.5e5}, {}, {})}
    assert list(_widths(widths)) == [("life [hours]", "-", "43.1", "41.7")]
