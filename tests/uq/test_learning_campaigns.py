"""Synthetic campaigns on the beam: 20 rods, two outages, a detection limit."""

import time
from pathlib import Path

import numpy as np
import pytest

import uq
from uq.learning.inspections import Inspection, Kind
from uq.learning.over_shared import over_shared
from uq.learning.posterior import posterior
from uq.learning.result import as_result
from uq.learning.worn_depth import WornDepths
from uq.literals import read_toml, toml
from uq.rows.elements import lifetimes

RODS, WORLDS, CAMPAIGNS, CV, LIMIT, MOST = 20, 300, 200, 0.15, 3e-5, 1.5e-4
STUDY = Path(__file__).parents[2] / "studies" / "beam-lifetime.toml"


@pytest.fixture(scope="module")
def worlds(tmp_path_factory):
    """Return the shipped study with a shared wear coefficient and 20 rods in each sample."""
    tables = read_toml(STUDY.read_text())
    tables["design"] = {"method": "monte-carlo", "samples": WORLDS, "units": RODS, "seed": 2026}
    tables["uncertain"]["wear_coefficient"]["level"] = "shared"
    tables["settings"] = {"depths": [3e-5, 6e-5, 1e-4, 1.5e-4, 2.5e-4], "accuracy": 0.05}
    tables["analysis"] = {"outputs": ["first_time_to_depth"]}
    folder = tmp_path_factory.mktemp("campaigns")
    path = folder / "rods.toml"
    path.write_text("\n".join(f"{name} = {toml(value)}" for name, value in tables.items()))
    return uq.run(path, folder / "rods.nc")


def campaign(truth, rng):
    """Return what two outages find on the rods of a world, and when they are."""
    lives = truth["first_time_to_depth"].values
    worn = WornDepths(truth["depth"].values, lives)
    median = np.median(lives[:, 2])
    times = 0.4 * median, 0.9 * median
    error = np.log1p(CV**2) ** 0.5
    found = []
    for at in times:
        depth = worn.at(np.full((RODS, 1), at))[:, 0] * np.exp(error * rng.standard_normal(RODS))
        for rod, seen in enumerate(depth):
            if seen < LIMIT:
                found.append(Inspection(f"{rod}", "depth", Kind.BELOW, at, LIMIT, cv=CV))
            elif seen > MOST:
                found.append(Inspection(f"{rod}", "depth", Kind.ABOVE, at, MOST, cv=CV))
            else:
                found.append(Inspection(f"{rod}", "depth", Kind.MEASURED, at, float(seen), cv=CV))
    return found, times[-1]


def quantiles(values, weights):
    order = np.argsort(values)
    share = np.cumsum(weights[order]) / weights.sum()
    return np.interp([0.025, 0.975], share, values[order])


def covered(worlds, count):
    """Return how often intervals hold the truth, how often none is given, and the longest time.

    Of the coefficient, of the probability that a rod never inspected ends within twice the time of
    the last outage, and of the remaining life of each rod that runs then.
    """
    rng = np.random.default_rng(1)
    coefficient, ended, rods, longest, refused = [], [], [], 0.0, 0
    of_rows = worlds["wear_coefficient"].values
    everywhere = np.sort(worlds["first_time_to_depth"].values[:, -1] * of_rows)
    for number in np.unique(worlds["world"].values)[:count]:
        there = worlds["world"].values == number
        truth, rows = worlds.isel(sample=there), worlds.isel(sample=~there)
        found, last = campaign(truth, rng)
        start = time.process_time()
        learnt = posterior(rows, found)
        longest = max(longest, time.process_time() - start)
        if any(one.refusal for one in learnt.weights):
            refused += 1
            continue
        everyone = learnt.any_unit
        true = of_rows[there][0]
        low, high = quantiles(everyone.scale, everyone.weights.weights)
        coefficient.append(low <= true <= high)
        after = as_result(rows, learnt, found, 0.0)
        life = lifetimes(after, "first_time_to_depth")[-1]
        low, high = over_shared(after, life, 0.0, 2 * last).values()
        share = np.searchsorted(everywhere, 2 * last * true) / len(everywhere)
        ended.append(low <= share <= high)
        lives = rows["first_time_to_depth"].values[:, -1] * rows["wear_coefficient"].values
        for rod, life in enumerate(truth["first_time_to_depth"].values[:, -1]):
            unit = learnt.units[str(rod)]
            own = lives[unit.rows] / unit.scale
            runs = own > last
            if life > last and unit.weights.weights[runs].sum() > 0:
                low, high = quantiles(own[runs], unit.weights.weights[runs])
                rods.append(low <= life <= high)
    return np.mean(coefficient), np.mean(ended), np.mean(rods), refused / count, longest


@pytest.mark.slow
def test_intervals_hold_the_truth(worlds):
    coefficient, ended, rods, refused, longest = covered(worlds, CAMPAIGNS)
    assert 0.90 <= coefficient <= 0.99
    assert 0.90 <= ended <= 0.99
    assert 0.90 <= rods <= 0.99
    assert refused < 0.25
    assert longest < 5.0
