"""Posteriors hold the truth as often as they say, and agree with a sampler that runs the model."""

import numpy as np
import pytest
from computed import computed, study_of
from learnt_studies import DEPTH, RATE, exactly, lognormal, measured, wear
from scipy import stats

from models.analytic import EXPONENTIAL_WEAR
from uq.result.result import Result
from uq.learning.inspections import read_tables
from uq.learning.posterior import posterior
from uq.study.evaluate import evaluate

REPETITIONS = 200
UNITS = "ABC"


def with_threshold(samples, seed):
    """Return lives in two regimes: rates below a threshold do not wear."""
    return computed(
        study_of(
            {
                "study": {"name": "regimes", "model": "exponential-wear"},
                "design": {"method": "monte-carlo", "samples": samples, "seed": seed},
                "uncertain": {
                    "rate": lognormal(*RATE),
                    "threshold": lognormal(2e-10, 0.5),
                    "depth": lognormal(*DEPTH),
                },
            }
        )
    )


def one_life(truth, rng):
    """Return a life measured with error, or seen to survive."""
    life = float(truth["life"][0])
    if life < 4e6:
        return measured(life * np.exp(np.log1p(0.3**2) ** 0.5 * rng.standard_normal()), cv=0.3)
    return [{"unit": "A", "output": "life", "kind": "survived", "time": 4e6}]


def censored_lives(truth, rng):
    """Return units seen running or ended at a time each."""
    times = (5e5, 8e5, 1.4e6)
    return [
        {"unit": unit, "output": "life", "kind": "ended" if life <= t else "survived", "time": t}
        for unit, life, t in zip(UNITS, truth["life"].values, times, strict=True)
    ]


def shared_lives(truth, rng):
    """Return the measured lives of three units of a world."""
    noise = np.exp(np.log1p(0.2**2) ** 0.5 * rng.standard_normal(3))
    return measured(*(truth["life"].values * noise), cv=0.2)


