"""Sensitivity: Sobol' indices, effects of Morris, and the null of methods without intervals."""

from itertools import product

import numpy as np
import openturns as ot
from SALib.analyze import delta as salib_delta
from SALib.analyze import fast as salib_fast
from SALib.analyze import morris as salib_morris
from SALib.analyze import rbd_fast as salib_rbd_fast
from SALib.analyze import sobol as salib_sobol
from SALib.sample import fast_sampler
from SALib.sample import morris as salib_trajectories
from SALib.sample import sobol as salib_design
from scipy import stats

from benchmarks.coverage.problems import (
    ISHIGAMI,
    ISHIGAMI_LAW,
    indices_of,
    jump,
    repeated,
    study_of,
)
from benchmarks.coverage.tally import Tally
from uq.sampling.unit_cube import LEVELS, STEP, TAIL

NAMES = ("x1", "x2", "x3")
LAWS = dict.fromkeys(NAMES, ISHIGAMI_LAW)
PROBLEM = {"num_vars": 3, "names": list(NAMES), "bounds": [[-np.pi, np.pi]] * 3}


def ishigami(x):
    """Evaluate Ishigami's function at points (n, 3)."""
    a, b, c = x.T
    return np.sin(a) + 7 * np.sin(b) ** 2 + 0.1 * c**4 * np.sin(a)


def sobol(repetitions):
    """Count the Sobol' indices of Ishigami's function, second order included."""
    study = study_of("saltelli", 128, 8, "ishigami", LAWS, second_order=True)
    tally = Tally("Ishigami, saltelli, 8 replicates of 128 groups of 8 rows", REASONS)
    for ds in repeated(study, repetitions):
        entry = indices_of(ds)["y"]
        _indices(tally, entry, ISHIGAMI)
    return tally.lines()


def sobol_of_jump(repetitions):
    """Count the Sobol' indices of a function that jumps, and of its regime."""
    laws = {name: {"distribution": "uniform", "lower": 0.0, "upper": 1.0} for name in NAMES}
    study = study_of("saltelli", 128, 8, laws=laws, analysis={"outputs": ["jump", "regime"]})
    tally = Tally("two regimes, saltelli, 8 replicates of 128 groups of 5 rows", REASONS)
    truth = {kind: jump()[kind] for kind in ("S1", "ST")}
    for ds in repeated(study, repetitions):
        _indices(tally, indices_of(ds, output="jump")["jump"], truth)
        event = indices_of(ds, output="P(regime=upper)")["P(regime=upper)"]
        _indices(tally, event, jump()["event"], "regime: ", skip="x3")
    return tally.lines()


def _indices(tally, entry, truth, prefix="", skip=""):
    for kind, values in truth.items():
        for label, value in values.items():
            if label != skip:
                tally.entry(f"{prefix}{kind} {label}", value, entry[kind][label])


def sobol_of_others(repetitions):
    """Count what SALib and OpenTURNS print for as many rows, by bootstrap."""
    tally = Tally("Ishigami, saltelli, 8 replicates of 128 groups of 8 rows")
    pairs = [(i, j) for i in range(3) for j in range(i + 1, 3)]
    for seed in range(repetitions):
        x = salib_design.sample(PROBLEM, 1024, calc_second_order=True, scramble=True, seed=seed)
        reported = salib_sobol.analyze(PROBLEM, ishigami(x), True, num_resamples=100, seed=seed + 1)
        by = "SALib, bootstrap of one scramble"
        for kind in ("S1", "ST"):
            _halves(tally, kind, reported[kind], reported[f"{kind}_conf"], by)
        for i, j in pairs:
            value, half = reported["S2"][i, j], reported["S2_conf"][i, j]
            pair = f"{NAMES[i]},{NAMES[j]}"
            tally.add(f"S2 {pair}", ISHIGAMI["S2"][pair], value - half, value + half, by)
        ot.RandomGenerator.SetSeed(seed)
        law = ot.JointDistribution([ot.Uniform(-np.pi, np.pi)] * 3)
        points = ot.SobolIndicesExperiment(law, 1638, False).generate()  # as many rows
        y = ot.Sample(ishigami(np.array(points))[:, None])
        algorithm = ot.SaltelliSensitivityAlgorithm(points, y, 1638)
        for how, asymptotic in (("bootstrap", False), ("asymptotic", True)):
            algorithm.setUseAsymptoticDistribution(asymptotic)
            for kind, interval in (
                ("S1", algorithm.getFirstOrderIndicesInterval()),
                ("ST", algorithm.getTotalOrderIndicesInterval()),
            ):
                low, high = interval.getLowerBound(), interval.getUpperBound()
                for i, name in enumerate(NAMES):
                    by = f"OpenTURNS, {how}, independent rows"
                    tally.add(f"{kind} {name}", ISHIGAMI[kind][name], low[i], high[i], by)
    return tally.lines()


def sobol_of_scipy(repetitions):
    """Count what scipy prints for as many rows, by bootstrap."""
    tally = Tally("Ishigami, saltelli, 8 replicates of 128 groups of 8 rows")
    uniform = [stats.uniform(-np.pi, 2 * np.pi)] * 3
    for seed in range(repetitions):
        reported = stats.sobol_indices(
            func=lambda x: ishigami(x.T)[None], n=1024, dists=uniform, rng=seed
        )
        band = reported.bootstrap(n_resamples=200)
        for kind, index in (("S1", band.first_order), ("ST", band.total_order)):
            for i, name in enumerate(NAMES):
                ends = (
                    np.ravel(index.confidence_interval.low)[i],
                    np.ravel(index.confidence_interval.high)[i],
                )
                tally.add(f"{kind} {name}", ISHIGAMI[kind][name], *ends, "scipy, bootstrap")
    return tally.lines()


