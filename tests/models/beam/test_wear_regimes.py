"""Regimes of a beam that wears: recognised in spite of the drift, counted when they last."""

import numpy as np
import pytest

from models.beam.parameters import REGIMES
from models.beam.wear.regimes import LONGEST_PERIOD, ROUND, changes_of, confirmed_regimes, watch
from models.beam.wear.regimes import regime_of as regime_near
from models.numerics.jit import kernel


@kernel
def watched(strobe, apart):
    return watch(strobe, apart)


@kernel
def regime_of(period, right, left):
    return regime_near(period, right, left)


def strobed(pattern, drift=5e-4, fading=0.0):
    """Return strobe points whose pattern drifts as the beam wears, and a transient that fades."""
    t = np.arange(2 * ROUND)
    x = np.resize(pattern, len(t)) * (1 + drift * t) + fading * 0.9**t
    points = np.stack([x, 0.3 - x], axis=1)
    return points[:ROUND].copy(), points[ROUND:].copy()


@pytest.mark.parametrize(
    ("pattern", "regime"),
    [
        ([1.0], "period-1-asymmetric"),
        ([1.0, 0.8], "period-k"),
        (np.linspace(0.5, 1.0, 8), "period-k"),
        (np.linspace(0.5, 1.0, 9), "aperiodic"),
        (np.random.default_rng(2).uniform(-1, 1, 32), "aperiodic"),
    ],
)
def test_the_drift_of_wear_does_not_hide_the_regime(pattern, regime):
    period, _ = watched(strobed(pattern)[1], np.full(LONGEST_PERIOD, np.inf))
    assert REGIMES[regime_of(period, 1.0, 1.3)] == regime


def test_a_response_comes_closer_to_an_orbit_only_where_the_distance_shrinks():
    apart = np.full(LONGEST_PERIOD, np.inf)
    for points, closer in zip(strobed([1.0], 0.0, 0.05), (True, True), strict=True):
        assert watched(points, apart) == (1, closer)
    for points in strobed([1.0], 1e-3):
        _, closer = watched(points, apart)
    assert not closer


def test_equal_works_are_symmetric_and_no_work_is_no_impact():
    assert REGIMES[regime_of(1, 1.0, 1.0)] == "period-1-symmetric"
    assert REGIMES[regime_of(1, 0.0, 0.0)] == "no-impact"


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
