"""Sensitivity indices in closed form: a product, Shapley effects, rates and events of a life."""

from functools import cache

import numpy as np
from scipy import stats
from scipy.integrate import quad

from benchmarks.coverage.indices import LAWS
from benchmarks.coverage.problems import ISHIGAMI, SLOWEST, indices_of, repeated, study_of
from benchmarks.coverage.tally import Tally

WEIGHTS = (0.0, 1.0, 4.5, 9.0, 99.0)
"""Of the g-function's first five inputs; the last three are as the fifth."""


def g_function(repetitions):
    """Count the Sobol' indices of the g-function with eight inputs."""
    laws = {f"x{i}": {"distribution": "uniform", "lower": 0.0, "upper": 1.0} for i in range(1, 9)}
    study = study_of("saltelli", 64, 8, "g-function", laws)
    tally = Tally("g-function, saltelli, 8 replicates of 64 groups of 10 rows", REASONS)
    truth = _of_g_function()
    for ds in repeated(study, repetitions):
        entry = indices_of(ds).get("y")  # its ranks instead, where its tail looks too heavy
        for kind, values in truth.items():
            for name, value in values.items():
                tally.entry(f"{kind} {name}", value, entry and entry[kind][name])
    return tally.lines()


def _of_g_function():
    parts = 1 / (3 * (1 + np.array([*WEIGHTS, *WEIGHTS[-1:] * 3])) ** 2)
    product = np.prod(1 + parts)
    names = [f"x{i}" for i in range(1, len(WEIGHTS) + 1)]
    first = parts / (product - 1)
    total = first * product / (1 + parts)
    return {
        kind: dict(zip(names, values.tolist(), strict=False))
        for kind, values in (("S1", first), ("ST", total))
    }


ISHIGAMI_SHAPLEY = {name: (ISHIGAMI["S1"][name] + ISHIGAMI["ST"][name]) / 2 for name in LAWS}
"""Its interactions are of pairs, which share them equally."""


def shapley(repetitions):
    """Count the Shapley effects of Ishigami's function."""
    study = study_of("shapley", 512, model="ishigami", laws=LAWS)
    tally = Tally("Ishigami, shapley, 512 paths of 4 rows", REASONS)
    for ds in repeated(study, repetitions):
        entry = indices_of(ds)["y"]
        for name, value in ISHIGAMI_SHAPLEY.items():
            tally.entry(f"shapley {name}", value, entry["shapley"][name])
    return tally.lines()


SOONER = 1.0
"""The time of the event: the life is shorter where the rate is larger than its inverse."""


def of_a_life(repetitions):
    """Count the Sobol' indices of lives: logarithm, rank, rate and P(T < t)."""
    rates = ("r1", "r2", "r3")
    study = study_of(
        "saltelli",
        128,
        8,
        laws=dict.fromkeys(rates, {"distribution": "exponential", "mean": 1.0}),
        analysis={"outputs": ["never"], "thresholds": {"never": SOONER}},
    )
    tally = Tally(
        "life that may never end, saltelli, 8 replicates of 128 groups of 5 rows", REASONS
    )
    for ds in repeated(study, repetitions):
        outputs = indices_of(ds, output=list(life_truths()))
        for name, truth in life_truths().items():
            for kind, value in truth.items():
                for rate in rates:
                    tally.entry(f"{name}: {kind} {rate}", value, outputs[name][kind][rate])
    return tally.lines()


@cache
def life_truths():
    """Return first and total index of each of the three equal inputs, for four targets.

    Returns
    -------
    dict
        Name of the target -> ``S1`` and ``ST``. The rate is the sum of three exponential laws of
        mean 1 and counts as 0 below `SLOWEST`; the others of one input sum up to a gamma law of
        shape 2. Of the logarithm and of the rank by the midpoint rule.
    """
    mean = 3 * stats.gamma.sf(SLOWEST, 4)
    variance = 12 * stats.gamma.sf(SLOWEST, 5) - mean**2

    def rate_given_one(x):
        a = max(SLOWEST - x, 0.0)
        return np.exp(-a) * (x * (1 + a) + a**2 + 2 * a + 2)

    def rate_given_others(s):
        a = max(SLOWEST - s, 0.0)
        return np.exp(-a) * (s + a + 1)

    edge = 1 / SOONER
    share = stats.gamma.sf(edge, 3)

    def rank(r):  # those that never end tie
        return np.where(r > SLOWEST, stats.gamma.sf(r, 3), (1 + stats.gamma.sf(SLOWEST, 3)) / 2)

    return {
        "log(life)": _by_midpoints(lambda r: -np.log(r)),
        "rank(never)": _by_midpoints(rank),
        "rate(never)": _first_and_total(rate_given_one, rate_given_others, mean, variance, SLOWEST),
        f"P(never<{SOONER!r})": _first_and_total(
            lambda x: stats.gamma.sf(edge - x, 2),
            lambda s: stats.expon.sf(edge - s),
            share,
            share * (1 - share),
            edge,
        ),
    }


def _by_midpoints(value, points=2000):
    middle = (np.arange(points) + 0.5) / points
    values, others = stats.expon.ppf(middle), stats.gamma.ppf(middle, 2)
    y = value(values[:, None] + others)
    first, rest = (float(y.mean(axis=axis).var() / y.var()) for axis in (1, 0))
    return {"S1": first, "ST": 1 - rest}


def _first_and_total(given_one, given_others, mean, variance, kink):
    def square(expected, law):
        parts = ((0.0, kink), (kink, 60.0))
        return sum(quad(lambda x: expected(x) ** 2 * law.pdf(x), *ends)[0] for ends in parts)

    first = (square(given_one, stats.expon()) - mean**2) / variance
    others = (square(given_others, stats.gamma(2)) - mean**2) / variance
    return {"S1": float(first), "ST": float(1 - others)}


WIDENED = (
    "conservative: the variance rests on fewer than 50 rows of each replicate, so intervals are"
    " widened by the effect of one more such row"
)
REPLICATES = (
    "conservative: the scatter of replicates of 64 groups includes errors of higher order, which"
    " the estimate from all of them has not"
)
REASONS = {"S1 x1": REPLICATES, "rate(never)": WIDENED, f"P(never<{SOONER!r})": WIDENED}
"""Quantity -> why its coverage is not 95 %."""
