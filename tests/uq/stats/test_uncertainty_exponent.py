"""How intermingled basins are: exponents that are known, and intervals that cover them."""

from itertools import combinations
from json import loads

import numpy as np
import pytest
from computed import asking, computed, kinds, linear, study_of
from scipy.optimize import brentq
from scipy.stats import binomtest

import uq as api
from benchmarks.coverage.basins import (
    CANTOR,
    KNOWN,
    SHAPES,
    cantor,
    cantor_exponent,
    estimates,
    flat,
)
from uq.assess.regimes import boundary, in_words
from uq.result.result import Result
from uq.stats.uncertainty_exponent import FARTHEST, uncertainty_exponent


@pytest.mark.parametrize("basins", KNOWN)
def test_known_exponents_are_found(basins):
    exponents = list(estimates(basins, (2000, 2), 8))
    expected = CANTOR if basins is cantor else KNOWN[basins](2)
    assert np.mean([exponent.value for exponent in exponents]) == pytest.approx(expected, abs=0.12)
    assert sum(exponent.low < expected < exponent.high for exponent in exponents) >= 6


def test_the_exponent_is_that_of_all_close_pairs():
    points = np.random.default_rng(4).random((300, 2))
    basin = (np.sin(20 * points[:, 0]) > points[:, 1]).astype(int)
    distance, apart, weight = [], [], []
    inside = (np.abs(points - 0.5) < 0.5 - FARTHEST).all(axis=1)
    for i, j in combinations(range(300), 2):
        largest = np.abs(points[i] - points[j]).max()
        if largest <= FARTHEST and inside[[i, j]].any():
            distance.append(np.log(largest))
            apart.append(basin[i] != basin[j])
            weight.append(inside[[i, j]].sum())
    distance, apart, weight = map(np.array, (distance, apart, weight))
    goal = np.average(distance[apart], weights=weight[apart])

    def excess(alpha):
        return np.average(distance, weights=weight * np.exp(alpha * distance)) - goal

    assert uncertainty_exponent(points, basin).value == pytest.approx(brentq(excess, -5, 5))


def test_points_of_different_kinds_are_not_compared():
    rng = np.random.default_rng(2)
    points, kind = rng.random((4000, 2)), rng.integers(2, size=4000)
    basin = flat(points, None) + 2 * kind
    assert uncertainty_exponent(points, basin).high < 0.1
    assert uncertainty_exponent(points, basin, kind).low > 0.5
    assert uncertainty_exponent(points[[*range(4000), 5]], basin[[*range(4000), 5]]).high < 0.1


def test_a_shift_of_labels_changes_nothing():
    points = np.random.default_rng(6).random((500, 2))
    basin = flat(points, None)
    assert uncertainty_exponent(points, 7 - basin) == uncertainty_exponent(points, basin)


def test_too_few_rows_near_a_boundary_are_refused():
    points = np.random.default_rng(2).random((60, 2))
    assert "have a close neighbour in another basin; 20 are needed" in (
        uncertainty_exponent(points, flat(points, None)).reason
    )
    far = np.random.default_rng(2).random((1000, 12))
    assert uncertainty_exponent(far, flat(far, None)).reason.startswith("only 0 rows")


@pytest.mark.slow
@pytest.mark.parametrize("basins", KNOWN)
@pytest.mark.parametrize("shape", SHAPES)
def test_intervals_cover_the_known_exponent(basins, shape):
    expected, exponents = KNOWN[basins](shape[1]), list(estimates(basins, shape, 1000))
    held = sum(exponent.low <= expected <= exponent.high for exponent in exponents)
    print(basins.__name__, shape, held)
    assert binomtest(held, 1000, 0.95).pvalue > 1e-3


@pytest.mark.slow
def test_the_exponent_of_cantors_set_is_near_that_of_the_limit():
    assert cantor_exponent(2) == pytest.approx(CANTOR, abs=0.03)


# Of a result


def test_every_reader_tells_how_intermingled_the_regimes_are(uq, tmp_path):
    ds = kinds(samples=2048, analysis={"outputs": ["regime"]})  # slow where x1 < 0.5
    exponent = boundary(Result(ds))
    assert exponent.estimate.low < 1.0 < exponent.estimate.high
    path = tmp_path / "kinds.nc"
    ds.to_netcdf(path)
    document = loads(uq("summary", str(path), "--json").out)["boundary"]["uncertainty_exponent"]
    assert (document["value"], document["low"], document["high"]) == exponent.estimate.numbers
    assert "reason" not in document
    shown = " ".join(uq("summary", str(path)).out.split())
    assert f"uncertainty exponent {exponent.words()} (" in shown
    assert "fewer outcomes are uncertain (50 % at a smooth boundary" in shown
    table = api.regimes(ds)
    ends = [float(table[f"uncertainty_exponent{end}"]) for end in ("", "_low", "_high")]
    assert tuple(ends) == exponent.estimate.numbers
    traced = api.trace(ds, "boundary/uncertainty_exponent")
    assert traced["equal"] and "Grebogi" in str(traced.to_dict())


def test_twice_as_well_known_inputs_leave_half_the_outcomes_of_a_smooth_boundary():
    exponent = boundary(Result(kinds(samples=2048)))
    value = 1 - 0.5 ** min(exponent.estimate.value, 1.0)
    assert f"{100 * value:.1f} % (" in in_words(exponent)


def test_what_the_rows_cannot_tell_has_a_reason():
    assert (
        "'halton' design are not independent"
        in boundary(Result(kinds("halton", 64))).estimate.reason
    )
    assert boundary(Result(linear())) is None
    only = kinds(samples=64)
    assert boundary(Result(only.isel(row=only["x1"].values < 0.4))) is None
    table = api.regimes(kinds("halton", 64))["uncertainty_exponent"]
    assert np.isnan(table) and "not independent" in table.attrs["reason"]


def test_inputs_with_listed_values_part_the_rows():
    listed = {"distribution": "discrete-choice", "values": [0.2, 0.8]}
    tables = {
        "study": {"name": "listed", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 64},
        "uncertain": {"x1": listed},
    }
    assert boundary(Result(computed(study_of(tables, "sample_models:KINDS")))).estimate.reason == (
        "no input varies continuously"
    )


def test_within_a_regime_nothing_is_said_of_boundaries(uq, tmp_path):
    path = tmp_path / "kinds.nc"
    asking(kinds(samples=512), outputs=["work"]).to_netcdf(path)
    assert "boundary" not in loads(uq("summary", str(path), "--regime", "slow", "--json").out)
