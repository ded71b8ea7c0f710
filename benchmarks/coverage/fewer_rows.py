"""Twins and rare events."""

from functools import partial

import numpy as np
import openturns as ot
from scipy import stats
from scipy.special import ndtr

from benchmarks.coverage.problems import (
    EDGE,
    ISHIGAMI_MEAN,
    JUMP,
    NAME,
    TAIL_INDEX,
    ishigami_cdf,
    repeated,
    study_of,
)
from benchmarks.coverage.tally import Tally
from uq.assess.two_fidelities import with_twin
from uq.explore.importance_sampling import design_points, drawn_around, wide_search
from uq.explore.rare_events import ESTIMATORS, estimate_of
from uq.explore.subset_simulation import subset_interval, subset_simulation
from uq.result.result import Result
from uq.stats.estimate import NOTHING
from uq.stats.intervals import UNKNOWN, log_scatter_interval

UNIFORMS = {
    name: {"distribution": "uniform", "lower": 0.0, "upper": 1.0} for name in ("x1", "x2", "x3")
}


def twin(repetitions):
    """Count estimates by control variates."""
    analysis = {
        "outputs": ["ishigami"],
        "thresholds": {"ishigami": [9.0]},
        "twin": "near",
    }
    study = study_of("monte-carlo", 300, laws=UNIFORMS, analysis=analysis)
    tally = Tally("Ishigami, 300 independent rows and 30,000 of a cheap twin", REASONS)
    for ds in repeated(study, repetitions):
        estimates = with_twin(Result(ds), NAME).outputs["ishigami"]
        # A sample in a thousand seems to have a tail too heavy for a mean.
        mean = estimates["mean"].estimate if "mean" in estimates else NOTHING
        tally.estimate("mean by the twin", ISHIGAMI_MEAN, mean)
        above = estimates["P(>9.0)"].estimate
        tally.estimate("P(> 9.0) by the twin", 1 - ishigami_cdf(9.0), above)
    return tally.lines()


# Rare events: limits in standard normal space -----------------------------------------------------

RARE = 1e-5


def _plane(u):
    return u.sum(axis=1) / np.sqrt(u.shape[1]) - stats.norm.isf(RARE)


def _jump(u):
    """Beyond a value of the function that jumps: P = h^2/2 at a distance of h from its top."""
    x1, x2, x3 = ndtr(u).T
    return x1 + x3 + JUMP * (x1 + x2 > EDGE) - (2 + JUMP - np.sqrt(2 * RARE / (EDGE_SHARE)))


EDGE_SHARE = 2 - EDGE
"""Share of x2 that lies in the upper regime where x1 is 1, to first order."""


def _life(u):
    """Beyond a life with a heavy tail: the rate is the sum of three exponentials."""
    rate = -np.log(ndtr(u)).sum(axis=1)
    return stats.gamma(TAIL_INDEX).ppf(RARE) - rate


LIMITS = {"plane, 4 inputs": (_plane, 4), "heavy-tailed life, 3 inputs": (_life, 3)}


def subset(repetitions):
    """Count the intervals of subset simulation."""
    lines = []
    for name, (margin, d) in (LIMITS | {"two regimes, 3 inputs": (_jump, 3)}).items():
        tally = Tally(f"P = 1e-5, subset simulation, 8 replicates of 1000 rows: {name}", REASONS)
        truth = _jump_probability() if margin is _jump else RARE
        for seed in range(repetitions):
            replicates = subset_simulation(margin, d, 1000, np.random.default_rng(seed).spawn(8))
            tally.add("probability", truth, *subset_interval(replicates, 1000))
        lines += tally.lines()
    return lines


def _cliff(u):
    """Return a slope of the first input, and a cliff of the second with no slope towards it."""
    return np.where(u[:, 1] < -4.0, 10.0, u[:, 0]) - 5.0


def _island(u):
    """Return the same with a cliff of two inputs."""
    return np.where((u[:, 1] < -3.0) & (u[:, 2] < -2.6), 10.0, u[:, 0]) - 5.0


def _sphere(u):
    """Return a margin that is as near in every direction."""
    return (u**2).sum(axis=1) - stats.chi2.isf(RARE, u.shape[1])


CLIFF = stats.norm.sf(4.0) + stats.norm.sf(5.0)
ISLAND = stats.norm.sf(3.0) * stats.norm.sf(2.6) + stats.norm.sf(5.0)
HIDDEN = {
    "a cliff of one of 2 inputs": (_cliff, 2, CLIFF),
    "a cliff of one of 6 inputs": (_cliff, 6, CLIFF),
    "a cliff of one of 20 inputs": (_cliff, 20, CLIFF),
    "a cliff of two of 6 inputs": (_island, 6, ISLAND),
    "a sphere of 20 inputs": (_sphere, 20, RARE),
}


