"""What is said of a run that may stop."""

import re

import pytest
from computed import study_of, summarised
from until_studies import PAIR, WEAR, study, tables, wear

from uq.execution import runner


def test_an_unattained_b_life_spends_the_budget_and_says_so(tmp_path):
    never = {"rate": WEAR["rate"]}
    of = wear({"b_life": "B90", "half_width": "1 days"}, never, samples=64)
    fixed = study_of(
        tables({"output": "life", "b_life": "B90", "half_width": "1 days"}, samples=64)
        | {"uncertain": never, "fixed": {"threshold": 1e-9}},
        "exponential-wear",
    )
    assert of.design.until.half_width == 86400.0
    ds = runner.run(fixed, tmp_path / "out.nc", workers=0)
    (note,) = summarised(ds)["notes"]
    assert "budget of 64 samples is spent: B90 of life is never; the required half-width" in note


@pytest.mark.parametrize(
    ("until", "more", "line"),
    [
        ({"b_life": "B90"}, {"fixed": {"threshold": 1e-9}}, "B90 of life is never, which has no"),
        ({}, {"fixed": {"threshold": 1e-9}}, r"mean of life has no interval \(some rows never end"),
    ],
)
def test_a_life_that_has_no_such_number_is_announced_once(tmp_path, until, more, line):
    design = tables({"output": "life", "half_width": "1 days", **until}, samples=512)
    given = design | {"uncertain": {"rate": WEAR["rate"]}} | more
    messages = []
    runner.run(
        study_of(given, "exponential-wear"), tmp_path / "out.nc", workers=0, say=messages.append
    )
    (message,) = [text for text in messages if "budget" in text]
    assert re.match(
        f"after 256 samples {line}.*; the run then continues up to its budget of 512", message
    )


@pytest.mark.parametrize("method", ["saltelli", "shapley"])
def test_an_input_without_effect_that_a_run_waits_for_is_announced(tmp_path, method):
    of_method = {"saltelli": ("ST", 128, 8), "shapley": ("shapley", 512, 1)}
    index, samples, replicates = of_method[method]
    until = {"output": "y", "index": index, "input": "x2", "half_width": 0.1}
    given = tables(until, samples, method, replicates)
    of = study_of(given | {"uncertain": PAIR}, "sample_models:PLAIN")
    messages = []
    ds = runner.run(of, tmp_path / "out.nc", workers=0, say=messages.append)
    (line,) = [message for message in messages if "budget" in message]
    words = f"{index} x2 of y is 0 and has no interval (no row shows an effect)"
    assert words in line and words in summarised(ds)["notes"][0]


def test_times_are_said_in_the_unit_that_people_use(tmp_path):
    of = wear({"b_life": "B10", "half_width": "30 hours"})
    ds = runner.run(of, tmp_path / "out.nc", workers=0)
    (note,) = summarised(ds)["notes"]
    assert "B10 of life is" in note and "days: the required half-width of 30 hours was" in note


def test_failed_rows_leave_with_their_groups(tmp_path):
    settings = {"fail_above": 0.99, "fail_how": "raise"}
    of = study(0.2, samples=128, method="saltelli", replicates=8, index="S1", settings=settings)
    ds = runner.run(of, tmp_path / "out.nc", workers=0)
    assert "groups with missing values)" in summarised(ds)["notes"][0]


def test_undefined_rows_are_not_said_to_have_failed(tmp_path):
    # Rows with x2 above 0.9 fail, others with x1 below 0.2 are undefined.
    given = tables({"output": "patchy", "half_width": 0.1}, samples=256) | {"uncertain": PAIR}
    ds = runner.run(study_of(given, "sample_models:PAIRED"), tmp_path / "out.nc", workers=0)
    x1, x2 = ds["x1"].values, ds["x2"].values
    failed, undefined = (x2 > 0.9).sum(), ((x2 <= 0.9) & (x1 < 0.2)).sum()
    words = f"(without {failed} invalid rows and {undefined} undefined rows)"
    assert words in summarised(ds)["notes"][0]


AGREEING = {
    "mean": ("sobol", 8, {}, "replicate"),
    "quantile": ("sobol", 8, {"quantile": 0.5}, "replicate"),
    "probability": ("sobol", 8, {"above": 0.5}, "replicate"),
    "index": ("saltelli", 8, {"index": "S1"}, "replicate"),
    "share": ("shapley", 1, {"index": "shapley", "input": "x1"}, "path"),
}


@pytest.mark.parametrize("kind", AGREEING)
def test_a_run_whose_replicates_agree_says_so(tmp_path, kind):
    method, replicates, more, part = AGREEING[kind]
    half = {"distribution": "discrete-choice", "values": [0.25, 0.75]}
    given = tables({"output": "y", "half_width": 0.01} | more, 64, method, replicates)
    of = study_of(given | {"uncertain": PAIR | {"x1": half}}, "sample_models:PLAIN")
    ds = runner.run(of, tmp_path / "out.nc", workers=0)
    assert summarised(ds)["notes"][0].endswith(f"has no interval (the same in each {part})")
