"""Importance weights: smoothed, trusted or refused, and the intervals of weighted means."""

import re

import numpy as np
import pytest
from learnt_studies import wear
from scipy import special

from uq.result.elements import dependence_of
from uq.stats.importance_weights import is_bounded, smoothed, tail_shape
from uq.stats.weighted_means import weighted_moments, weighted_share


def test_listed_values_are_no_tail():
    """A few values that many rows have are no law of Pareto; rare ones are not trusted."""
    few = np.repeat([1e-3, 0.01, 0.02, 0.05, 0.4, 1.0], 150) * (1 + 1e-13 * np.arange(900))
    assert tail_shape(few) == -np.inf
    assert tail_shape(np.append(few, [2.0, 3.0, 8.0])) > 0.7


def test_samples_of_several_rows_are_smoothed_as_one():
    """Rows of a sample keep their proportions, and the shape stays that which was judged."""
    ds = wear(samples=1000, units=3)
    rng, dependence = np.random.default_rng(1), dependence_of(ds)
    logs = 1.2 * rng.standard_normal((1000, 1)) + 2 * rng.standard_normal((1000, 3))
    smoothing = smoothed(logs.ravel(), dependence)
    changed = (np.log(smoothing.weights) - logs.ravel()).reshape(1000, 3)
    assert np.abs(np.ptp(changed, axis=1)).max() < 1e-9 and np.ptp(changed[:, 0]) > 0
    assert tail_shape(dependence.sums_of_samples(smoothing.weights)) == pytest.approx(
        smoothing.k, abs=0.1
    )


def test_a_tail_that_begins_amid_equal_weights_is_bounded_where_they_are():
    normal = np.random.default_rng(0).standard_normal(2000)
    in_steps = special.ndtr(np.round(-16 * (np.log(2) + 0.5 * normal) / 0.3) / 16)
    assert tail_shape(in_steps) < 0.3


def test_weights_with_a_small_bound_need_no_law_of_pareto():
    """As of rows of a mixture: many weigh the same, some next to nothing, some the most."""
    rng = np.random.default_rng(1)
    few = np.concatenate([rng.uniform(0, 0.5, 30), rng.uniform(1.1, 1.3, 100), np.full(10, 2.0)])
    weights, values = few / few.mean(), rng.standard_normal(len(few))
    assert tail_shape(weights) > 0.7
    refused, allowed = (weighted_moments(values, weights, most=most) for most in (20.0, 2.1))
    assert all(estimate.reason for estimate in refused)
    assert all(estimate.has_interval and not estimate.reason for estimate in allowed)
    assert not is_bounded(2.1, effective=9.0)


def test_the_interval_of_a_weighted_mean_holds_the_truth():
    """Weights times values are skewed, and samples without an outlier scatter too little."""
    rng, held = np.random.default_rng(4), []
    for _ in range(400):
        z, rest = rng.standard_normal((2, 100))
        by = smoothed(0.6 * z)
        mean = weighted_moments(np.exp(0.5 * z + 0.25 * rest), by.weights)[0]
        held += [mean.low < np.exp(0.3 + (0.5**2 + 0.25**2) / 2) < mean.high] * (not mean.reason)
    assert len(held) > 200 and 0.9 < np.mean(held) < 0.98


@pytest.mark.parametrize(
    ("mean", "rows", "p"), [(0.6, 100, 0.95), (1.0, 300, 0.95), (0.6, 30, 0.8)]
)
def test_a_tail_that_few_rows_reach_has_an_interval_that_holds_the_truth(mean, rows, p):
    """Rows that are missing there would have been heavier than those that are not."""
    rng, held = np.random.default_rng(8), []
    for _ in range(400):
        z = rng.standard_normal(rows)
        by = smoothed(mean * z)
        if not by.refusal:
            below = weighted_share((z < mean + special.ndtri(p)).astype(float), by.weights)
            held.append(below.low <= p <= below.high)
    assert len(held) > 150 and np.mean(held) > 0.93


def test_a_standard_deviation_depends_on_the_weights_alone():
    """Without an outlier values scatter too little: if they decided, those given would be wrong."""
    rng = np.random.default_rng(5)
    z = rng.standard_normal((2, 2000))
    refused = weighted_moments(np.exp(z[0]), smoothed(1.5 * z[0]).weights)[1]
    assert re.search(
        r"a single sample carries \d+\.\d% of the weight, above 1%: add \d+ samples", refused.reason
    )
    held = []
    for _ in range(400):
        z, rest = rng.standard_normal((2, 400))
        by = smoothed(0.4 * z)
        sd = weighted_moments(np.exp(0.5 * z + 0.25 * rest), by.weights)[1]
        variance = 0.5**2 + 0.25**2
        truth = np.exp(0.2 + variance / 2) * np.sqrt(np.expm1(variance))
        held += [sd.low < truth < sd.high] * (not sd.reason)
    assert len(held) > 360 and 0.92 < np.mean(held) < 0.98


def test_smoothed_weights_follow_the_published_algorithm():
    """Numbers by arviz-stats 0.8."""
    smoothing = smoothed(np.log(np.arange(1, 101) / 100.0) * -1.5)
    assert smoothing.k == pytest.approx(0.92003811)
    expected = [34.5552566, 12.21125704, 7.41715988]
    assert smoothing.weights[:3] == pytest.approx(expected)
    assert smoothing.weights.mean() == pytest.approx(1.0)
    assert "(Pareto k 0.92)" in smoothing.refusal


@pytest.mark.parametrize("steepness", [1000, 5000])
def test_weights_lost_in_rounding_are_no_tail(steepness):
    """As of rows far from a precise measurement: a law fitted to them overflows."""
    logs = np.append(np.linspace(-1.0, 0.0, 10), -2 - steepness * np.linspace(0.0, 1.0, 490))
    smoothing = smoothed(logs)
    assert smoothing.k < 0.7
    np.testing.assert_allclose(smoothing.weights, np.exp(logs) / np.exp(logs).mean())
