"""Fleets where lives never end, agree, or failed, and where units show little of their world."""

import numpy as np
import pytest
from computed import computed, study_of
from scipy import special, stats

from uq.assess.fleet import fleet_facts, fleet_of
from uq.assess.random_effects import DeconvolvedProbability
from uq.result.result import Result
from uq.stats.dependent_rows import INDEPENDENT

NORMAL = {"distribution": "normal", "mean": 0.0, "sd": 1.0}


def lognormal(sigma, **more):
    return {"distribution": "lognormal", "median": 1.0, "sigma": sigma, **more}


def rows(inputs, settings=None, **design):
    """Return units whose lives are a b^-2 c^(1/2) exp(z/2)."""
    return computed(
        study_of(
            {
                "study": {"name": "fleet", "model": "scaled"},
                "design": {"method": "monte-carlo", "samples": 100, "seed": 3} | design,
                "uncertain": inputs,
                "settings": settings or {},
                "analysis": {"outputs": ["life"]},
            },
            "sample_models:SCALED",
        )
    )


SHARED_Z = {"z": NORMAL | {"level": "shared"}, "a": lognormal(0.5)}


def test_worlds_whose_units_never_end_have_no_end_of_the_band():
    ds = rows(SHARED_Z, {"never_above": 0.5})
    fleet = fleet_of(Result(ds), 4)
    assert fleet.first[0.5].high.numbers == (np.inf,) * 3
    assert fleet.first[0.95].estimate.value == np.inf
    assert 0 < fleet.first[0.95].low.low < fleet.first[0.95].low.high < 2
    entry = fleet_facts(fleet).json["first"]["quantiles"]["0.5"]
    assert entry["band_high"] is None and entry["band_high_never"] is True
    assert entry["band_high_low_never"] is entry["band_high_high_never"] is True


def test_a_single_replicate_has_numbers_without_intervals():
    fleet = fleet_of(Result(rows(SHARED_Z, method="halton", samples=64)), 50, [0.3])
    for estimate in fleet.by[0.3]:
        assert np.isfinite([estimate.estimate.value, estimate.low.value, estimate.high.value]).all()
        assert np.isnan([estimate.estimate.low, estimate.low.low, estimate.high.high]).all()
    assert any(note.startswith("no intervals: the rows of a 'halton'") for note in fleet.notes)


def test_replicates_that_agree_keep_the_interval_of_a_band():
    ds = rows(SHARED_Z, method="halton", samples=64, replicates=8)
    fleet = fleet_of(Result(ds), 50, [0.3])
    for estimate in (*fleet.by[0.3], fleet.first[0.5]):
        for end in (estimate.low, estimate.high):
            assert end.low <= end.value <= end.high


def test_units_that_all_end_at_one_time_end_then():
    ds = rows({"z": NORMAL}, units=4)
    same = ds.assign(life=ds["life"].copy(data=np.full(400, 2.0)))
    assert fleet_of(Result(same), 4).first[0.5].estimate.numbers == pytest.approx((2.0, 2.0, 2.0))


def test_failed_rows_may_have_ended_at_once():
    ds = rows({"z": NORMAL}, {"fail_above": 0.5}, units=4)
    assert fleet_of(Result(ds), 2).first[0.5].failed.low == 0.0


def test_units_that_do_not_differ_are_counted():
    """Scales that cancel: the units of each sample end together."""
    inputs = SHARED_Z | {"b": lognormal(0.5), "c": {"equals": "b"}}
    ds = rows(inputs, units=2)
    life = np.exp(ds["z"].values / 2)
    fleet = fleet_of(Result(ds.assign(life=ds["life"].copy(data=life))), 2, [1.0], plain=True)
    assert fleet.by[1.0][0].estimate.value == pytest.approx(2 * np.mean(life < 1))


@pytest.mark.parametrize("units", [2, 8])
def test_a_few_units_leave_the_ends_of_the_band_open(units):
    """Worlds in which all or none of the units ended may be far out."""
    rng, held = np.random.default_rng(5), []
    least, most = special.ndtr(-1.4 + 2 * stats.norm.ppf([0.05, 0.95]))
    for _ in range(20):
        probits = -1.4 - 2 * rng.standard_normal((100, 1))
        ended = rng.random((100, units)) < special.ndtr(probits)
        points = DeconvolvedProbability(ended[..., None].astype(float), np.ones(1), INDEPENDENT)
        ends = (points(least), 0.95), (points(most), 0.05)
        held += [quantile.low < share < quantile.high for quantile, share in ends]
    assert np.mean(held) >= 0.85


@pytest.mark.parametrize("count", [10, 11, 50])
def test_a_band_whose_worlds_are_of_two_kinds_is_in_order(count):
    ds = rows(SHARED_Z)
    z = np.where(np.arange(100) < count, -3.0, 0.0)
    ds["life"].values *= np.exp((z - ds["z"].values) / 2)
    ds["z"].values[:] = z
    fleet = fleet_of(Result(ds), 50, [0.3, 1.0, 2.0], allow=3)
    for estimate in (*fleet.first.values(), *(each for two in fleet.by.values() for each in two)):
        assert estimate.low.value <= estimate.high.value
        for end in (estimate.low, estimate.high):
            assert not (end.value < end.low or end.value > end.high)
