"""Means of functions that jump along an input, from replicates of designs that spread evenly."""

import numpy as np
from scipy.stats import qmc

from benchmarks.coverage.tally import Tally
from uq.stats.dependent_rows import Dependence
from uq.stats.moments import moments

PLACE, OTHER = 19.1 / 64, 0.7034
FUNCTIONS = {
    "a jump": (lambda x: 6.0 * (x[:, 0] > PLACE) + _smooth(x), 6 * (1 - PLACE) + 0.4),
    "a jump near an end": (lambda x: 6.0 * (x[:, 0] > 0.985) + _smooth(x), 6 * 0.015 + 0.4),
    "a small jump": (
        lambda x: 1.0 * (x[:, 0] > PLACE) + 5 * x[:, 1] + 5 * x[:, 2],
        1 - PLACE + 5,
    ),
    "two jumps": (
        lambda x: 2.0 * (x[:, 0] > PLACE) + 3.0 * (x[:, 1] > OTHER) + 0.3 * x[:, 2],
        2 * (1 - PLACE) + 3 * (1 - OTHER) + 0.15,
    ),
    "a slab": (lambda x: 6.0 * (np.abs(x[:, 0] - 0.337) < 0.01) + _smooth(x), 6 * 0.02 + 0.4),
    "no jump": (lambda x: (1 + x[:, 0]) * (1 + 2 * x[:, 1]) * (1 + x[:, 2]), 4.5),
}
"""Name -> function of three uniform inputs, its mean."""

DRAWN = {"sobol": qmc.Sobol, "halton": qmc.Halton, "latin-hypercube": qmc.LatinHypercube}
SIZES = (("sobol", 64), ("sobol", 1024), ("halton", 64), ("latin-hypercube", 64))
REPLICATES = 8
BOUND = "conservative: a bound of the error of a jump that the replicates may hide"


def _smooth(x):
    return 0.5 * x[:, 1] + 0.3 * x[:, 2]


def means(repetitions):
    """Count the intervals of means from replicates."""
    lines = []
    for method, rows in SIZES:
        tallies = {
            name: Tally(
                f"Even replicates, {name}, {method}, {REPLICATES} x {rows}", {"mean": BOUND}
            )
            for name in FUNCTIONS
        }
        replicate = np.repeat(np.arange(REPLICATES), rows)
        for seed in range(repetitions):
            rng = np.random.default_rng(seed)
            x = np.concatenate([DRAWN[method](3, rng=rng).random(rows) for _ in range(REPLICATES)])
            part = Dependence(replicate, x)
            for name, (function, truth) in FUNCTIONS.items():
                tallies[name].estimate("mean", truth, moments(function(x), part).mean)
        lines += [line for tally in tallies.values() for line in tally.lines()]
    return lines
