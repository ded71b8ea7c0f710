"""New rows where inspections point: the right posterior, resumed to the bit, or a refusal."""

import subprocess
import sys
import time

import numpy as np
import pytest
from command_line import everything, strict_json
from computed import computed, study_of
from learnt_studies import DEPTH, RATE, exactly, lognormal, measured, wear
from scipy import special

from uq.errors import InputError, RunError
from uq.explore.updating import update
from uq.files.whole_files import write_result
from uq.learning.answer import learnt, learnt_facts
from uq.learning.importance import own_rows
from uq.learning.posterior_result import as_unit, prior_of
from uq.result.result import Result
from uq.result.result_file import open_result
from uq.sampling.copulas import copula_of_rank

FAR = measured(2e7, cv=0.05)
"""Five standard deviations from what the study expects."""

UNLIKELY = measured(1e7, cv=0.1)
"""Four standard deviations from what the study expects."""

SMALL = {"rows": 8000, "workers": 0}


@pytest.fixture(scope="module")
def result():
    return wear(samples=400)


@pytest.fixture(scope="module")
def new_rows(result):
    return update(result, UNLIKELY, **SMALL)


def log_rate_and_depth(ds, unit="A"):
    """Return means and standard deviations of the logarithms of rate and depth of a unit."""
    unit = as_unit(ds, unit)
    weights = unit["weight"].values
    logs = np.log([unit["rate"].values, unit["depth"].values])
    mean = np.average(logs, axis=1, weights=weights)
    return mean, np.average((logs - mean[:, None]) ** 2, axis=1, weights=weights) ** 0.5


def assert_exact(ds, mean, cov, unit="A"):
    """Compare the logarithms of rate and depth with the closed form, of 400 effective rows."""
    sd = np.diag(cov) ** 0.5
    means, sds = log_rate_and_depth(ds, unit)
    assert np.abs((means - mean) / sd).max() < 0.2
    assert np.abs(sds / sd - 1).max() < 0.15


def test_what_contradicts_the_rows_ends_in_the_right_posterior(result, new_rows):
    check(result, UNLIKELY, new_rows, *exactly([1e7], cv=0.1))


@pytest.mark.slow
def test_what_contradicts_the_rows_more_ends_in_the_right_posterior(result):
    check(result, FAR, update(result, FAR, **SMALL), *exactly([2e7], cv=0.05))


def under_copula(life, cv):
    """Return means and sds of the logarithms of rate and depth given a life, by quadrature."""
    z = np.linspace(-6.5, 6.5, 801)
    first, second = (grid.ravel() for grid in np.meshgrid(z, z, indexing="ij"))
    copula = copula_of_rank("clayton", 0.6)
    logs = np.log(RATE[0]) + RATE[1] * first, np.log(DEPTH[0]) + DEPTH[1] * second
    error = (np.log(life) - (logs[1] - logs[0])) / np.sqrt(np.log1p(cv**2))
    density = copula.log_density(special.ndtr(first), special.ndtr(second))
    weight = np.exp(density - (first**2 + second**2 + error**2) / 2)
    mean = np.array([np.average(log, weights=weight) for log in logs])
    squares = np.array([np.average(log**2, weights=weight) for log in logs])
    return mean, np.sqrt(squares - mean**2)


@pytest.mark.parametrize("new_rows", [{}, SMALL], ids=["rows", "new rows"])
def test_the_copula_of_the_inputs_is_part_of_the_prior(new_rows):
    pair = {"parameters": ["rate", "depth"], "rank_correlation": [[1.0, 0.6], [0.6, 1.0]]}
    life, cv = (2.5e6, 0.1) if not new_rows else (6e6, 0.1)
    inspected = measured(life, cv=cv)
    prior = wear(samples=20_000 if not new_rows else 400, dependence=pair | {"copula": "clayton"})
    means, sds = log_rate_and_depth(update(prior, inspected, **new_rows))
    mean, sd = under_copula(life, cv)
    assert np.abs((means - mean) / sd).max() < 0.15
    assert np.abs(sds / sd - 1).max() < 0.12


