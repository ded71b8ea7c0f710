"""The posterior of a result: in closed form where that is known, and each measurement used once."""

import json
import re
from pathlib import Path

import numpy as np
import pytest
from command_line import everything, strict_json
from computed import linear
from learnt_studies import exactly, measured, wear
from scipy.stats import lognorm, norm

from uq.errors import InputError, RunError
from uq.explore.updating import update
from uq.files.whole_files import write_result
from uq.learning.answer import learnt, learnt_facts
from uq.learning.next_inspection import worth
from uq.learning.posterior_result import as_unit, prior_of, unit_quality
from uq.result.result import Result
from uq.result.result_file import open_result
from uq.stats.importance_weights import smoothed

SHARED = {"rate": "shared", "samples": 2000, "units": 3}


@pytest.fixture(scope="module")
def result():
    return wear()


@pytest.fixture(scope="module")
def three_units():
    return wear(**SHARED)


def inputs_of(ds):
    return learnt_facts(learnt(ds)).json["inputs"]


def assert_close(moments, mean, sd):
    """Compare with a lognormal law: mean within 1 %, deviation and quantiles within 3 %."""
    law = lognorm(sd, scale=np.exp(mean))
    assert moments["mean"] == pytest.approx(law.mean(), rel=0.01)
    assert moments["sd"] == pytest.approx(law.std(), rel=0.03)
    for p, value in moments["quantiles"].items():
        assert value == pytest.approx(law.ppf(float(p)), rel=0.03)


def test_one_unit_agrees_with_the_closed_form(result):
    inputs = inputs_of(update(result, measured(5e5)))
    mean, cov = exactly([5e5])
    assert set(inputs) == {"rate[unit=A]", "depth[unit=A]"}  # nothing is shared
    for i, name in enumerate(inputs):
        assert_close(inputs[name]["posterior"], mean[i], cov[i, i] ** 0.5)


def test_moments_that_rest_on_a_few_rows_are_refused(three_units):
    """Pareto k of weight times value, not of the weights alone."""
    ds = update(three_units, measured(6e5))
    heavy = (ds["rate"] / 2.5e-10) ** 20
    posterior = inputs_of(ds.assign(rate=heavy.assign_attrs(ds["rate"].attrs)))["rate"]["posterior"]
    assert (
        posterior["mean"] is None and posterior["sd"] is None and posterior["quantiles"]["0.5"] > 0
    )
    assert "(Pareto k " in posterior["mean_reason"]
    assert "mean_reason" not in inputs_of(ds)["rate"]["posterior"]


def test_what_is_shared_is_learnt_from_all_units(three_units):
    lives = [6e5, 1e6, 1.2e6]
    inputs = inputs_of(update(three_units, measured(*lives)))
    mean, cov = exactly(lives, shared_rate=True)
    law = lognorm(cov[0, 0] ** 0.5, scale=np.exp(mean[0]))
    assert inputs["rate"]["posterior"]["mean"] == pytest.approx(law.mean(), rel=0.02)
    assert inputs["rate"]["posterior"]["sd"] == pytest.approx(law.std(), rel=0.06)
    for i, unit in enumerate("ABC", start=1):
        of_unit = inputs[f"depth[unit={unit}]"]["posterior"]
        law = lognorm(cov[i, i] ** 0.5, scale=np.exp(mean[i]))
        assert of_unit["mean"] == pytest.approx(law.mean(), rel=0.02)


@pytest.mark.slow
def test_an_integrated_input_that_all_share_is_exact():
    lives = [6e5, 1e6, 1.2e6]
    ds = wear(rate="own", depth="shared", samples=2000, units=3)
    posterior = inputs_of(update(ds, measured(*lives)))["depth"]["posterior"]
    of_logs = 0.5**2 + np.log1p(0.1**2)
    precision = 1 / 0.3**2 + 3 / of_logs
    seen = np.log(np.array(lives) * 2.5e-10).sum() / of_logs
    mean = (np.log(2.5e-4) / 0.3**2 + seen) / precision
    assert_close(posterior, mean, precision**-0.5)


