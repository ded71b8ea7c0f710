"""Samples of several units and repeats: statistics of all rows, and the shares of the variance.

y = 2 x1 + (1 + x1) x2 + 2 e with x1 shared, x2 own, both uniform on [0, 1], and e uniform on
[-1/2, 1/2], independent from seed to seed; x3 does nothing. In units of 1/12 the variance is
6.25 (shared: of the mean 2.5 x1 + 1/2) + 7/3 (own: (1 + x1)^2 on average) + 4 (chance). The regime
is the upper one where x2 + e exceeds 1.
"""

from itertools import product

import numpy as np
from scipy import stats
from scipy.optimize import brentq

from benchmarks.coverage.fleets import weighted_normals
from benchmarks.coverage.problems import Inputs, Settings, repeated, study_of
from benchmarks.coverage.tally import Tally
from uq.assess.components_by_level import by_level
from uq.assess.summary import summarise
from uq.assess.summary_facts import summary_facts
from uq.contract import Model, Output
from uq.result.result import Result
from uq.stats.variance_components import nested_shares

NAME = "benchmarks.coverage.nested:NESTED"
UNIFORM = {"distribution": "uniform", "lower": 0.0, "upper": 1.0}
LAWS = {"x1": UNIFORM | {"level": "shared"}, "x2": UNIFORM, "x3": UNIFORM}
PARTS = {"shared": 6.25, "own": 7 / 3, "chance": 4.0}
VARIANCE = sum(PARTS.values()) / 12
MEAN, THRESHOLD, RARE, UPPER, ANOTHER = 1.75, 3.0, 4.2, 1 / 8, 1 / 6


def _batch(x, seed, settings):
    x1, x2 = np.ascontiguousarray(x.T)[:2]
    e = (seed >> np.uint64(11)) * 2.0**-53 - 0.5
    y = 2 * x1 + (1 + x1) * x2 + 2 * e
    regime = (x2 + e > 1).astype(np.int8)
    return {"y": y, "regime": regime}, np.zeros(len(x), np.int8)


NESTED = Model(
    "nested",
    "Units that share an input",
    "1",
    Inputs,
    Settings,
    {
        "y": Output("1", "a number"),
        "regime": Output("1", "a regime", "category", categories=("lower", "upper")),
    },
    _batch,
    random=True,
    block=1024,
)


def cdf(y):
    """Return P(Y < y): the law of two uniforms added, averaged over x1."""
    nodes, weights = np.polynomial.legendre.leggauss(200)
    x1 = (nodes + 1) / 2
    wide, z = 1 + x1, y - 2 * x1 + 1
    ramps = [np.maximum(z - shift, 0) ** 2 for shift in (0, wide, 2, wide + 2)]
    given = (ramps[0] - ramps[1] - ramps[2] + ramps[3]) / (4 * wide)
    return float(given @ weights / 2)


def ppf(probability):
    """Return the quantile of Y."""
    return brentq(lambda y: cdf(y) - probability, -1, 5)


SIZES = {
    "monte-carlo": (100, 1, 4, 3),
    "few-samples": (20, 1, 10, 2),
    "many-units": (200, 1, 20, 1),
    "sobol": (64, 8, 4, 2),
}
"""Samples, replicates, units, repeats."""


REASONS = {"sd": "raised by one more sample as extreme as the farthest"}
EXACT = "few effective hits: exact, and conservative"
FEW = {
    "P(": EXACT,
    "regime": EXACT,
    "quantile": "20 samples seldom show how far their ends scatter",
}


def statistics(name, repetitions):
    """Count what `uq summary` and `uq levels` report of a design."""
    samples, replicates, units, repeats = SIZES[name]
    method = name if name == "sobol" else "monte-carlo"
    rows = {"units": units, "repeats": repeats}
    asked = {"thresholds": {"y": [THRESHOLD, RARE]}, "outputs": ["y"]}
    study = study_of(method, samples, replicates, NAME, LAWS, design=rows, analysis=asked)
    size = f"{samples} samples of {units} units, {repeats} repeats"
    several = f"{replicates} replicates of " * (replicates > 1)
    reasons = REASONS | (FEW | {"shared": WIDENED} if samples < 50 else {})
    tally = Tally(f"random model, {method}, {several}{size}", reasons)
    quantiles = {p: ppf(p) for p in (0.05, 0.5, 0.95)}
    for ds in repeated(study, repetitions):
        _count(tally, ds, quantiles)
    return tally.lines()


