"""Differences between two studies, whose rows or replicates are paired or not."""

from functools import cache

import numpy as np

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


def differences(repetitions):
    """Count what `uq compare` prints of two studies, one input of which scatters less."""
    lines = []
    for how, (design, apart) in PAIRS.items():
        tally = Tally(f"linear function with one input of less scatter, {how}", REASONS)
        truth = _truth()
        wide, narrow = _studies(*design)
        for seed in range(repetitions):
            pair = computed(with_seed(wide, seed)), computed(with_seed(narrow, seed + apart))
            compared = comparison_facts(comparison(*map(Result, pair))).json["outputs"]["y"]
            entries = {f"quantile {p}": compared["quantiles"][p] for p in QUANTILES} | {
                "sd": compared["sd"],
                f"P(> {THRESHOLD})": compared["thresholds"][str(THRESHOLD)]["above"],
            }
            if design[0] != "sobol":  # whose points have this mean to rounding: nothing to count
                entries["mean"] = compared["mean"]
            for name, entry in entries.items():
                tally.entry(f"difference of {name}", truth[name], entry["difference"])
            tally.entry("ratio of sd", truth["ratio"], compared["sd"]["ratio"])
        lines += tally.lines()
    return lines


def _studies(*design):
    analysis = {"thresholds": {"y": [THRESHOLD]}, "quantiles": [float(p) for p in QUANTILES]}
    return [
        study_of(*design, model="linear", laws=laws, analysis=analysis) for laws in (WIDE, NARROW)
    ]


@cache
def _truth():
    """Return the differences, from points that integrate shares to 1e-5."""
    statistics = []
    for study in _studies("sobol", 2**18):
        y = computed(study)["y"].values
        statistics.append(
            {f"quantile {p}": np.quantile(y, float(p)) for p in QUANTILES}
            | {"mean": y.mean(), "sd": y.std(), f"P(> {THRESHOLD})": np.mean(y > THRESHOLD)}
        )
    wide, narrow = statistics
    return {name: narrow[name] - wide[name] for name in wide} | {"ratio": narrow["sd"] / wide["sd"]}


FEW_RANKS = "conservative: with few rows, ranks are coarse; 94 to 98 % from 4,096 rows"
RAISED = "conservative: the ends allow for one more row as extreme as the most extreme"
REASONS = {f"difference of quantile {p}": FEW_RANKS for p in QUANTILES} | {
    "ratio of sd": RAISED,
    "difference of sd": RAISED,
}
"""Quantity -> why its coverage is not 95 %."""