def test_units_of_a_sample_keep_one_value_of_what_they_share():
    ds = wear(rate="own", depth="shared", samples=100, units=3)
    updated = update(ds, measured(6e5))
    by_sample = updated["depth"].values.reshape(100, 3)
    assert (by_sample == by_sample[:, :1]).all()
    np.testing.assert_allclose(updated["life"], updated["depth"] / updated["rate"], rtol=1e-12)


def test_two_updates_are_one(result):
    first, second = (
        measured(5e5),
        [{"unit": "A", "output": "life", "kind": "survived", "time": 4e5}],
    )
    at_once = update(result, first + second)
    assert update(update(result, first), second).identical(at_once)
    assert prior_of(Result(at_once)).dataset.identical(result)


def test_a_measurement_counts_once(result):
    once = update(result, measured(5e5))
    with pytest.raises(InputError, match=r"^inspection 1 \(unit A, life, measured\): already used"):
        update(once, measured(5e5))
    with pytest.raises(InputError, match="already used by inspection 1; a measurement counts once"):
        update(result, measured(5e5) * 2)


def test_it_is_written_as_it_is(result, tmp_path):
    made = update(result, measured(5e5), tmp_path / "posterior.nc")
    assert open_result(tmp_path / "posterior.nc").identical(made)
    assert made["weight"].sizes == {"row": 6000} and "ledger" in made.attrs


def test_many_units_take_little_room_on_disk(tmp_path):
    """Of a sample each row stands for one of them, and is left out of the others."""
    ds = wear(samples=200, rate="shared", units=10)
    made = update(ds, measured(*[8e5] * 10), tmp_path / "posterior.nc")
    assert (tmp_path / "posterior.nc").stat().st_size < made.nbytes / 5
    assert open_result(tmp_path / "posterior.nc").identical(made)


def test_more_units_than_a_sample_has_are_refused_where_samples_are_worlds(result):
    with pytest.raises(InputError, match=r"2 units are inspected, .* has 1: set \[design\] units"):
        update(wear(100, rate="shared"), measured(5e5, 6e5))
    # Without shared inputs any row represents any unit.
    inputs = inputs_of(update(result, measured(5e5, 6e5)))
    mean, cov = exactly([5e5, 6e5])
    for i, name in enumerate(["rate[unit=A]", "rate[unit=B]"]):
        assert_close(inputs[name]["posterior"], mean[i], cov[i, i] ** 0.5)


def test_what_contradicts_the_rows_is_refused(result, tmp_path):
    target = tmp_path / "posterior.nc"
    with pytest.raises(RunError, match="unit A: .*(Pareto k|fewer than 5 samples)"):
        update(result, measured(1e8, cv=0.01), target)
    with pytest.raises(InputError, match=r"1 \(unit A, life, ended\): no row .* agrees with it"):
        update(result, [{"unit": "A", "output": "life", "kind": "ended", "time": 1.0}], target)
    assert everything(tmp_path) == []


def test_as_many_rows_as_a_refusal_names_are_enough():
    """Any measurement with an error bounds the weights: enough rows can always be named."""
    precise = [{"unit": "A", "output": "y", "kind": "measured", "value": 5.0, "sd": 0.01}]
    with pytest.raises(RunError, match="single rows may carry over 1 % of the weight") as refused:
        update(linear(samples=500), precise)
    more = int(re.search(r"add (\d+) rows", str(refused.value))[1])
    assert unit_quality(Result(update(linear(samples=500 + more), precise)))[0].effective > 50


def test_a_model_error_widens(result):
    without, with_error = (
        inputs_of(update(result, measured(5e5), model_error=cv))["rate[unit=A]"]["posterior"]["sd"]
        for cv in (0.0, 0.5)
    )
    assert with_error > 1.05 * without


