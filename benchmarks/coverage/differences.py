"""Differences between two studies, whose rows or replicates are paired or not."""

from functools import cache

import numpy as np
from scipy.special import ndtri

from benchmarks.coverage.problems import computed, study_of, with_seed
from benchmarks.coverage.tally import Tally
from uq.assess.comparison import comparison
from uq.assess.summary_facts import comparison_facts
from uq.result.result import Result

UNIFORM = {"distribution": "uniform", "lower": 0.0, "upper": 1.0}
WIDE = dict.fromkeys(("x1", "x2", "x3", "x4"), UNIFORM)
NARROW = WIDE | {"x4": {"distribution": "uniform", "lower": 0.3, "upper": 0.7}}
THRESHOLD = 4.0
QUANTILES = ("0.05", "0.5", "0.95")
PAIRS = {
    "200 independent rows, paired": (("monte-carlo", 200), 0),
    "200 independent rows, unpaired": (("monte-carlo", 200), 1_000_000),
    "sobol, 8 replicates of 64 rows, paired": (("sobol", 64, 8), 0),
}


def _lognormal(ds):
    """Return exp(z / 2 + 2 x4), where z is the normal score of x1: lognormal, skewed in x4."""
    return np.exp(ndtri(ds["x1"].values) / 2 + 2 * ds["x4"].values)


FUNCTIONS = {
    "linear function": (lambda ds: ds["y"].values, THRESHOLD, tuple(PAIRS)),
    "lognormal function": (_lognormal, 3.0, tuple(PAIRS)[:2]),
}
"""Name -> function of the rows of the linear model, threshold, and pairs of studies."""


def differences(repetitions):
    """Count what `uq compare` prints of two studies, one input of which scatters less."""
    lines = []
    for name, (function, threshold, pairs) in FUNCTIONS.items():
        truth = _truth(name)
        for how in pairs:
            design, apart = PAIRS[how]
            tally = Tally(f"{name} with one input of less scatter, {how}", REASONS)
            wide, narrow = _studies(threshold, *design)
            for seed in range(repetitions):
                pair = (
                    _result(function, with_seed(wide, seed)),
                    _result(function, with_seed(narrow, seed + apart)),
                )
                compared = comparison_facts(comparison(*pair)).json["outputs"]["y"]
                entries = {f"quantile {p}": compared["quantiles"][p] for p in QUANTILES} | {
                    "sd": compared["sd"],
                    f"P(> {threshold})": compared["thresholds"][str(threshold)]["above"],
                }
                if design[0] != "sobol":  # its points have the mean of a linear function
                    entries["mean"] = compared["mean"]
                for quantity, entry in entries.items():
                    tally.entry(f"difference of {quantity}", truth[quantity], entry["difference"])
                tally.entry("ratio of sd", truth["ratio"], compared["sd"]["ratio"])
            lines += tally.lines()
    return lines


def _result(function, study):
    ds = computed(study)
    ds["y"].values[:] = function(ds)
    return Result(ds)


def _studies(threshold, *design):
    analysis = {"thresholds": {"y": [threshold]}, "quantiles": [float(p) for p in QUANTILES]}
    return [
        study_of(*design, model="linear", laws=laws, analysis=analysis) for laws in (WIDE, NARROW)
    ]


@cache
def _truth(name):
    """Return the differences, from points that integrate shares to 1e-5."""
    function, threshold, _ = FUNCTIONS[name]
    statistics = []
    for study in _studies(threshold, "sobol", 2**18):
        y = function(computed(study))
        statistics.append(
            {f"quantile {p}": np.quantile(y, float(p)) for p in QUANTILES}
            | {"mean": y.mean(), "sd": y.std(), f"P(> {threshold})": np.mean(y > threshold)}
        )
    wide, narrow = statistics
    return {name: narrow[name] - wide[name] for name in wide} | {"ratio": narrow["sd"] / wide["sd"]}


FEW_RANKS = "conservative: with few rows, ranks are coarse; 94 to 98 % from 4,096 rows"
RAISED = "conservative: the ends allow for one more row as extreme as the most extreme"
REASONS = {f"difference of quantile {p}": FEW_RANKS for p in QUANTILES} | {
    "ratio of sd": RAISED,
    "difference of sd": RAISED,
    "difference of mean": RAISED,
}
"""Quantity -> why its coverage is not 95 %."""
