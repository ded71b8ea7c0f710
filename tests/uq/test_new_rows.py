"""New rows where inspections point: the right posterior, resumed to the bit, or a refusal."""

import numpy as np
import pytest
from command_line import everything, strict_json
from computed import computed, study_of
from learnt_studies import DEPTH, RATE, exactly, lognormal, measured, wear

from uq.errors import InputError, RunError
from uq.exploring import new_rows
from uq.exploring.updating import update
from uq.learning.answer import learnt, learnt_json
from uq.learning.importance import own_rows
from uq.learning.result import as_unit, prior_of
from uq.rows.results import open_result
from uq.store.files import write_result

FAR = measured(2e7, cv=0.05)
"""Five standard deviations from what the study expects."""


@pytest.fixture(scope="module")
def result():
    return wear(samples=2000)


@pytest.fixture(scope="module")
def found(result):
    return update(result, FAR, rows=8000, workers=0)


def log_rate_and_depth(ds):
    """Return means and standard deviations of the logarithms of rate and depth of unit A."""
    unit = as_unit(ds, "A")
    weights = unit["weight"].values
    logs = np.log([unit["rate"].values, unit["depth"].values])
    mean = np.average(logs, axis=1, weights=weights)
    return mean, np.average((logs - mean[:, None]) ** 2, axis=1, weights=weights) ** 0.5


def test_what_contradicts_the_rows_ends_in_the_right_posterior(result, found):
    with pytest.raises(RunError, match=r"Pareto k.*or update the result with --rows N"):
        update(result, FAR)
    mean, cov = exactly([2e7], cv=0.05)
    sd = np.diag(cov) ** 0.5
    means, sds = log_rate_and_depth(found)
    assert np.abs((means - mean) / sd).max() < 0.15  # of 400 effective rows or more
    assert np.abs(sds / sd - 1).max() < 0.1
    answer = learnt_json(learnt(found))
    assert answer["effective_rows"] >= 400 and answer["pareto_k"] < 0.7
    assert answer["strangeness"] < 0.01
    # The laws before the inspections are those of the study, whatever the rows were drawn from.
    before = answer["inputs"]["rate[unit=A]"]["prior"]
    assert before["mean"] == pytest.approx(RATE[0] * np.exp(RATE[1] ** 2 / 2), rel=0.05)
    assert before["sd"] == pytest.approx(before["mean"] * np.expm1(RATE[1] ** 2) ** 0.5, rel=0.1)


def test_bits_taught_are_exact(found):
    mean, cov = exactly([2e7], cv=0.05)
    prior, start = np.diag([RATE[1] ** 2, DEPTH[1] ** 2]), np.log([RATE[0], DEPTH[0]])
    far = (mean - start) @ np.linalg.solve(prior, mean - start)
    volume = np.log(np.linalg.det(prior) / np.linalg.det(cov))
    bits = (np.trace(np.linalg.solve(prior, cov)) + far - 2 + volume) / 2 / np.log(2)
    assert [one.bits for one in learnt(found).taught] == [pytest.approx(bits, rel=0.03)]


@pytest.mark.slow
def test_a_second_update_draws_its_own_rows(result, found):
    assert own_rows(prior_of(found)).identical(result)
    more = [{"unit": "A", "output": "life", "kind": "survived", "time": 1.9e7}]
    twice = update(found, more, rows=8000, workers=0)
    assert twice.identical(update(result, FAR + more, rows=8000, workers=0))