def test_a_model_error_blurs_a_limit_but_not_what_was_seen_to_run(result):
    """A limit of the life at the same time is blurred; see the guide."""
    seen = {"unit": "A", "output": "life", "kind": "survived", "time": 1e6}
    limit = {"unit": "A", "output": "life", "kind": "above", "value": 1e6}
    units = {
        (told["kind"], cv): as_unit(update(result, [told], model_error=cv), "A")
        for told in (seen, limit)
        for cv in (0.0, 0.3)
    }
    early = {
        key: np.average(unit_rows["life"] < 1e6, weights=unit_rows["weight"])
        for key, unit_rows in units.items()
    }
    assert early["survived", 0.0] == early["survived", 0.3] == early["above", 0.0] == 0
    assert early["above", 0.3] == pytest.approx(0.145, abs=0.02)


def test_the_life_left_is_that_of_a_unit_that_runs(result):
    lived = [{"unit": "A", "output": "life", "kind": "survived", "time": 1e6}]
    life = learnt_facts(learnt(update(result, lived), [2e6])).json["units"]["A"]["life"]
    lives = lognorm((0.5**2 + 0.3**2) ** 0.5, scale=1e6)
    gone = (lives.cdf(2e6) - lives.cdf(1e6)) / lives.sf(1e6)
    assert life["by"]["2000000.0"]["value"] == pytest.approx(gone, abs=0.02)
    median = lives.isf(lives.sf(1e6) / 2) - 1e6
    assert life["remaining"]["0.5"]["value"] == pytest.approx(median, rel=0.06)


def test_the_command(uq, folder, result):
    write_result(result, folder / "prior.nc")
    (folder / "found.csv").write_text("unit,output,kind,value,cv\nA,life,measured,5e5,0.1\n")
    ended = uq("update", "prior.nc", "found.csv", "-o", "posterior.nc", "--by", "1e6", "--json")
    assert (ended.code, ended.err) == (0, "")
    document = strict_json(ended.out)
    assert document["effective_rows"] > 1000 and document["pareto_k"] < 0.7
    rate = document["inputs"]["rate[unit=A]"]
    assert {"mean", "sd"} <= set(rate["prior"]) and "0.05" in rate["posterior"]["quantiles"]
    again = uq("update", "posterior.nc", "found.csv", "-o", "twice.nc")
    assert again.code == 2 and "already used" in again.err and again.err.count("\n") == 1
    assert not (folder / "twice.nc").exists()
    shown = uq("update", "prior.nc", "found.csv", "-o", "posterior.nc")
    assert shown.code == 0 and max(map(len, shown.out.splitlines())) <= 80
    assert re.search(
        r"rate +\d{3}(\.\d)? .* pm s\N{SUPERSCRIPT MINUS}\N{SUPERSCRIPT ONE}\n", shown.out
    )
    assert uq("summary", "posterior.nc").code == 0


def test_a_study_is_run_first(uq, folder):
    study = Path(__file__).parents[3] / "studies" / "exponential-wear.toml"
    (folder / "found.csv").write_text("unit,output,kind,time\nA,life,survived,1\n")
    ended = uq("update", study, "found.csv", "-o", "posterior.nc", "--rows", "200", "--json")
    assert ended.code == 0, ended.err
    assert open_result(folder / "posterior.nc").sizes["row"] == 200
    assert json.loads(ended.out)["effective_rows"] == pytest.approx(200)


