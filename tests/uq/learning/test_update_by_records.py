"""Lives from the field as evidence: posteriors in closed form, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from learnt_studies import DEPTH, RATE, wear
from scipy.stats import norm

import uq as api
from uq.errors import InputError
from uq.explore.updating import update
from uq.files.whole_files import write_result
from uq.result.result import Result

HOUSE = Path(__file__).parents[3]

LIVES = [
    (4.1e5, 4.1e5), (7.3e5, 7.3e5), (0, 5e5), (5e5, 1e6), (5e5, 1e6), (8e5, np.inf), (0, np.inf),
]  # fmt: skip
"""Exact, known within intervals, censored; nothing is known of the last."""


def record(folder, lives=LIVES, name="rods"):
    lines = "".join(f"{low},{high}\n" for low, high in lives)
    (folder / f"{name}.csv").write_text(f"low,high\n{lines}")
    ds = api.import_lives(folder / f"{name}.csv", "life", unit="s", low="low", high="high")
    write_result(ds, folder / f"{name}.nc")
    return folder / f"{name}.nc"


def exactly(scatter, shared, sign):
    """Return mean and sd of the logarithm of what is shared, by quadrature over it."""
    x = np.log(shared[0]) + np.linspace(-6, 6, 4001) * shared[1]
    middle = np.log(scatter[0]) * -sign + sign * x  # of the logarithm of a life
    log_posterior = norm.logpdf(x, np.log(shared[0]), shared[1])
    for low, high in LIVES:
        if low == high:
            log_posterior += norm.logpdf(np.log(low), middle, scatter[1])
            continue
        with np.errstate(divide="ignore"):
            log_posterior += np.log(
                norm.cdf(np.log(high), middle, scatter[1])
                - norm.cdf(np.log(low), middle, scatter[1])
            )
    weights = np.exp(log_posterior - log_posterior.max())
    mean = np.average(x, weights=weights)
    return mean, np.average((x - mean) ** 2, weights=weights) ** 0.5


@pytest.mark.parametrize(
    ("shared", "samples", "units"), [("rate", 800, len(LIVES)), ("depth", 1000, 1)]
)
def test_what_is_shared_is_learnt_from_recorded_lives(folder, shared, samples, units):
    prior = wear(samples=samples, units=units, **{shared: "shared"})
    posterior = update(prior, record(folder))
    law, scatter, sign = (RATE, DEPTH, -1) if shared == "rate" else (DEPTH, RATE, 1)
    mean, sd = exactly(scatter, law, sign)
    x, weights = np.log(posterior[shared].values), posterior["weight"].values
    middle = np.average(x, weights=weights)
    assert middle == pytest.approx(mean, abs=0.15 * sd)
    assert np.average((x - middle) ** 2, weights=weights) ** 0.5 == pytest.approx(sd, rel=0.15)


def test_the_command_updates_with_a_record_once(uq, folder):
    path = record(folder)
    write_result(wear(samples=300, units=len(LIVES), rate="shared"), folder / "prior.nc")
    ended = uq("update", "prior.nc", path.name, "-o", "posterior.nc", "--life", "life")
    assert (ended.code, ended.err) == (0, "")
    ended = uq("update", "posterior.nc", path.name, "-o", "again.nc")
    assert ended.code == 2 and "already used by this result" in ended.err.splitlines()[0]


def refused(*arguments, **options):
    with pytest.raises(InputError) as error:
        update(*arguments, **options)
    (line,) = error.value.lines
    return line


def test_a_record_that_is_no_evidence_is_refused_in_one_line(folder):
    prior = wear(samples=100, rate="shared")
    path = record(folder)
    assert "set [design] units = 6" in refused(prior, path)
    assert "units share no uncertain input" in refused(wear(samples=100), path)
    assert "has no lives from the field" in refused(prior, prior)
    assert "no such output 'rate'" in refused(prior, path, life="rate")
    (folder / "late.csv").write_text("life,entered\n4,1\n5,0\n")
    late = api.import_lives(folder / "late.csv", "life", unit="s", entered="entered")
    assert "rows entered late" in refused(prior, late)
    (folder / "cycles.csv").write_text("life [cycles]\n4\n5\n")
    cycles = api.import_lives(folder / "cycles.csv", "life")
    assert "are in 'cycles', 'life' in 's'" in refused(prior, cycles)
    assert Result(cycles).recorded_life.name == "life"


TUBES = """seen intact [years],seen worn [years]
0,20
10,20
10,20
20,30
20,30
20,
20,
30,
30,
30,
30,
30,
30,
30,
30,
30,
"""
LIFE = "first_time_to_depth[depth=0.000436]"


@pytest.mark.slow
def test_tubes_of_a_plant_are_fitted_compared_and_learnt_from(uq, folder):
    level = {"uncertain.wear_coefficient.level": "shared", "design.samples": 150}
    study = api.load_study(HOUSE / "studies/tube-antivibration-bar.toml").with_changes(level)
    api.run(study, folder / "study.nc", workers=0)
    (folder / "tubes.csv").write_text(TUBES)
    names = ("--life", "tube", "--low", "seen intact", "--high", "seen worn")
    for arguments in (
        ("import", "tubes.csv", "-o", "tubes.nc", *names),
        ("summary", "tubes.nc", "--fits"),
        ("compare", "tubes.nc", "study.nc", "--output", LIFE),
        ("update", "study.nc", "tubes.nc", "-o", "after.nc"),
    ):
        ended = uq(*arguments)
        assert (ended.code, ended.err) == (0, ""), arguments
    before = api.open_result("study.nc")["wear_coefficient"].values
    after = api.open_result("after.nc")
    mean, spread = np.average(after["wear_coefficient"], weights=after["weight"]), before.std()
    off = after["wear_coefficient"].values - mean
    sd = np.average(off**2, weights=after["weight"]) ** 0.5
    assert 8e-15 < mean < 20e-15 and sd < spread / 2
