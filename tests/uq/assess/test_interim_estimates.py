"""What a run sees when it looks: of which rows, of which element, and what it does not know."""

import re

import numpy as np
import pytest
import xarray as xr
from computed import UNIFORM, computed, kinds, study_of, summarised
from until_studies import study, tables

from uq.assess import stopping
from uq.execution import runner
from uq.result.result import Result
from uq.stats import group_sequential


def test_looks_are_fixed_before_the_run_and_double_up_to_the_budget():
    assert stopping.interim_sizes(study(0.1, samples=1000).design) == (250, 500, 1000)
    assert stopping.interim_sizes(study(0.1, samples=20).design) == (20,)
    replicated = study(0.1, samples=250, method="halton", replicates=8).design
    assert stopping.interim_sizes(replicated) == (32, 63, 125, 250)
    design = study(0.1, samples=1000).design
    assert stopping.confidence(design) == group_sequential.of_independent_rows(3)
    several = study(0.1, samples=250, replicates=4).design
    assert stopping.interim_sizes(several) == (63, 125, 250)
    paths = study(0.1, samples=64, method="shapley", replicates=8, index="shapley").design
    assert stopping.interim_sizes(paths) == (32, 64)
    design = study(0.1, samples=1000, method="halton", replicates=8).design
    assert stopping.confidence(design) == group_sequential.of_replicates(8, 6)


def look_at(ds, **until):
    """Look at a result of the model with one output of every kind."""
    given = tables(until, samples=256) | {"uncertain": {"x1": UNIFORM, "x2": UNIFORM}}
    return stopping.interim_estimate(study_of(given, "sample_models:KINDS").design, Result(ds))


def test_the_element_that_is_known_worst_decides():
    ds = kinds(samples=256)
    ds["work"] = ds["work"] * xr.DataArray([1.0, 10.0], dims="side")

    def look(half_width):
        return look_at(ds, output="work", half_width=half_width)

    half = (look(1.0).estimate.high - look(1.0).estimate.low) / 2
    assert look(1.0).estimate.value == pytest.approx(float(ds["work"].sel(side="right").mean()))
    assert look(1.01 * half).reached and not look(0.99 * half).reached


def test_a_share_is_of_the_rows_that_did_not_fail():
    of = study(0.1, above=4.0, samples=200, settings={"fail_above": 0.5})
    ds = computed(of)
    sound = ds["y"].values[~np.isnan(ds["y"].values)]
    estimate = stopping.interim_estimate(of.design, Result(ds)).estimate
    assert len(sound) < 150 and estimate.value == (sound > 4.0).mean()
    assert estimate.low < estimate.value < estimate.high
    whole = computed(study(0.1, above=4.0, samples=200))
    narrower = stopping.interim_estimate(of.design, Result(whole)).estimate
    assert estimate.high - estimate.low > 1.2 * (narrower.high - narrower.low)


def test_a_share_that_depends_on_when_censored_rows_end_is_not_known():
    ds = kinds(samples=256)  # lives of 0.5 to 1.5, censored from 1.3 on
    name = "life[side=left,depth=0.5]"
    interim = look_at(ds, output=name, below=1.0, half_width=0.5)
    unknown = look_at(ds, output=name, below=1.4, half_width=0.5)
    assert interim.reached and 0.2 < interim.estimate.value < 0.4
    assert np.isnan(unknown.estimate.value) and not unknown.reached


def test_it_is_said_at_which_look_a_run_knew_enough(tmp_path):
    ds = runner.run(study(10.0, samples=500), tmp_path / "out.nc", workers=0)
    (note,) = summarised(ds)["notes"]
    assert "was reached at interim estimate 1 of at most 2" in note


def test_a_goal_out_of_reach_is_said_once_at_the_first_look_and_at_the_end(tmp_path):
    messages = []
    of = study(1e-9, samples=2048)
    ds = runner.run(of, tmp_path / "out.nc", workers=0, say=messages.append)
    assert ds.attrs["samples"] == 2048
    (line,) = [message for message in messages if "budget" in message]
    assert line.startswith("after 256 samples mean of y is ")
    needed = float(re.search(r"needs about (\S+) samples, more than the budget of 2048", line)[1])
    half = stopping.interim_estimate(of.design, Result(ds)).half_width
    assert needed == pytest.approx(2048 * (half / 1e-9) ** 2, rel=0.5)
    (note,) = summarised(ds)["notes"]
    assert "was not reached: from the scatter of all rows, about " in note


def test_a_goal_within_reach_is_not_called_out_of_reach(tmp_path):
    messages = []
    of = study(0.07, samples=1024)
    at_end = stopping.interim_estimate(of.design, Result(computed(of)))
    assert at_end.required < at_end.half_width < 2 * at_end.required
    runner.run(of, tmp_path / "out.nc", workers=0, say=messages.append)
    assert not [message for message in messages if "budget" in message]