def _halves(tally, kind, values, halves, by, truth=None, skip=""):
    for name, value, half in zip(NAMES, values, halves, strict=True):
        expected = (truth or ISHIGAMI[kind])[name]
        if name != skip:
            tally.add(f"{kind} {name}", expected, value - half, value + half, by)


# Morris -------------------------------------------------------------------------------------------


def exact_effects(levels, step):
    """Return mu, sigma and mu* of Ishigami's function over all steps that the levels allow."""
    starts = np.array(list(product(levels, repeat=3)))
    measures = {}
    for i, name in enumerate(NAMES):
        below = starts[np.isin(starts[:, i], levels[: LEVELS // 2])]
        above = below.copy()
        above[:, i] += step
        effects = np.diff([ishigami(2 * np.pi * u - np.pi) for u in (below, above)], axis=0) / step
        measures[name] = {
            "mu": effects.mean(),
            "sigma": effects.std(),
            "mu_star": np.abs(effects).mean(),
        }
    return measures


def morris(repetitions):
    """Count the measures of Morris' method; SALib's from as many trajectories."""
    study = study_of("morris", 16, 8, "ishigami", LAWS)
    tally = Tally("Ishigami, morris, 8 replicates of 16 trajectories of 4 rows", REASONS)
    grid = np.arange(LEVELS) / (LEVELS - 1)
    truth = exact_effects(TAIL + (1 - 2 * TAIL) * grid, STEP)
    theirs = exact_effects(grid, LEVELS / (2 * (LEVELS - 1)))
    for seed, ds in enumerate(repeated(study, repetitions)):
        entry = indices_of(ds)["y"]
        for name, kinds in truth.items():
            for kind, value in kinds.items():
                if name != "x2" or kind == "sigma":  # its steps are all as large: no interval
                    tally.entry(f"{kind} {name}", value, entry[kind][name])
        x = salib_trajectories.sample(PROBLEM, 128, LEVELS, seed=seed)
        reported = salib_morris.analyze(PROBLEM, x, ishigami(x), num_resamples=100, seed=seed + 1)
        stars = {name: kinds["mu_star"] for name, kinds in theirs.items()}
        _halves(
            tally, "mu_star", reported["mu_star"], reported["mu_star_conf"], "SALib", stars, "x2"
        )
    return tally.lines()


# Methods without intervals ------------------------------------------------------------------------

DELTA = {"x1": 0.256, "x2": 0.424, "x3": 0.207}
"""By histograms of a grid of 700 points in each input."""


def bootstraps(repetitions):
    """Count the intervals that SALib reports for indices without an interval in our tables."""
    rows = "Ishigami, 1024 rows; no interval of ours"
    tally = Tally(rows)
    for seed in range(repetitions):
        rng = np.random.default_rng(seed)
        x = rng.uniform(-np.pi, np.pi, (1024, 3))
        y = ishigami(x)
        reported = salib_rbd_fast.analyze(PROBLEM, x, y, num_resamples=100, seed=seed + 1)
        _halves(tally, "S1", reported["S1"], reported["S1_conf"], "SALib rbd_fast")
        reported = salib_delta.analyze(
            PROBLEM, x, y, num_resamples=20, method="delta", seed=seed + 1
        )
        values, halves = reported["delta_raw"], reported["delta_raw_conf"]
        _halves(tally, "delta", values, halves, "SALib delta", DELTA)
        x = fast_sampler.sample(PROBLEM, 341, seed=seed)
        reported = salib_fast.analyze(PROBLEM, ishigami(x), num_resamples=100, seed=seed + 1)
        for kind in ("S1", "ST"):
            _halves(tally, kind, reported[kind], reported[f"{kind}_conf"], "SALib fast")
    return tally.lines()


LIMIT = 2.5


def nulls(method, repetitions):
    """Count how often an input without effect stays below the dummy of the indices."""
    samples = {"hdmr": 1024, "quantile": 512, "hsic-conditional": 512}.get(method, 256)
    laws = dict.fromkeys(("x1", "x2", "x3"), {"distribution": "uniform", "lower": 0, "upper": 1})
    asked = {"outputs": ["jump"], "quantiles": [0.5], "thresholds": {"jump": LIMIT}}
    study = study_of("monte-carlo", samples, laws=laws, analysis=asked)
    tally = Tally(f"input without effect, {samples} independent rows", REASONS)
    event, above = "P(regime=upper)", f"P(jump>{LIMIT!r})"
    output = {"regional": event, "hsic-target": event, "hsic-conditional": above}.get(
        method, "jump"
    )
    for seed, ds in enumerate(repeated(study, repetitions)):
        idle = np.random.default_rng((seed, 1)).random(samples)
        ds = ds.assign(x2=("row", idle, ds["x2"].attrs))
        if method == "hdmr":  # which takes no jumps
            ds["jump"].values[:] = (ds["x1"] + ds["x3"] ** 2 + 0.3 * ds["x1"] * ds["x3"]).values
        entry = indices_of(ds, method, output)[output]
        kind, null = next(iter(entry["dummy"].items()))
        value = entry[kind]["x2"]["value"]
        tally.add(f"{method}: below the dummy of {kind}", value, -np.inf, null)
        if "p" in entry:
            tally.add(f"{method}: p-value above 5 %", entry["p"]["x2"]["value"], 0.05, np.inf)
    return tally.lines()


TWO = (
    "conservative: effects that take two values equally often have the largest possible standard"
    " deviation; the pooled one varies less than those of single replicates"
)
REASONS = {
    "sigma x1": TWO,
    "sigma x2": TWO,
    "hdmr": "the dummy of hdmr is a single input, exceeded in every second case, as stated",
}