def _count(tally, ds, quantiles):
    summary = summary_facts(summarise(Result(ds))).json
    entry = summary["outputs"]["y"]
    tally.entry("mean", MEAN, entry["mean_interval"])
    tally.entry("sd", np.sqrt(VARIANCE), entry["sd_interval"])
    for p, truth in quantiles.items():
        tally.entry(f"quantile {p}", truth, entry["quantiles"][repr(p)])
    for threshold in (THRESHOLD, RARE):
        side = entry["thresholds"][repr(threshold)]["above"]
        tally.entry(f"P(> {threshold})", 1 - cdf(threshold), side)
    tally.entry("regime", UPPER, summary["regime"]["upper"])
    levels = by_level(Result(ds))
    for level, part in PARTS.items():
        share = levels.outputs["y"].shares[level]
        if not share.reason and not share.assumes:
            tally.estimate(level, part / 12 / VARIANCE, share)
    if levels.repeats > 1:
        tally.estimate("another regime", ANOTHER, levels.another_regime)


def _lognormal(rng, size):
    law = stats.lognorm(0.75)
    return law.rvs(size, random_state=rng) / law.std()


EFFECTS = {
    "normal": lambda rng, size: rng.standard_normal(size),
    "exponential": lambda rng, size: rng.standard_exponential(size),
    "student": lambda rng, size: rng.standard_t(6, size) / 1.5**0.5,
    "lognormal": _lognormal,
    "two-values": lambda rng, size: 2.5 * (rng.random(size) < 0.2),
}
"""Laws of effects with variance 1; Student's has 6 degrees of freedom, lognormal a sigma of 0.75,
and of two values one has 20 %."""

SHARES = ((0.3, 0.4, 0.3), (0.8, 0.1, 0.1), (0.05, 0.15, 0.8))
SIZES_OF_EFFECTS = ((20, 5, 3), (100, 2, 2), (200, 4, 3))


def effects(name, repetitions):
    """Count the shares of nested random effects of one law, small samples among them."""
    draw, lines = EFFECTS[name], []
    for samples, units, repeats in SIZES_OF_EFFECTS:
        tally = Tally(
            f"random effects ({name}), {samples} samples of {units} units, {repeats} repeats",
            _reasons(name, samples),
        )
        rng = np.random.default_rng(0)
        for _ in range(repetitions):
            for truth in SHARES:
                y = _drawn(draw, rng, truth, (samples, units, repeats))
                estimates = nested_shares(y)
                for level, share, estimate in zip(PARTS, truth, estimates[:3], strict=True):
                    tally.estimate(f"{level}, {share:g}", share, estimate)
        lines += tally.lines()
    return lines


KNOWN = ((0.0, 1.0, 0.0), (0.3, 0.3, 0.3), (3.0, 0.0, 0.0))
"""Variances of shared, own and chance that are integrated, beside those of normal effects."""


def integrated(repetitions):
    """Count the shares of normal effects of which parts are known exactly."""
    lines = []
    for samples, units, repeats in SIZES_OF_EFFECTS:
        size = f"{samples} samples of {units} units, {repeats} repeats"
        reasons = {"": WIDENED} if samples < 100 else {}
        tally = Tally(f"random effects (normal) beside known ones, {size}", reasons)
        rng = np.random.default_rng(0)
        for _ in range(repetitions):
            for rest, exact in product(SHARES, KNOWN):
                y = _drawn(EFFECTS["normal"], rng, rest, (samples, units, repeats))
                added = np.broadcast_to(np.reshape(exact, (3, 1, 1, 1)), (3, *y.shape))
                truth = np.add(rest, exact) / (1 + sum(exact))
                estimates = nested_shares(y, analytic=added)
                for level, share, estimate in zip(PARTS, truth, estimates[:3], strict=True):
                    part = sum(exact) / (1 + sum(exact))
                    tally.estimate(f"{level}, {share:.3g}, {part:.0%} known", share, estimate)
        lines += tally.lines()
    return lines


def weighted(repetitions):
    """Count the shares of normal effects in samples that weights make standard normal."""
    lines = []
    for samples, units, repeats in SIZES_OF_EFFECTS[1:]:
        tally = Tally(
            f"random effects (normal), {samples} weighted samples of {units} units,"
            f" {repeats} repeats"
        )
        rng = np.random.default_rng(0)
        for _ in range(repetitions):
            for truth in SHARES:
                outer, weights = weighted_normals(samples, rng)
                y = _drawn(EFFECTS["normal"], rng, (0.0, *truth[1:]), (samples, units, repeats))
                y = y + truth[0] ** 0.5 * outer[:, None, None]
                estimates = nested_shares(y, weights=weights)
                for level, share, estimate in zip(PARTS, truth, estimates[:3], strict=True):
                    tally.estimate(f"{level}, {share:g}", share, estimate)
        lines += tally.lines()
    return lines


def _drawn(draw, rng, variances, shape):
    shapes = ((shape[0], 1, 1), (*shape[:2], 1), shape)
    return sum(v**0.5 * draw(rng, size) for v, size in zip(variances, shapes, strict=True))


HEAVY = "few samples of effects with a heavy tail hold too few of the largest"
WIDENED = "few samples: widened for one more influential than all seen"


def _reasons(name, samples):
    if name == "lognormal" or (name == "exponential" and samples < 100):
        return {"": HEAVY}
    return {"": WIDENED} if samples < 100 else {}