def test_what_the_next_inspection_is_worth(uq, folder):
    ds = wear(rate="shared", samples=2000, units=5)
    information = worth(ds, "life", units=(1, 20), cv=0.1)
    for units in (1, 20):
        noise = (0.3**2 + np.log1p(0.1**2)) / units
        exact = 1 - (1 - 0.5**2 / (0.5**2 + noise)) ** 0.5
        assert information.narrowing[None, units] == pytest.approx(exact, abs=0.015)
    posterior = update(ds, measured(6e5, 1e6, 1.2e6))
    assert worth(posterior, "life").narrowing[None, 1] < information.narrowing[None, 1]
    write_result(posterior, folder / "posterior.nc")
    ended = uq("next-inspection", "posterior.nc", "--inspect", "life", "--json")
    assert [row["units"] for row in strict_json(ended.out)["narrowing"]] == [1, 5, 20]
    assert uq("next-inspection", "posterior.nc", "--inspect", "lif").err.count("\n") == 1


def test_the_rows_of_a_run_are_not_overwritten_by_a_posterior(result, tmp_path):
    write_result(result, tmp_path / "run.nc")
    with pytest.raises(InputError, match="no inspections have weighted; choose another output"):
        update(tmp_path / "run.nc", measured(5e5), tmp_path / "run.nc")
    assert open_result(tmp_path / "run.nc").identical(result)
    first = update(tmp_path / "run.nc", measured(5e5), tmp_path / "after.nc")
    assert not update(tmp_path / "run.nc", measured(6e5), tmp_path / "after.nc").equals(first)


def test_rows_as_those_of_one_unit(result):
    unit = as_unit(update(result, measured(5e5)), "A")
    lives = np.average(unit["life"], weights=unit["weight"])
    assert lives == pytest.approx(5e5, rel=0.05)
    with pytest.raises(InputError, match="unit 'B' was not inspected.*allowed: A"):
        as_unit(update(result, measured(5e5)), "B")


def test_what_an_inspection_taught_and_how_strange_it_was(result):
    learned = learnt(update(result, measured(5e5)))
    mean, cov = exactly([5e5])
    before, start = np.diag([0.5**2, 0.3**2]), np.log([2.5e-10, 2.5e-4])
    far = (mean - start) @ np.linalg.solve(before, mean - start)
    volume = np.log(np.linalg.det(before) / np.linalg.det(cov))
    bits = (np.trace(np.linalg.solve(before, cov)) + far - 2 + volume) / 2 / np.log(2)
    assert [inspection.bits for inspection in learned.taught] == [pytest.approx(bits, rel=0.03)]
    deviation = (0.5**2 + 0.3**2 + np.log1p(0.1**2)) ** 0.5
    assert learned.strangeness == pytest.approx(2 * norm.sf(np.log(2) / deviation), abs=0.03)
    assert learned.notes == []


def test_what_survival_taught_where_units_share_an_input():
    ds = wear(rate="shared", samples=2000, units=1)
    survived = {"unit": "A", "time": 2e6, "output": "life", "kind": "survived"}
    bits = -norm.logsf(np.log(2) / (0.5**2 + 0.3**2) ** 0.5) / np.log(2)
    assert [inspection.bits for inspection in learnt(update(ds, [survived])).taught] == [
        pytest.approx(bits, rel=0.05)
    ]


def test_strange_inspections_come_with_a_warning():
    ds = wear(rate="own", depth="shared", samples=2000, units=3)
    learned = learnt(update(ds, measured(2.8e5, 3.4e6, 2.9e5, cv=0.2)))
    assert learned.strangeness < 0.01
    assert any(
        note.startswith("Warning: the inspections contradict the prior") for note in learned.notes
    )


def test_bounded_weights_need_no_light_tail():
    rng = np.random.default_rng(0)
    above = np.abs(0.003 * rng.standard_cauchy(300)).clip(0, 0.9)
    weights = 0.44 + np.concatenate([0.001 * rng.random(5700), above])
    assert smoothed(np.log(weights)).k > 0.6  # although none is much larger than the others
    smoothing = smoothed(np.log(weights), most=2.5)
    assert (smoothing.k, smoothing.refusal) == (0.0, "")
    np.testing.assert_allclose(smoothing.weights, weights / weights.mean())
    assert smoothed(np.log(weights), most=100.0).k > 0.6  # a single row may carry too much
