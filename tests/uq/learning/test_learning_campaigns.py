"""Intervals from synthetic campaigns on the beam hold the truth that the inspections came from."""

import numpy as np
import pytest

from benchmarks.campaigns import apart, campaign, worlds
from uq.learning.posterior import posterior
from uq.learning.posterior_result import as_result
from uq.learning.remaining_life import over_shared
from uq.result.result import Result

CAMPAIGNS = 200


@pytest.fixture(scope="module")
def rods(tmp_path_factory):
    return worlds(tmp_path_factory.mktemp("campaigns"))


def quantiles(values, weights):
    order = np.argsort(values)
    share = np.cumsum(weights[order]) / weights.sum()
    return np.interp([0.025, 0.975], share, values[order])


def covered(rods, count):
    """Return how often intervals hold the truth, and how often none is given.

    Of the coefficient, of the probability that a rod never inspected ends within twice the time of
    the last outage, and of the remaining life of each rod that runs then.
    """
    rng = np.random.default_rng(1)
    coefficient, ended, remaining, refused = [], [], [], 0
    of_rows = rods["wear_coefficient"].values
    everywhere = np.sort(rods["first_time_to_depth"].values[:, -1] * of_rows)
    for number in np.unique(rods["world"].values)[:count]:
        truth, rows = apart(rods, number)
        inspections, last = campaign(truth, rng)
        learnt = posterior(Result(rows), inspections)
        if any(weight.refusal for weight in learnt.weights):
            refused += 1
            continue
        everyone = learnt.any_unit
        true = truth["wear_coefficient"].values[0]
        low, high = quantiles(everyone.scale, everyone.weights.weights)
        coefficient.append(low <= true <= high)
        after = as_result(Result(rows), learnt, inspections, 0.0)
        life = Result(after).lifetimes("first_time_to_depth")[-1]
        low, high = over_shared(Result(after), life, 0.0, 2 * last).values()
        share = np.searchsorted(everywhere, 2 * last * true) / len(everywhere)
        ended.append(low <= share <= high)
        lives = rows["first_time_to_depth"].values[:, -1] * rows["wear_coefficient"].values
        for rod, life in enumerate(truth["first_time_to_depth"].values[:, -1]):
            unit = learnt.units[str(rod)]
            unit_lives = lives[unit.rows] / unit.scale
            runs = unit_lives > last
            if life > last and unit.weights.weights[runs].sum() > 0:
                low, high = quantiles(unit_lives[runs], unit.weights.weights[runs])
                remaining.append(low <= life <= high)
    return np.mean(coefficient), np.mean(ended), np.mean(remaining), refused / count


@pytest.mark.slow
def test_intervals_hold_the_truth(rods):
    coefficient, ended, remaining, refused = covered(rods, CAMPAIGNS)
    assert 0.90 <= coefficient <= 0.99
    assert 0.90 <= ended <= 0.99
    assert 0.90 <= remaining <= 0.99
    assert refused < 0.25
