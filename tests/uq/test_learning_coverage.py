"""Intervals of what is read from a posterior hold the closed form as often as they say."""

from collections import defaultdict

import numpy as np
import pytest
from learnt_studies import DEPTH, exactly, measured, wear
from scipy import stats

from uq.result.result import Result
from uq.errors import RunError
from uq.explore.updating import update
from uq.learning.posterior_inputs import inputs_learnt
from uq.learning.remaining_life import ANY, remaining

REPETITIONS = 1000
SHARED = [6e5, 1e6, 1.2e6]


def own_rows(seed):
    return update(wear(samples=1000, seed=seed), measured(5e5))


def worlds(seed):
    return update(wear(samples=600, seed=seed, rate="shared", units=3), measured(*SHARED, cv=0.3))


def new_rows(seed):
    return update(wear(samples=3000, seed=seed), measured(2e7, cv=0.05), rows=20_000, workers=0)


def of_one_unit(life, cv):
    """Return the laws of rate and life of the inspected unit."""
    mean, cov = exactly([life], cv=cv)
    of_life = [-1.0, 1.0] @ cov @ [-1.0, 1.0]
    return (
        stats.lognorm(cov[0, 0] ** 0.5, scale=np.exp(mean[0])),
        "rate[unit=A]",
        stats.lognorm(of_life**0.5, scale=np.exp(mean[1] - mean[0])),
        "A",
    )


def of_any_unit():
    """Return the laws of the shared rate, and of the life of a unit that was not inspected."""
    mean, cov = exactly(SHARED, cv=0.3, shared_rate=True)
    of_life = (cov[0, 0] + DEPTH[1] ** 2) ** 0.5
    median = DEPTH[0] / np.exp(mean[0])
    return (
        stats.lognorm(cov[0, 0] ** 0.5, scale=np.exp(mean[0])),
        "rate",
        stats.lognorm(of_life, scale=median),
        ANY,
    )


def of_unit_in_a_world():
    """Return the laws of depth and life of an inspected unit whose rate is that of all units."""
    mean, cov = exactly(SHARED, cv=0.3, shared_rate=True)
    of_life = cov[0, 0] - 2 * cov[0, 1] + cov[1, 1]
    return (
        stats.lognorm(cov[1, 1] ** 0.5, scale=np.exp(mean[1])),
        "depth[unit=A]",
        stats.lognorm(of_life**0.5, scale=np.exp(mean[1] - mean[0])),
        "A",
    )


CASES = {
    "own rows": (own_rows, [of_one_unit(5e5, 0.1)]),
    "worlds": (worlds, [of_any_unit(), of_unit_in_a_world()]),
    "new rows": (new_rows, [of_one_unit(2e7, 0.05)]),
}


def held_by(ds, rate, name, life, unit):
    """Yield what has an interval in a posterior, and whether that holds the closed form."""
    time = life.ppf(0.2)
    after = next(one for one in inputs_learnt(Result(ds)) if one.name == name).posterior
    left = next(one for one in remaining(Result(ds), [time]) if one.unit == unit)
    for what, found, exact in (
        ("mean", after.mean, rate.mean()),
        ("sd", after.sd, rate.std()),
        ("by", left.by[time], 0.2),
        ("median", left.life[0.5], life.ppf(0.5)),
    ):
        if found.has_interval:
            yield (name, what), found.low <= exact <= found.high


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_intervals_hold_the_closed_form(case):
    """Mean and standard deviation of an input, P(T < t), and the median of the remaining life."""
    make, known = CASES[case]
    held = defaultdict(list)
    for seed in range(REPETITIONS):
        try:
            ds = make(seed)
        except RunError:
            continue
        for what, is_held in (one for exact in known for one in held_by(ds, *exact)):
            held[what].append(is_held)
    assert len(held) == 4 * len(known)
    for (name, what), those in held.items():
        assert len(those) > 0.85 * REPETITIONS, (name, what)  # others have a reason
        # Eight repetitions show their scatter roughly.
        cautious = case == "new rows" and what in ("by", "median")
        assert 0.93 <= np.mean(those) <= (0.995 if cautious else 0.97), (name, what)
