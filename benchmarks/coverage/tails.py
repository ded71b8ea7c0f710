"""Means and standard deviations of laws with light tails and heavy ones."""

import numpy as np
from scipy import stats

from benchmarks.coverage.lives import with_life
from benchmarks.coverage.tally import Tally
from uq.analysis.statistics import summarise

HELD_OR_REFUSED = "held or refused"


def means(repetitions):
    """Count the mean's interval, and how often it is refused."""
    lines = []
    for name, law, sizes in (
        ("Pareto, index 1.5 (no variance)", stats.pareto(1.5), (200, 1000, 10_000)),
        ("Pareto, index 0.8 (no mean)", stats.pareto(0.8), (200, 1000)),
        ("lognormal, sigma 1", stats.lognorm(1.0), (200, 1000)),
    ):
        for rows in sizes:
            tally = Tally(f"{name}, {rows} independent rows", MEANS.get((name[:6], rows)))
            for entry in _summaries(law, rows, repetitions):
                found = entry["mean_interval"]
                _count(tally, "mean", law.mean(), found, "mean_interval" in entry["reasons"])
            lines += tally.lines()
    return lines


def scatters(repetitions):
    """Count the interval of the standard deviation, and how often it is refused."""
    lines = []
    for name, law in LAWS.items():
        for rows in (64, 200, 1000):
            tally = Tally(f"{name}, {rows} independent rows", SD.get((name, rows)))
            for entry in _summaries(law, rows, repetitions):
                refused = "sd_interval" in entry["reasons"]
                _count(tally, "sd", law.std(), entry["sd_interval"], refused)
            lines += tally.lines()
        tally = Tally(f"{name}, latin-hypercube, 8 replicates of 125 rows", SD.get((name, "lhs")))
        for entry in _summaries(law, 125, repetitions, replicates=8):
            refused = "sd_interval" in entry["reasons"]
            _count(tally, "sd", law.std(), entry["sd_interval"], refused)
        lines += tally.lines()
    return lines


LAWS = {
    "normal": stats.norm(),
    "uniform": stats.uniform(),
    "exponential": stats.expon(),
    "lognormal, sigma 0.5": stats.lognorm(0.5),
    "lognormal, sigma 1": stats.lognorm(1.0),
}


def _summaries(law, rows, repetitions, replicates=1):
    """Yield the summary of values of a law, again and again."""
    rng = np.random.default_rng(rows)
    for _ in range(repetitions):
        share = rng.random((rows, replicates))
        if replicates > 1:  # each replicate has a row in each of its slices
            slices = rng.permuted(np.tile(np.arange(rows), (replicates, 1)), axis=1).T
            share = (slices + share) / rows
        ds = with_life(law.ppf(share).ravel(), replicates=replicates, kind="value")
        yield summarise(ds)["outputs"]["life"]


def _count(tally, what, truth, entry, refused):
    tally.entry(what, truth, entry)
    held = refused or entry["low"] <= truth <= entry["high"]
    tally.add(f"{what}, {HELD_OR_REFUSED}", 1.0, 1.0, 2.0 if held else 0.0)


LEFT = "given only to samples in which the tail looks light, and those miss its far end"
MEANS = {}
SD = {}
"""Law and rows -> quantity -> why its coverage is not 95 %."""
