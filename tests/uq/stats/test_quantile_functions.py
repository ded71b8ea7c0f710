"""Quantile functions have the bits of those of scipy.stats."""

import numpy as np
import pytest
from scipy import stats

from uq.stats import quantile_functions
from uq.stats.intervals import exact_interval
from uq.stats.tails import _distance

TAILS = (0.005, 0.025, 0.05, 0.5, 0.95, 0.975, 0.995)
SHARES = (0.001, 0.01, 0.1, 0.5, 0.95, 0.99)
COUNTS = (1, 2, 3, 4, 7, 20, 59, 93, 1000, 10_000, 10_000_000)


@pytest.mark.parametrize("p", TAILS)
def test_continuous_laws(p):
    assert quantile_functions.normal(p) == stats.norm.ppf(p)
    for freedom in (1, 2, 3, 7, 30, 10_000):
        assert quantile_functions.student(p, freedom) == stats.t.ppf(p, freedom)
    assert np.isnan(quantile_functions.student(p, 0))


@pytest.mark.parametrize("share", SHARES)
@pytest.mark.parametrize("p", TAILS)
def test_counts(p, share):
    # Also where the probability of a count is p itself but for rounding.
    for n in COUNTS:
        assert quantile_functions.binomial(p, n, share) == stats.binom.ppf(p, n, share)
        assert quantile_functions.binomial_exceeded(p, n, share) == stats.binom.isf(p, n, share)
    for hits in COUNTS[:-2]:
        counts = quantile_functions.negative_binomial(p, hits, share)
        assert counts == stats.nbinom.ppf(p, hits, share)


def test_intervals_of_few_hits():
    hits, rows, tail = np.array([0.0, 1, 2.5, 19, 40]), 40, (1 - 0.95) / 2
    low, high = exact_interval(hits / rows, rows, 0.95)
    assert np.array_equal(low[1:], stats.beta.ppf(tail, hits[1:], rows - hits[1:] + 1))
    assert np.array_equal(high[:-1], stats.beta.isf(tail, hits[:-1] + 1, rows - hits[:-1]))


def test_distances():
    values = np.random.default_rng(1).gamma(2, size=333).round(2)
    excess = np.sort(values) + 0.01
    for shape in (-0.05, 0.4):
        law, ranks = stats.genpareto(shape, scale=2), 2 * np.arange(1, 334) - 1
        tails = law.logcdf(excess) + law.logsf(excess)[::-1]
        assert _distance(excess, shape, 2.0) == -333 - ranks @ tails / 333
