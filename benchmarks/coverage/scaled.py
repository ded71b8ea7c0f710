"""Lives of which an input is integrated exactly, and rows weighted to other laws."""

from itertools import product

import numpy as np
from scipy import special, stats

from benchmarks.coverage.tally import Tally
from uq.assess.row_inputs import EVERYWHERE
from uq.assess.scale_laws import IndependentScale
from uq.assess.weighted_mixture import WeightedMixture
from uq.contract import Output
from uq.result.element import Element
from uq.sampling.laws import law_of
from uq.sampling.log_sums import LogTerm
from uq.stats.estimate import difference
from uq.stats.importance_weights import smoothed
from uq.stats.weighted_means import share_to_compare

LIFE = Output("s", "life", "lifetime")
ROWS = (30, 100, 300, 1000)
PROBABILITIES = (1e-5, 0.001, 0.01, 0.1, 0.5, 0.9, 0.99)
SPREADS = (0.2, 0.5, 1.0, 2.0, 5.0)
"""Standard deviations of the logarithm of what is not integrated, over that of what is."""

CAUTIOUS = (
    "allows for two more rows as extreme as the farthest outlier and, where fewer than 40 effective"
    " rows carry the probability, is no narrower than the interval of a share of hits"
)


FEW_GIVEN = (
    "where few rows carry it, only samples whose rows agree give both ends: held or not given in"
    " 97 % or more"
)


def lognormal_term(sigma):
    """Return the logarithm of a lognormal input of median 1."""
    law = law_of({"distribution": "lognormal", "median": 1.0, "sigma": sigma})
    return LogTerm(law, EVERYWHERE, 1.0)


def element(rest, drawn, term, weights=None):
    """Return lives exp(rest + drawn), the second term of which is integrated."""
    nothing = np.zeros(len(rest), dtype=bool)
    law = IndependentScale(("depth",), term, drawn)
    return Element("life", "life", LIFE, {}, np.exp(rest + drawn), nothing, nothing, law, weights)


def scaled(repetitions):
    """Count P(T < t) and quantiles of lives that a lognormal input scales."""
    lines, term = [], lognormal_term(1.0)
    for spread in SPREADS:
        for rows in ROWS:
            name = f"life scaled by an input, others scatter {spread:g} times as much, {rows} rows"
            tally = Tally(name, {"": CAUTIOUS, "B": FEW_GIVEN})
            rng = np.random.default_rng(rows)
            for _ in range(repetitions):
                rest = spread * rng.standard_normal(rows)
                weighted_mixture = WeightedMixture(element(rest, rng.standard_normal(rows), term))
                for p in PROBABILITIES:
                    time = np.exp(np.hypot(1.0, spread) * stats.norm.ppf(p))
                    below = weighted_mixture.below(time)
                    tally.add(f"P(T < t) = {p:g}", p, below.low, below.high)
                for p in (0.01, 0.1, 0.5):
                    time = np.exp(np.hypot(1.0, spread) * stats.norm.ppf(p))
                    quantile = weighted_mixture.quantile(p)
                    tally.add(f"B{100 * p:g}", time, quantile.low, quantile.high)
            lines += tally.lines()
    return lines


def what_if(repetitions):
    """Count the difference between weighted rows and a fresh run of the other study."""
    cases = product((0.05, 0.5), ((0.4, 0.1), (0.5, 0.3)), (300, 1000))
    return [line for case in cases for line in _what_if(*case, repetitions)]


def _what_if(integrated, new, rows, repetitions):
    """Count it for an input that is integrated, and a law (sd, mean) of the other."""
    old, (sd, mean) = 0.5, new
    term = lognormal_term(integrated)
    law = f"input of sigma {integrated} integrated, the other with sd {sd:g}, shifted by {mean:g}"
    tally = Tally(f"what if, {rows} rows, {law}", REASONS)
    rng = np.random.default_rng(rows)
    for _ in range(repetitions):
        rest = old * rng.standard_normal(rows)
        ratio = (rest / old) ** 2 - ((rest - mean) / sd) ** 2
        by = smoothed(ratio / 2)
        weighted = element(rest, integrated * rng.standard_normal(rows), term, by.weights)
        other = mean + sd * rng.standard_normal(rows)
        fresh = element(other, integrated * rng.standard_normal(rows), term)
        for p in (0.01, 0.05, 0.5, 0.95, 0.99):
            time = np.exp(mean + np.hypot(sd, integrated) * special.ndtri(p))
            alone = WeightedMixture(weighted).below(time)
            tally.estimate(f"P(T < t) = {p:g}", p, alone)
            apart = difference(alone, share_to_compare(fresh.below(time)), 0.0)
            tally.estimate(f"difference from a fresh run, P(T < t) = {p:g}", 0.0, apart)
    return tally.lines()


HITS = (
    "fewer than 40 effective rows carry it or its complement: no narrower than the interval of a"
    " share of hits, as heavy as the one that carries most"
)
REASONS = {"P(T < t)": CAUTIOUS, "difference": HITS}
