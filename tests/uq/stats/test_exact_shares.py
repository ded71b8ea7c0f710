"""Shares known from few hits: how often each end misses the truth."""

import numpy as np
import pytest
from scipy import stats

from uq.stats.dependent_rows import Dependence
from uq.stats.intervals import FEW, binomial_interval, exact_interval, share_interval

ROWS = 2000
HITS = np.arange(ROWS + 1)


def test_each_end_misses_rarely_at_any_share():
    ends = np.array([binomial_interval(k / ROWS, ROWS) for k in HITS[:200]])
    for expected in np.geomspace(0.1, 120, 60):
        chance = stats.binom.pmf(HITS[:200], ROWS, expected / ROWS)
        too_high = chance[ends[:, 0] > expected / ROWS].sum()
        too_low = chance[ends[:, 1] < expected / ROWS].sum()
        assert too_high < 0.041, expected  # Wilson's: 0.16 where one hit is rare
        assert too_low < 0.027 and too_high + too_low < 0.065, expected


@pytest.mark.parametrize("hits", [0, 1, 5, 60])
def test_exact_interval_is_scipys_and_takes_several_at_once(hits):
    scipys = stats.binomtest(hits, 60).proportion_ci(0.95, method="exact")
    low, high = exact_interval(np.array([hits / 60, 0.5]), np.array([60.0, 1e4]), 0.95)
    assert (low[0], high[0]) == pytest.approx((scipys.low, scipys.high), rel=1e-12)
    assert 0.48 < low[1] < 0.5 < high[1] < 0.52


@pytest.mark.parametrize("expected", [0.3, 1.0, 3.0, 8.0])
def test_replicates_with_few_hits_cover(expected):
    rng, held, replicates = np.random.default_rng(1), 0, Dependence(np.arange(1024) % 8)
    for _ in range(400):
        low, high = share_interval(rng.random(1024) < expected / 1024, replicates)
        held += low <= expected / 1024 <= high
    assert held >= 372  # 93 %


def test_replicates_without_a_hit_have_an_upper_bound():
    low, high = share_interval(np.zeros(800, dtype=bool), Dependence(np.arange(800) % 8))
    assert low == 0 and high == pytest.approx(1 - 0.025 ** (1 / 800))


def test_hits_that_gather_in_one_replicate_count_for_less():
    hits, replicates = np.arange(800) < 12, Dependence(np.arange(800) // 100)
    scattered = share_interval(np.arange(800) % 67 == 0, replicates)
    gathered = share_interval(hits, replicates)
    assert hits.sum() == 12 < FEW
    assert np.diff(gathered) > 1.5 * np.diff(scattered)