@pytest.mark.slow
def test_a_posterior_in_two_regimes():
    """Units that never wear out count as they should beside those that do."""
    ds = computed(
        study_of(
            {
                "study": {"name": "regimes", "model": "exponential-wear"},
                "design": {"method": "monte-carlo", "samples": 2000, "seed": 5},
                "uncertain": {
                    "rate": lognormal(*RATE),
                    "threshold": lognormal(2e-11, 0.5),  # 5 standard deviations below the rate
                    "depth": lognormal(*DEPTH),
                },
            }
        )
    )
    lived = [{"unit": "A", "output": "life", "kind": "survived", "time": 8e6}]
    unit = as_unit(update(ds, lived, rows=8000, workers=0), "A")
    rng = np.random.default_rng(1)
    scores = rng.standard_normal((4_000_000, 3))
    rate, threshold, depth = np.exp(
        np.log([RATE[0], 2e-11, DEPTH[0]]) + scores * [RATE[1], 0.5, DEPTH[1]]
    ).T
    never = rate < threshold
    exact = never.sum() / (never | (depth / rate > 8e6)).sum()
    weights = unit["weight"].values
    share = weights[np.isinf(unit["life"].values)].sum() / weights.sum()
    assert share == pytest.approx(exact, abs=0.08)


@pytest.mark.slow
def test_killed_and_resumed_to_the_same_bits(tmp_path, monkeypatch):
    result = wear(samples=1000)
    calls, run = [], new_rows.run_study

    def killed(*asked):
        calls.append(asked)
        if len(calls) == 3:
            raise KeyboardInterrupt
        return run(*asked)

    options = {"rows": 8000, "workers": 0}
    at_once = update(result, FAR, tmp_path / "once.nc", **options)
    monkeypatch.setattr(new_rows, "run_study", killed)
    with pytest.raises(KeyboardInterrupt):
        update(result, FAR, tmp_path / "posterior.nc", **options)
    assert len(list(tmp_path.glob("posterior-*-round-*.nc"))) == 2
    assert update(result, FAR, tmp_path / "posterior.nc", **options).identical(at_once)
    assert open_result(tmp_path / "posterior.nc").identical(open_result(tmp_path / "once.nc"))
    assert sorted(everything(tmp_path)) == ["once.nc", "posterior.nc"]


def test_a_budget_that_is_too_small_is_refused(result, tmp_path):
    with pytest.raises(InputError, match="rows = 499: a round of new rows takes 500"):
        update(result, FAR, tmp_path / "posterior.nc", rows=499, workers=0)
    with pytest.raises(RunError, match="after 500 new rows: unit A: "):
        update(result, measured(1e8, cv=0.01), tmp_path / "posterior.nc", rows=500, workers=0)
    assert not (tmp_path / "posterior.nc").exists()


def test_rows_that_cannot_be_drawn_are_refused():
    ds = wear(samples=500, rate="shared", units=2)
    with pytest.raises(InputError, match="only for a 'monte-carlo' design without replicates, and"):
        update(ds, measured(1e8, 1e8, cv=0.01), rows=1000)


def test_the_command(uq, folder, result):
    write_result(result, folder / "prior.nc")
    (folder / "found.csv").write_text("unit,output,kind,value,cv\nA,life,measured,2e7,0.05\n")
    asked = "update", "prior.nc", "found.csv", "-o", "posterior.nc"
    assert "--rows N" in uq(*asked).err
    ended = uq(*asked, "--rows", "8000", "--workers", "0", "--json")
    assert ended.code == 0, ended.err
    assert strict_json(ended.out)["effective_rows"] >= 400
    assert sorted(everything(folder)) == ["found.csv", "posterior.nc", "prior.nc"]
    assert uq("summary", "posterior.nc").code == 0
    assert uq("report", "posterior.nc").code == 0


@pytest.mark.slow
def test_the_sampler_is_as_exact_as_its_effective_rows_say():
    """Of independent repetitions: the scatter of the mean, and coverage of its interval."""
    mean, cov = exactly([2e7], cv=0.05)
    off = []
    for seed in range(1000):
        found = update(wear(samples=2000, seed=seed), FAR, rows=8000, workers=0)
        rows = learnt_effective(found)
        means, sds = log_rate_and_depth(found)
        off.append((means[0] - mean[0]) / (sds[0] / rows**0.5))
    inside = np.mean(np.abs(off) < 1.96)
    assert 0.93 <= inside <= 0.975
    assert abs(np.mean(off)) < 0.15


def learnt_effective(found):
    weights = as_unit(found, "A")["weight"].values
    return weights.sum() ** 2 / (weights**2).sum()
