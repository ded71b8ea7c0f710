"""Regimes of a beam that wears: recognised in spite of the drift, counted when they last."""

import numpy as np
import pytest

from models.beam.parameters import REGIMES
from models.beam.wear.regimes import changes_of, confirmed_regimes, regime_of


def strobed(pattern, drift=5e-4, periods=48):
    """Return strobe points and works of one beam whose pattern drifts as it wears."""
    t = np.arange(periods)
    x = np.resize(pattern, periods) * (1 + drift * t)
    return np.stack([x, 0.3 - x], axis=1), np.ones((periods, 2)) * [1.0, 1.3]


@pytest.mark.parametrize(
    ("pattern", "regime"),
    [
        ([1.0], "period-1-asymmetric"),
        ([1.0, 0.8], "period-k"),
        (np.linspace(0.5, 1.0, 16), "period-k"),
        (np.linspace(0.5, 1.0, 17), "aperiodic"),
        (np.random.default_rng(2).uniform(-1, 1, 48), "aperiodic"),
    ],
)
def test_the_drift_of_wear_does_not_hide_the_regime(pattern, regime):
    assert REGIMES[regime_of(*strobed(pattern))] == regime


def test_equal_works_are_symmetric_and_no_work_is_no_impact():
    strobe, work = strobed([1.0])
    assert REGIMES[regime_of(strobe, np.ones_like(work))] == "period-1-symmetric"
    assert REGIMES[regime_of(strobe, np.zeros_like(work))] == "no-impact"


def test_only_regimes_that_last_are_counted_and_from_where_they_began():
    looks = [[4, 2, 2, 2, 4, 2, 3, 4, 3, 4, 4, 4, 4, 1, 1, -1], [1, 1, 2, 2, 1, 1, 2, 2] + 8 * [-1]]
    regimes = confirmed_regimes(np.array(looks, np.int8))
    assert regimes[0].tolist() == [-1] + 8 * [2] + 6 * [4] + [-1]
    assert (regimes[1] == -1).all()
    changes = changes_of(regimes)
    assert np.flatnonzero(changes[0]).tolist() == [9]
    assert not changes[1].any()


def test_the_end_of_wear_is_a_change_at_once_and_a_short_silence_is_none():
    looks = [[2, 2, 2, 2, 0, -1], [2, 2, 2, 0, 2, 2], [0, 0, -1, -1, -1, -1]]
    regimes = confirmed_regimes(np.array(looks, np.int8))
    assert regimes[0].tolist() == [2, 2, 2, 2, 0, -1]
    assert changes_of(regimes).sum(axis=1).tolist() == [1, 0, 0]