def hidden(method, repetitions):
    """Count the intervals of events of which a method misses a part."""
    lines = []
    for name, (margin, d, truth) in HIDDEN.items():
        tally = Tally(
            f"P = {truth:.1e}, {method}, 8 replicates of 1000 rows: {name}", HIDDEN_REASONS
        )
        for seed in range(repetitions):
            space = _Space(margin, d)
            first, second = (np.random.default_rng((seed, k)).spawn(8) for k in (1, 2))
            outcome = ESTIMATORS[method](space, 1000, first)
            wide = wide_search(margin, d, 1000, second)
            _, ends = estimate_of(outcome, wide)
            tally.add("probability", truth, *ends)
            tally.add("probability", truth, *outcome.interval, by="without rows drawn wide")
            stated = wide.hidden_high(outcome.plain)
            held = ends[0] <= truth <= ends[1] or truth <= stated
            tally.add("probability, held or below the stated limit", 1.0, 1.0, 2.0 if held else 0.0)
        lines += tally.lines()
    return lines


class _Space:
    """A margin in standard normal space as a `uq.explore.limit_state.LimitState`."""

    failed = 0

    def __init__(self, margin, dimension):
        self.margin, self.dimension = margin, dimension

    def __call__(self, u):
        return self.margin(u)

    def uncertain(self, u):
        """Return the points themselves."""
        return u


def plateau(repetitions):
    """Count the intervals of subset simulation where the margin does not lead to the event."""
    tally = Tally("subset simulation on a plateau, 8 replicates of 1000 rows", REASONS)
    for share in PLATEAU:
        for steps in (1, 2):
            quantity = f"P = {share:g}" + ", half of the rows on a step" * (steps == 2)
            margin = partial(_flat, share, steps)
            for seed in range(repetitions):
                replicates = subset_simulation(
                    margin, 2, 1000, np.random.default_rng(seed).spawn(8)
                )
                tally.add(quantity, share, *subset_interval(replicates, 1000))
    return tally.lines()


PLATEAU = (2e-5, 2e-4, 1e-3)


def _flat(share, steps, u):
    """Beyond a limit of the first input; elsewhere flat, or on two steps of the second."""
    within = ndtr(-u[:, 0]) < share
    return np.where(within, 1.0, -1.0 + 0.5 * (steps == 2) * (u[:, 1] > 0))


def _jump_probability():
    """Return P(x1 + x3 > 2 - h and x1 + x2 > edge), by the midpoint rule over x1 near 1."""
    h = np.sqrt(2 * RARE / EDGE_SHARE)
    x1 = 1 - h * (np.arange(100_000) + 0.5) / 100_000
    return float(h * np.mean((x1 - (1 - h)) * (1 - (EDGE - x1))))


def importance(repetitions):
    """Count the intervals of importance sampling around design points."""
    lines = []
    for name, (margin, d) in LIMITS.items():
        tally = Tally(f"P = 1e-5, importance sampling, 8 replicates of 1000 rows: {name}", REASONS)
        first = np.random.default_rng(0).standard_normal((1000, d))
        points = design_points(margin, first, margin(first))
        for seed in range(repetitions):
            drawn = [
                drawn_around(points, 1000, rng) for rng in np.random.default_rng(seed).spawn(8)
            ]
            estimates = [np.mean(weight * (margin(u) > 0)) for u, weight in drawn]
            tally.add("probability", RARE, *log_scatter_interval(np.array(estimates)))
        lines += tally.lines()
    return lines


def subset_of_openturns(repetitions):
    """Count what OpenTURNS prints for as many rows."""
    ot.Log.Show(ot.Log.NONE)
    lines = []
    for name, (margin, d) in LIMITS.items():
        tally = Tally(f"P = 1e-5, subset simulation, 8 replicates of 1000 rows: {name}")
        function = ot.PythonFunction(d, 1, func_sample=_sampled(margin))
        vector = ot.CompositeRandomVector(function, ot.RandomVector(ot.Normal(d)))
        event = ot.ThresholdEvent(vector, ot.Greater(), 0.0)
        for seed in range(repetitions):
            ot.RandomGenerator.SetSeed(seed)
            algorithm = ot.SubsetSampling(event)
            algorithm.setMaximumOuterSampling(80)
            algorithm.setBlockSize(100)
            ends = UNKNOWN
            try:
                algorithm.run()
                result = algorithm.getResult()
                value, half = result.getProbabilityEstimate(), result.getConfidenceLength() / 2
                ends = value - half, value + half
            except TypeError:  # "The variance estimate must be >= 0"
                pass
            tally.add("probability", RARE, *ends, by="OpenTURNS SubsetSampling, 8000 rows a level")
        lines += tally.lines()
    return lines


def _sampled(margin):
    return lambda u: margin(np.asarray(u))[:, None]


FLAT = "conservative by design: no more than the independent rows of the first level support"
REASONS = {
    **{f"P = {share:g}": FLAT for share in PLATEAU},
}
HIDDEN_REASONS = {
    "probability": "where few wide rows lie within, the high end is what plain rows support; a"
    " cliff of two inputs is seldom met, and lies below the stated limit",
    "probability, held": "conservative: the limit is what 10,000 plain rows support",
}
