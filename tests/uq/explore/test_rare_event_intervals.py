"""Rare events: intervals hold the truth, also on a plateau."""

import numpy as np
import pytest
from rare_studies import LAST, WEAR, study
from scipy import stats

from uq.explore.importance_sampling import design_points, drawn_around
from uq.explore.rare_events import rare_event
from uq.explore.subset_simulation import SubsetReplicate, subset_interval, subset_simulation
from uq.stats.intervals import log_scatter_interval


def flat(u, share=2e-5):
    return np.where(stats.norm.sf(u[:, 0]) < share, 1.0, -1.0)


def test_a_plateau_supports_what_its_independent_rows_do():
    replicates = subset_simulation(flat, 2, 1000, np.random.default_rng(1).spawn(8))
    assert [replicate.ended for replicate in replicates] == ["plateau"] * 8
    assert [replicate.levels for replicate in replicates] == [1] * 8
    low, high = subset_interval(replicates, 1000)
    assert low == 0 and high == pytest.approx(4.6e-4, rel=0.01)  # 1 - 0.025^(1/8000)


def test_on_a_plateau_the_command_prints_what_the_rows_support():
    # A life that never ends is one plateau.
    of = study("exponential-wear", WEAR, fixed={"threshold": 1.8e-9})
    ds = rare_event(of, "life", 1e9, below=True)  # ends in 4e-5 of rows, and then long before
    assert 2e-5 < LIFE_ENDS < 8e-5
    assert float(ds["low"]) <= LIFE_ENDS <= float(ds["high"])
    assert "1e-12" not in ds.attrs["notes"]
    if float(ds["probability"]) == 0:
        assert "plateau" in ds.attrs["notes"] and "0.00046" in ds.attrs["notes"]


LIFE_ENDS = stats.norm.sf(np.log(1.8e-9 / 2.5e-10) / 0.5)


@pytest.mark.slow
@pytest.mark.parametrize("share", [2e-5, 3e-4, 2e-3])
def test_intervals_on_a_plateau_hold_the_truth(share):
    held = 0
    for seed in range(60):
        replicates = subset_simulation(
            lambda u: flat(u, share), 2, 500, np.random.default_rng(seed).spawn(8)
        )
        low, high = subset_interval(replicates, 500)
        held += low <= share <= high
    assert held >= 55


def test_replicates_that_never_got_there_count_with_the_level_they_reached():
    inside = np.zeros((1, 2))
    there = [
        SubsetReplicate(probability, 5, inside, 1e-4, 0, "event")
        for probability in (1e-6, 2e-6, 1.5e-6, 1.2e-6)
    ]
    stuck = [SubsetReplicate(0.0, 3, inside, 1e-3, 0, "plateau")]
    low, high = subset_interval(there + stuck, 1000)
    assert 0 <= low < 1e-6 and 2e-4 < high <= 1 - 0.025 ** (1 / 5000)


def plane(u):
    return u.sum(axis=1) / 2 - 4.753424


def corner(u):
    return stats.norm.cdf(u) @ np.array([1.0, 2.0, 3.0, 4.0]) - LAST


@pytest.mark.slow
@pytest.mark.parametrize("margin", [plane, corner])
@pytest.mark.parametrize("method", ["subset", "importance"])
def test_intervals_hold_the_truth(margin, method):
    first = np.random.default_rng(0).standard_normal((1000, 4))
    points = design_points(margin, first, margin(first))
    held, estimates = [], []
    for seed in range(300):
        generators = np.random.default_rng(seed).spawn(8)
        if method == "subset":
            probabilities = [
                replicate.probability
                for replicate in subset_simulation(margin, 4, 1000, generators)
            ]
        else:
            drawn = [drawn_around(points, 1000, rng) for rng in generators]
            probabilities = [np.mean(weight * (margin(u) > 0)) for u, weight in drawn]
        low, high = log_scatter_interval(np.array(probabilities))
        held.append(low <= 1e-6 <= high)
        estimates.append(np.mean(probabilities))
    bias = np.mean(estimates) / 1e-6 - 1
    print(f"\n{margin.__name__} {method}: {np.mean(held):.1%}, bias {bias:.1%}")
    assert 0.92 <= np.mean(held) <= 0.98
    assert abs(bias) < 0.1