PROBLEMS = {
    "two regimes": (lambda n, seed: with_threshold(n, seed), one_life, ("rate", "threshold")),
    "censored": (
        lambda n, seed: wear(n // 3, seed, rate="shared", units=3),
        censored_lives,
        ("rate", "depth"),
    ),
    "shared scale": (
        lambda n, seed: wear(n // 3, seed, depth="shared", units=3),
        shared_lives,
        ("rate", "depth"),
    ),
}


@pytest.mark.slow
@pytest.mark.parametrize("problem", PROBLEMS)
def test_ranks_of_the_truth_are_uniform(problem):
    """Simulation-based calibration (Talts et al. 2018): a Kolmogorov-Smirnov test at 1 %."""
    make, inspect, names = PROBLEMS[problem]
    rows, truths = make(12_000, 1), make(3 * REPETITIONS, 2)
    world = truths["world"].values if "world" in truths else np.arange(truths.sizes["sample"])
    rng = np.random.default_rng(5)
    ranks = {name: [] for name in names}
    for number in np.unique(world)[:REPETITIONS]:
        truth = truths.isel(sample=world == number)
        found = posterior(Result(rows), read_tables(inspect(truth, rng)))
        unit = found.units["A"]
        for name in names:
            drawn = rows[name].values[unit.rows]
            if found.scale is not None and found.scale.name == name:
                drawn = unit.scale
            below = np.average(drawn < float(truth[name][0]), weights=unit.weights.weights)
            ranks[name].append(below)
    for name, found in ranks.items():
        assert stats.kstest(found, "uniform").pvalue > 0.01, name


@pytest.fixture(scope="module")
def worlds():
    return wear(20_000, 4, rate="shared", units=3)


@pytest.mark.slow
def test_it_agrees_with_a_random_walk_that_runs_the_model(worlds):
    lives = np.array([6e5, 1e6, 1.2e6])
    found = posterior(Result(worlds), read_tables(measured(*lives)))
    assert_agrees(worlds, found, random_walks(lives))


@pytest.mark.slow
def test_it_agrees_with_openturns(worlds):
    """Its random walks in the physical inputs, with its laws and its likelihood."""
    ot = pytest.importorskip("openturns")
    lives, error = [6e5, 1e6, 1.2e6], np.log1p(0.2**2) ** 0.5
    laws = [ot.LogNormal(np.log(median), sigma) for median, sigma in (RATE, DEPTH, DEPTH, DEPTH)]
    of_unit = "is_1 * depth_1 + is_2 * depth_2 + is_3 * depth_3"
    names = ["is_1", "is_2", "is_3", "rate", "depth_1", "depth_2", "depth_3"]
    link = ot.SymbolicFunction(names, [f"log(({of_unit}) / rate)", f"{error}", "0"])
    mean, cov = exactly(lives, cv=0.2, shared_rate=True)
    middle = np.exp(mean)
    step = 1.2**2 * cov * np.outer(middle, middle)
    moves = ot.Normal([0.0] * 4, ot.CovarianceMatrix(step.tolist()))
    one_hot = ot.ParametricFunction(link, [0, 1, 2], [0.0] * 3)
    seen = ot.Sample([[life] for life in lives])
    ot.RandomGenerator.SetSeed(1)
    walks = []
    for _ in range(20):
        chain = ot.RandomWalkMetropolisHastings(ot.JointDistribution(laws), list(middle), moves)
        chain.setLikelihood(ot.LogNormal(), seen, one_hot, ot.Sample(np.eye(3).tolist()))
        walks.append(np.log(np.asarray(chain.getSample(8_000))[500:]))
    found = posterior(Result(worlds), read_tables(measured(*lives, cv=0.2)))
    assert_agrees(worlds, found, np.stack(walks))


def assert_agrees(worlds, found, walks):
    """Compare logarithms with walks (walk, step, rate and depths) within 5 % of their scatter.

    The error of the walks themselves, from the scatter between them, is below 2 %.
    """
    means, sds = walks.mean(axis=(0, 1)), walks.std(axis=(0, 1))
    of_mean = walks.mean(axis=1).std(axis=0, ddof=1) / len(walks) ** 0.5
    squares = ((walks - means) ** 2).mean(axis=1)
    of_variance = squares.std(axis=0, ddof=1) / len(walks) ** 0.5
    assert (of_mean < 0.02 * sds).all() and (of_variance < 2 * 0.02 * sds**2).all()
    for column, name, one in (
        (0, "rate", found.any_unit),
        (1, "depth", found.units["A"]),
        (3, "depth", found.units["C"]),
    ):
        integrated = found.scale is not None and found.scale.name == name
        logs = np.log(one.scale if integrated else worlds[name].values[one.rows])
        mean = np.average(logs, weights=one.weights.weights)
        sd = np.average((logs - mean) ** 2, weights=one.weights.weights) ** 0.5
        assert abs(mean - means[column]) < 0.05 * sds[column]
        assert sd == pytest.approx(sds[column], rel=0.05)


def random_walks(lives, count=200, steps=1500, dropped=200):
    """Return Metropolis walks (log rate, log depths), the model run anew at each step."""
    rng = np.random.default_rng(6)
    middle = np.log([RATE[0], *[DEPTH[0]] * 3])
    spread = np.array([RATE[1], *[DEPTH[1]] * 3])
    error = np.log1p(0.1**2) ** 0.5
    usual = EXPONENTIAL_WEAR.nominal

    def log_density(states):
        rate, depth = np.exp(np.repeat(states[:, 0], 3)), np.exp(states[:, 1:].ravel())
        columns = usual | {"rate": rate, "depth": depth}
        x = np.stack(np.broadcast_arrays(*columns.values()), axis=1)
        seeds = np.zeros(len(x), np.uint64)
        rows = evaluate(EXPONENTIAL_WEAR, EXPONENTIAL_WEAR.settings(), x, seeds)
        life = rows.columns["life"].reshape(count, 3)
        off = np.log(lives / life) / error
        return -0.5 * ((((states - middle) / spread) ** 2).sum(axis=1) + (off**2).sum(axis=1))

    _, cov = exactly(lives, shared_rate=True)
    here = np.tile(middle, (count, 1))
    density = log_density(here)
    found = np.empty((count, steps, 4))
    for step in range(steps):
        there = here + rng.multivariate_normal(np.zeros(4), 1.2**2 * cov, count)
        new = log_density(there)
        moved = np.log(rng.random(count)) < new - density
        here[moved], density[moved] = there[moved], new[moved]
        found[:, step] = here
    return found[:, dropped:]
