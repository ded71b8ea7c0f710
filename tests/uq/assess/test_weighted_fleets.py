"""Fleets and shares of levels in worlds that inspections have weighted."""

import json

import numpy as np
import pytest
from computed import asking
from learnt_studies import DEPTH, exactly, measured, wear
from scipy import stats

import uq as api
from uq.assess.fleet import fleet_of
from uq.assess.level_shares import by_level
from uq.errors import InputError
from uq.explore.updating import update
from uq.learning.posterior_result import as_unit
from uq.result.result import Result
from uq.stats.variance_components import nested_shares

CV, TIME = 0.1, 6e5
LIVES = np.array([6e5, 7e5, 5e5])


@pytest.fixture(scope="module")
def posterior():
    """Return worlds whose shared rate three inspected units have weighted."""
    ds = update(wear(2000, seed=5, rate="shared", units=4), measured(*LIVES, cv=CV))
    assert np.ptp(ds["weight"].values) > 0
    return ds


@pytest.fixture(scope="module")
def rate():
    """Return mean and standard deviation of the logarithm of the rate, in closed form."""
    mean, cov = exactly(LIVES, CV, shared_rate=True)
    return mean[0], cov[0, 0] ** 0.5


def ended(rate, z):
    """Return P(a unit ends before the time) where the rate is z standard deviations off."""
    return stats.norm.cdf((np.log(TIME / DEPTH[0]) + rate[0] + rate[1] * z) / DEPTH[1])


def over_worlds(function):
    z = np.linspace(-7, 7, 2001)
    return np.average(function(z), weights=np.exp(-(z**2) / 2))


def holds(estimate, truth):
    assert estimate.low < truth < estimate.high, (estimate, truth)
    return True


@pytest.mark.parametrize("size", [3, 40_000])
def test_fleets_of_units_never_inspected_are_those_of_the_closed_form(posterior, rate, size):
    fleet = fleet_of(Result(posterior), size, [TIME], allow=size // 3)
    assert fleet.integrated == ("depth",) and 100 < fleet.weights.effective < 1000
    failed, kept = fleet.by[TIME]
    holds(failed.estimate, size * over_worlds(lambda z: ended(rate, z)))
    at_most = over_worlds(lambda z: stats.binom.cdf(size // 3, size, ended(rate, z)))
    holds(kept.estimate, at_most)
    for end, z in ((failed.low, -1.6449), (failed.high, 1.6449)):
        holds(end, size * ended(rate, z))
        assert end.high - end.low < 0.4 * size


def test_units_of_weighted_worlds_may_be_counted(posterior, rate):
    failed, kept = fleet_of(Result(posterior), 3, [TIME], plain=True).by[TIME]
    holds(kept.estimate, over_worlds(lambda z: (1 - ended(rate, z)) ** 3))
    for end, z in ((failed.low, -1.6449), (failed.high, 1.6449)):
        holds(end, 3 * ended(rate, z))


@pytest.mark.parametrize("plain", [False, True])
def test_shares_of_levels_are_those_left_by_the_inspections(posterior, rate, plain):
    share = by_level(Result(posterior), plain=plain).outputs["log(life)"].shares["shared"]
    holds(share, rate[1] ** 2 / (rate[1] ** 2 + DEPTH[1] ** 2))
    assert share.high < 0.5  # before: 0.74


def test_the_effective_number_of_samples_is_stated(uq, posterior, folder):
    posterior.to_netcdf("posterior.nc")
    for verb in ("fleet posterior.nc --size 3", "levels posterior.nc"):
        assert "2000 samples, worth" in uq(*verb.split()).out
        told = json.loads(uq(*verb.split(), "--json").out)
        assert 100 < told["effective_rows"] < 1000 and told["pareto_k"] < 0.7
    assert api.fleet(posterior, 3).attrs["effective_rows"] == told["effective_rows"]
    assert api.levels(posterior).attrs["effective_rows"] == told["effective_rows"]


def test_equal_weights_change_nothing():
    values = np.random.default_rng(1).standard_normal((30, 4, 3)) + np.arange(30)[:, None, None]
    assert nested_shares(values, weights=np.ones(30)) == nested_shares(values)
    for factor in (0.5, 3.0):
        shares = nested_shares(values, weights=np.full(30, factor))
        assert shares.outer.numbers == pytest.approx(nested_shares(values).outer.numbers)


def test_a_weight_of_zero_is_no_sample():
    values = np.random.default_rng(2).standard_normal((30, 4, 3)) + np.arange(30)[:, None, None]
    kept = np.arange(30) % 3 > 0
    shares = nested_shares(values, weights=kept.astype(float))
    assert shares.left_out == 0
    for share, other in zip(shares[:3], nested_shares(values[kept])[:3], strict=True):
        assert share.numbers == pytest.approx(other.numbers)


def test_an_event_that_the_inspections_make_rare_has_no_shares(posterior):
    """Rows have hits, but hardly any weight."""
    early = asking(posterior, outputs=["life"], thresholds={"life": [2e5]})
    hits = (posterior["life"].values < 2e5).sum()
    shares = by_level(Result(early)).outputs["P(life<200000.0)"].shares
    assert hits > 10 and "hits of equal weight, and 5 are needed" in shares["shared"].reason


@pytest.mark.parametrize(
    "question",
    [lambda ds: fleet_of(Result(ds), 1), lambda ds: by_level(Result(ds))],
    ids=["fleet", "levels"],
)
def test_an_inspected_unit_is_no_fleet(posterior, question):
    with pytest.raises(InputError, match="these rows represent unit 'A'; use the whole posterior"):
        question(as_unit(posterior, "A"))