def check(result, inspections, ds, mean, cov):
    with pytest.raises(RunError, match=r"or update the result with --rows N"):
        update(result, inspections)
    assert_exact(ds, mean, cov)
    answer = learnt_facts(learnt(ds)).json
    assert answer["effective_rows"] >= 400 and answer["pareto_k"] < 0.7
    assert answer["strangeness"] < 0.01
    # The laws before the inspections are those of the study, whatever the rows were drawn from.
    before = answer["inputs"]["rate[unit=A]"]["prior"]
    assert before["mean"] == pytest.approx(RATE[0] * np.exp(RATE[1] ** 2 / 2), rel=0.1)
    assert before["sd"] == pytest.approx(before["mean"] * np.expm1(RATE[1] ** 2) ** 0.5, rel=0.2)


def test_intervals_rest_on_independent_repetitions(result, new_rows):
    assert np.unique(new_rows["replicate"]).tolist() == list(range(8))
    assert new_rows.attrs["replicates"] == 8
    after = learnt_facts(learnt(new_rows)).json["inputs"]["rate[unit=A]"]["posterior"]
    assert after["mean_low"] < after["mean"] < after["mean_high"]
    assert after["sd_low"] < after["sd"] < after["sd_high"]
    assert own_rows(prior_of(Result(new_rows))).dataset.identical(result)


def test_bits_taught_are_exact(new_rows):
    mean, cov = exactly([1e7], cv=0.1)
    prior, start = np.diag([RATE[1] ** 2, DEPTH[1] ** 2]), np.log([RATE[0], DEPTH[0]])
    far = (mean - start) @ np.linalg.solve(prior, mean - start)
    volume = np.log(np.linalg.det(prior) / np.linalg.det(cov))
    bits = (np.trace(np.linalg.solve(prior, cov)) + far - 2 + volume) / 2 / np.log(2)
    assert [inspection.bits for inspection in learnt(new_rows).taught] == [
        pytest.approx(bits, rel=0.05)
    ]


@pytest.mark.slow
def test_a_second_update_draws_its_own_rows(result, new_rows):
    more = [{"unit": "A", "output": "life", "kind": "survived", "time": 9e6}]
    assert update(new_rows, more, **SMALL).identical(update(result, UNLIKELY + more, **SMALL))


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
def test_several_units_of_a_sample():
    """Two units, far off each in its own way, whose depth is shared and integrated."""
    lives = [1.5e7, 2e7]
    ds = wear(depth="shared", samples=200, units=2)
    with pytest.raises(RunError, match="or update the result with --rows N"):
        update(ds, measured(*lives, cv=0.05))
    updated = update(ds, measured(*lives, cv=0.05), **SMALL)
    prior = np.diag([RATE[1] ** 2] * 2 + [DEPTH[1] ** 2])
    start = np.log([RATE[0]] * 2 + [DEPTH[0]])
    look = np.hstack([-np.eye(2), np.ones((2, 1))])
    gain = prior @ look.T @ np.linalg.inv(look @ prior @ look.T + np.log1p(0.05**2) * np.eye(2))
    mean, cov = start + gain @ (np.log(lives) - look @ start), prior - gain @ look @ prior
    for i, unit in enumerate("AB"):
        assert_exact(updated, mean[[i, 2]], cov[np.ix_([i, 2], [i, 2])], unit)
    assert own_rows(prior_of(Result(updated))).dataset.identical(ds)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["sobol", "monte-carlo"])
def test_designs_with_replicates(method):
    ds = wear(samples=64, method=method, replicates=8)
    updated = update(ds, FAR, **SMALL)
    assert_exact(updated, *exactly([2e7], cv=0.05))
    assert own_rows(prior_of(Result(updated))).dataset.identical(ds)


@pytest.mark.slow
def test_an_input_that_is_a_multiple_of_another():
    tables = {
        "study": {"name": "multiple", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 400, "seed": 3},
        "uncertain": {
            "rate": lognormal(*RATE),
            "depth": lognormal(*DEPTH),
            "threshold": {"distribution": "uniform", "lower": 0.1, "upper": 0.5, "times": "rate"},
        },
    }
    updated = update(computed(study_of(tables)), FAR, **SMALL)
    assert_exact(updated, *exactly([2e7], cv=0.05))
    factor = updated["threshold"].values / updated["rate"].values
    assert 0.1 <= factor.min() and factor.max() <= 0.5


