"""Intervals of samples with several rows hold the truth, as `benchmarks.coverage` counts it."""

import pytest

from benchmarks.coverage import nested

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("name", list(nested.EFFECTS))
def test_shares_of_random_effects(name):
    assert [line for line in nested.effects(name, 2000) if line.unexplained] == []


def test_shares_beside_what_is_known():
    assert [line for line in nested.integrated(2000) if line.unexplained] == []


def test_shares_of_weighted_samples():
    assert [line for line in nested.weighted(2000) if line.unexplained] == []


@pytest.mark.parametrize("name", list(nested.SIZES))
def test_statistics_of_all_rows(name):
    assert [line for line in nested.statistics(name, 300) if line.unexplained] == []
