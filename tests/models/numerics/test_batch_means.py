"""Errors of time means, where neighbouring batches know each other."""

import numpy as np
import pytest

from models.numerics.batch_means import mean_and_bound, mean_and_error, ratio_error


def series(rng, memory, rows, count):
    """Return first-order autoregressive rows of mean 3, variance 1."""
    noise = rng.normal(size=(rows, count)) * np.sqrt(1 - memory**2)
    out = np.empty((rows, count))
    out[:, 0] = rng.normal(size=rows)
    for i in range(1, count):
        out[:, i] = memory * out[:, i - 1] + noise[:, i]
    return 3 + out


@pytest.mark.parametrize("memory", [0.0, 0.9])
def test_errors_tell_how_far_means_are_off(memory):
    batches = series(np.random.default_rng(3), memory, 2000, 400).reshape(2000, 20, 20).mean(axis=2)
    mean, error = mean_and_error(batches)
    within = (np.abs(mean - 3) < 2.1 * error).mean()
    assert 0.93 < within < 0.99


@pytest.mark.parametrize(("memory", "least"), [(0.0, 0.9), (0.9, 0.9), (0.99, 0.85)])
def test_bounds_hold_even_where_changes_outlast_the_batches(memory, least):
    """At 0.99 a change lasts for twelve batches of 16, and half of the largest joined ones."""
    batches = series(np.random.default_rng(3), memory, 2000, 768).reshape(2000, 48, 16).mean(axis=2)
    mean, error = mean_and_bound(batches)
    assert least < (np.abs(mean - 3) < error).mean() < 0.99
    if memory == 0.99:
        mean, error = mean_and_error(batches)
        assert (np.abs(mean - 3) < 1.645 * error).mean() < 0.8


@pytest.mark.parametrize("estimate", [mean_and_error, mean_and_bound])
def test_every_element_is_on_its_own(estimate):
    batches = np.random.default_rng(4).normal(size=(3, 8, 2))
    mean, error = estimate(batches)
    assert mean.shape == error.shape == (3, 2)
    for i, j in np.ndindex(3, 2):
        alone = estimate(batches[i : i + 1, :, j])
        np.testing.assert_allclose([mean[i, j], error[i, j]], np.concatenate(alone))


@pytest.mark.parametrize("rate", [5.0, 0.3])
def test_errors_of_ratios_hold_with_many_or_few_events(rate):
    """Impulses of mean 3 and variance 1; at 0.3 events a batch, three of four batches have none."""
    rng = np.random.default_rng(5)
    events = rng.poisson(rate, (4000, 20)).astype(float)
    sums = 3 * events + np.sqrt(events) * rng.normal(size=events.shape)
    error = ratio_error(sums, events)
    estimated = np.count_nonzero(events, axis=1) > 1
    assert np.isnan(error).tolist() == (~estimated).tolist()
    sums, events, error = sums[estimated], events[estimated], error[estimated]
    off = np.abs(sums.sum(axis=1) / events.sum(axis=1) - 3)
    assert 0.85 < (off < 1.645 * error).mean() < 0.97


def test_a_constant_ratio_is_exact():
    """However much its numerator and denominator fluctuate together."""
    works = np.random.default_rng(6).uniform(1, 2, (3, 20))
    assert np.all(ratio_error(0.25 * works, works) < 1e-15)