UNSUITED = {
    "two units share rate": ({"rate": "shared", "units": 2}, "units share rate, and may share"),
    "repeats": ({"repeats": 2}, "each unit has 2 repeats, not one"),
    "one Sobol' sequence": ({"method": "sobol", "samples": 512}, r"set \[design\] replicates = 8"),
    "crossed": ({"method": "saltelli", "samples": 512}, "the design is 'saltelli', not 'monte-"),
}


@pytest.mark.parametrize("case", UNSUITED)
def test_rows_that_cannot_be_drawn_are_refused(case):
    design, why = UNSUITED[case]
    ds = wear(**{"samples": 500} | design)
    with pytest.raises(InputError, match=f"^new rows cannot be drawn: .*{why}"):
        update(ds, measured(2e7, cv=0.01), rows=1000)


def test_a_budget_that_is_too_small_is_refused(result, tmp_path):
    with pytest.raises(InputError, match="rows = 99: a round of new rows takes 104"):
        update(result, FAR, tmp_path / "posterior.nc", rows=99, workers=0)
    with pytest.raises(RunError, match="after 104 new rows: unit A: "):
        update(result, measured(1e8, cv=0.01), tmp_path / "posterior.nc", rows=150, workers=0)
    assert not (tmp_path / "posterior.nc").exists()


def asked(folder, result):
    """Return the command that updates a file of this result."""
    write_result(result, folder / "prior.nc")
    (folder / "found.csv").write_text("unit,output,kind,value,cv\nA,life,measured,2e7,0.05\n")
    return "update", "prior.nc", "found.csv", "-o", "posterior.nc"


def test_the_command_asks_for_rows_and_takes_them(uq, folder, result):
    command = asked(folder, result)
    assert "--rows N" in uq(*command).err
    few = uq(*command, "--rows", "104", "--workers", "0")
    assert few.code == 1 and "after 104 new rows: unit A: " in few.err
    assert not (folder / "posterior.nc").exists()


@pytest.mark.slow
def test_the_command(uq, folder, result):
    command = asked(folder, result)
    ended = uq(*command, "--rows", "8000", "--workers", "0", "--json")
    assert ended.code == 0, ended.err
    assert strict_json(ended.out)["effective_rows"] >= 400
    assert sorted(everything(folder)) == ["found.csv", "posterior.nc", "prior.nc"]
    summary = uq("summary", "posterior.nc")
    assert summary.code == 0 and "No intervals" not in summary.out


@pytest.mark.slow
def test_the_report_of_new_rows(uq, folder, new_rows):
    write_result(new_rows, folder / "posterior.nc")
    assert uq("report", "posterior.nc").code == 0
    assert " -o posterior.nc --rows 8000\n" in (folder / "posterior.html").read_text()


@pytest.mark.slow
def test_killed_and_resumed_to_the_same_bits(tmp_path, result):
    """The process itself is killed, twice, once it has kept one and three rounds."""
    write_result(result, tmp_path / "prior.nc")
    (tmp_path / "found.csv").write_text("unit,output,kind,value,cv\nA,life,measured,2e7,0.05\n")

    def started(output):
        asked = ("update", "prior.nc", "found.csv", "-o", output, "--rows", "8000")
        command = [sys.executable, "-m", "uq", *asked, "--workers", "0", "--quiet"]
        return subprocess.Popen(command, cwd=tmp_path)

    for rounds in (1, 3):
        process = started("killed.nc")
        while len(list(tmp_path.glob("killed-*-round-?.nc"))) < rounds:
            assert process.poll() is None, "ended before it was killed"
            time.sleep(0.001)
        process.kill()
        process.wait()
        assert not (tmp_path / "killed.nc").exists()
    assert [started(name).wait() for name in ("killed.nc", "once.nc")] == [0, 0]
    assert open_result(tmp_path / "killed.nc").identical(open_result(tmp_path / "once.nc"))
    assert everything(tmp_path) == ["found.csv", "killed.nc", "once.nc", "prior.nc"]
