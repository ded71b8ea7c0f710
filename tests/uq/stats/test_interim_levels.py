"""The confidence of each check of a run that may stop at several sizes."""

import numpy as np
import pytest
from scipy import special, stats

from uq.stats.group_sequential import MOST_AT_STAKE, of_independent_rows, of_replicates


def any_misses(limit, checks, points=401):
    """Return P(|Z| > limit at any check), Z standard normal, each from twice the rows."""
    place, weight = np.polynomial.legendre.leggauss(points)
    place, weight = limit * place, limit * weight
    slope, rest = np.sqrt(0.5), np.sqrt(0.5)
    step = stats.norm.pdf(place[:, None], slope * place, rest)
    density = stats.norm.pdf(place)
    for _ in range(checks - 1):
        density = step @ (weight * density)
    return 1 - weight @ density


@pytest.mark.parametrize("checks", range(1, MOST_AT_STAKE + 1))
def test_all_of_a_few_intervals_of_independent_rows_hold_in_95_percent(checks):
    limit = stats.norm.ppf(0.5 + of_independent_rows(checks) / 2)
    assert any_misses(limit, checks) == pytest.approx(0.05, abs=1e-6)
    assert of_independent_rows(9) == of_independent_rows(MOST_AT_STAKE)


def wrong_stops(replicates, checks, confidence, runs=50_000):
    """Return how often a run of normal replicates stops at an interval that misses, at worst."""
    rng = np.random.default_rng(replicates)
    freedom = replicates - 1
    error = 2 ** (-np.arange(checks) / 2)  # of the mean
    spread = error * np.sqrt(rng.chisquare(freedom, (runs, checks)) / freedom)
    half = stats.t.ppf(0.5 + confidence / 2, freedom) * spread
    misses = 2 * special.ndtr(-half / error)
    worst = 0.0
    for required in np.quantile(half, np.linspace(0.002, 0.998, 60)):
        enough = half <= required
        enough[:, -1] = True
        worst = max(worst, misses[np.arange(runs), enough.argmax(axis=1)].mean())
    return worst


@pytest.mark.parametrize(("replicates", "checks"), [(2, 3), (4, 6), (8, 2), (8, 7), (32, 5)])
def test_replicates_stop_wrongly_in_5_percent_at_worst(replicates, checks):
    confidence = of_replicates(replicates, checks)
    assert 0.95 < confidence < 1 - 0.05 / checks
    assert wrong_stops(replicates, checks, confidence) == pytest.approx(0.05, abs=0.002)


def test_more_replicates_and_fewer_checks_need_less():
    assert of_replicates(8, 1) == 0.95
    assert of_replicates(8, 2) < of_replicates(8, 5) < of_replicates(4, 5) < of_replicates(2, 5)
    assert of_replicates(2000, 8) == pytest.approx(0.95, abs=0.002)
