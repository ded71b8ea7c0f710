"""What scales lives is integrated on its level, inside each unit or outside the product."""

import re

import numpy as np
import pytest
from computed import computed, study_of
from fleet_studies import LISTED, OWN, SHARED, brute_force, fleet_result, lognormal
from scipy import special, stats

from benchmarks.coverage import fleets as counted
from uq.assess.fleet import fleet_of
from uq.assess.fleet_units import units_of
from uq.result.elements import elements_of
from uq.result.result import Result
from uq.sampling.copulas import copula_of_rank
from uq.stats.counting import at_most
from uq.stats.dependent_rows import INDEPENDENT


def test_the_first_of_many_by_brute_force():
    """The first of 40,000 units, exactly, and drawn one by one in 400 other worlds."""
    first = fleet_of(Result(fleet_result(samples=2000)), 40_000).first[0.5]
    rng = np.random.default_rng(1)
    depths = np.array([rng.standard_normal(40_000).min() for _ in range(400)])
    lives = 1e6 * np.exp(OWN * depths - SHARED * rng.standard_normal(400))
    low, high = np.sort(lives)[stats.binom(400, 0.5).ppf([0.001, 0.999]).astype(int)]
    assert low < first.estimate.value < high
    reached = -np.expm1(np.log(0.5) / 40_000)
    for share, end in ((0.05, first.low), (0.95, first.high)):
        truth = 1e6 * np.exp(OWN * special.ndtri(reached) + SHARED * stats.norm.ppf(share))
        assert end.low < truth < end.high


def test_units_and_the_exact_law_agree():
    """Fleets counted from units, and exactly from the same samples."""
    exact = fleet_of(Result(fleet_result(units=20)), 5, [5e5], allow=1)
    ds = fleet_result(units=20)
    element = next(elements_of(ds, ["life"]))
    units = units_of(Result(ds), element)
    assert (units.integrated, units.varying) == (("depth",), ())
    p = element.below(5e5).reshape(200, 20, 1)
    counted_kept = at_most(p, 5, 1).mean()
    assert exact.by[5e5][1].estimate.value == pytest.approx(counted_kept, abs=0.02)
    assert exact.by[5e5][0].estimate.value == pytest.approx(5 * p.mean(), abs=0.1)


@pytest.mark.slow
def test_what_is_shared_is_integrated_outside_the_product():
    """With all scatter integrated the probability is exact, in each world the same."""
    model = {"study": {"name": "fleet", "model": "scaled"}, "analysis": {"outputs": ["life"]}}
    tables = model | {"uncertain": {}}
    study = study_of(
        tables
        | {
            "design": {"method": "monte-carlo", "samples": 30, "seed": 3},
            "uncertain": {"a": lognormal(OWN, 1.0), "b": lognormal(SHARED, 1.0, level="shared")},
        },
        "sample_models:SCALED",
    )
    ds = computed(study)
    element = next(elements_of(ds, ["life"]))
    exponents = element.declared.scales
    units = units_of(Result(ds), element)
    assert units.integrated == ("a", "b")
    spread, shared = abs(exponents["a"]) * OWN, abs(exponents["b"]) * SHARED
    drawn = sum(exponents[name] * np.log(ds[name].values) for name in ("a", "b"))
    typical = float(np.exp(np.log(ds["life"].values) - drawn)[0])
    time = typical * np.exp(-1.0)
    z = np.linspace(-8, 8, 4001)
    p = special.ndtr((-1.0 - shared * z) / spread)
    truth = np.average(special.bdtr(2, 100, p), weights=np.exp(-(z**2) / 2))
    kept = fleet_of(Result(ds), 100, [time], allow=2).by[time][1]
    assert kept.estimate.value == pytest.approx(truth, abs=1e-6)
    assert "exact" in kept.estimate.reason
    best = special.bdtr(2, 100, special.ndtr((-1.0 - shared * stats.norm.ppf(0.95)) / spread))
    assert kept.high.value == pytest.approx(best, abs=1e-3)


def scaled_fleet(inputs, samples=12, units=4, repeats=1, **tables):
    """Return units whose lives are a b^-2 c^(1/2) exp(z/2)."""
    design = {"method": "monte-carlo", "samples": samples, "seed": 3}
    study = {
        "study": {"name": "fleet", "model": "scaled"},
        "design": design | {"units": units, "repeats": repeats},
        "uncertain": inputs,
        "analysis": {"outputs": ["life"]},
    }
    return computed(study_of(study | tables, "sample_models:SCALED"))


NORMAL = {"distribution": "normal", "mean": 0.0, "sd": 0.5}


B_SHARED = lognormal(SHARED, 1.0, level="shared")


TIED = {"parameters": ["b", "c"], "rank_correlation": [[1.0, 0.6], [0.6, 1.0]]}


BESIDE = {
    "own": {"z": NORMAL},
    "own and chance": {"z": NORMAL, "c": LISTED | {"level": "chance"}},
    "shared": {"z": NORMAL | {"level": "shared"}},
    "own, and scaling": {"z": NORMAL, "a": lognormal(OWN, 1.0)},
    "chance, and scaling": {"z": NORMAL, "c": lognormal(OWN, 1.0, level="chance")},
    "all": {
        "z": NORMAL | {"level": "chance"},
        "a": lognormal(OWN, 1.0),
        "c": lognormal(OWN, 1.0, level="chance"),
    },
}


@pytest.mark.parametrize("beside", list(BESIDE.values()), ids=list(BESIDE))
@pytest.mark.parametrize("allow", [0, 1])
def test_each_level_is_integrated_where_it_belongs(beside, allow):
    """Against sums over all fleets of each world, at many values of the shared input."""
    repeats = 2 if "c" in beside else 1
    size, ds = 3, scaled_fleet(beside | {"b": B_SHARED}, samples=6, repeats=repeats)
    inside = {name: {"a": 1.0, "c": 0.5}[name] for name in beside if beside[name].get("sigma")}
    spread = OWN * np.hypot.reduce(list(inside.values())) if inside else 1e-12
    rest = np.log(ds["life"].values) + 2 * np.log(ds["b"].values)
    rest -= sum(exponent * np.log(ds[name].values) for name, exponent in inside.items())
    time = float(np.median(ds["life"].values))
    z = np.linspace(-6, 6, 401)
    kept = [
        brute_force(special.ndtr((np.log(time) - log_life) / spread).mean(1), size, allow)
        for at in z
        for log_life in rest.reshape(6, 4, repeats) - 2 * SHARED * at
    ]
    truth = np.average(np.reshape(kept, (-1, 6)).mean(axis=1), weights=np.exp(-(z**2) / 2))
    units = units_of(Result(ds), next(elements_of(ds, ["life"])))
    assert set(units.integrated) == {"b", *inside}
    integrals = units.fleet(size, allow, INDEPENDENT)
    assert integrals.below(time).value == pytest.approx(1 - truth, abs=5e-3)
    assert integrals.below(integrals.middle(0.3)).value == pytest.approx(0.3, abs=1e-9)


def test_bands_of_units_that_end_together():
    """With nothing own, the life of all units has the law of what they share."""
    ds = scaled_fleet({"b": B_SHARED, "z": NORMAL | {"level": "shared"}}, samples=400, units=1)
    rest = np.exp(ds["z"].values / 2)
    first = fleet_of(Result(ds), 1000, [1.0]).first[0.5]
    for estimate, share in ((first.low, 0.05), (first.estimate, 0.5), (first.high, 0.95)):
        below = special.ndtr(np.log(estimate.value / rest) / (2 * SHARED)).mean()
        assert below == pytest.approx(share, abs=1e-4)
        truth = np.exp(np.hypot(2 * SHARED, 0.25) * special.ndtri(share))
        assert estimate.low < truth < estimate.high


@pytest.mark.slow
def test_a_shared_input_that_depends_on_another_is_integrated():
    """Given the other, whether the units' own inputs are integrated or counted."""
    shared = {"b": B_SHARED, "c": B_SHARED}
    correlation = 2 * np.sin(np.pi * 0.6 / 6)
    wide = SHARED * np.sqrt(4 + 0.25 - 2 * correlation)
    tables = {"dependence": TIED}
    for unit_laws in ({"z": NORMAL}, {"a": lognormal(OWN, 1.0)}):
        ds = scaled_fleet(unit_laws | shared, samples=300, units=3, **tables)
        fleet = fleet_of(Result(ds), 2, [1.0])
        assert "b" in fleet.integrated
        spread = OWN if "a" in unit_laws else 0.25
        z = np.linspace(-6, 6, 2001)
        p = special.ndtr(wide * z / spread)
        truth = np.average((1 - p) ** 2, weights=np.exp(-(z**2) / 2))
        kept = fleet.by[1.0][1].estimate
        assert kept.low < truth < kept.high
        assert kept.high - kept.low < 0.12


@pytest.mark.slow
def test_a_shared_input_is_integrated_given_another_by_their_copula():
    """Against quadrature over both shared inputs."""
    shared = {"b": B_SHARED, "c": B_SHARED}
    tables = {"dependence": TIED | {"copula": "clayton"}}
    copula = copula_of_rank("clayton", 0.6)
    ds = scaled_fleet({"a": lognormal(OWN, 1.0)} | shared, samples=300, units=3, **tables)
    fleet = fleet_of(Result(ds), 2, [1.0])
    assert "b" in fleet.integrated
    z = np.linspace(-6, 6, 401)
    weight = np.exp(-(z**2) / 2)
    kept = []
    for at in z:
        c = special.ndtri(
            copula.conditional_quantile(special.ndtr(z), np.full(401, special.ndtr(at)))
        )
        p = special.ndtr(SHARED * (2 * at - c / 2) / OWN)
        kept.append(np.average((1 - p) ** 2, weights=weight))
    truth = np.average(kept, weights=weight)
    estimate = fleet.by[1.0][1].estimate
    assert estimate.low < truth < estimate.high
    assert estimate.high - estimate.low < 0.12


def test_what_is_not_integrated_says_why():
    for inputs, tables, words in (
        ({"b": B_SHARED, "a": lognormal(0.005, 1.0)}, {}, "b not integrated: it scatters .* a"),
        (
            {"b": LISTED | {"values": [0.5, 1.0, 2.0], "level": "shared"}},
            {},
            "b not integrated: its law is one of listed",
        ),
        ({"b": B_SHARED}, {"settings": {"horizon": 1.5}}, "b not integrated: .* are censored"),
    ):
        notes = fleet_of(Result(scaled_fleet({"z": NORMAL} | inputs, **tables)), 2, [0.1]).notes
        assert any(re.match(words, note) for note in notes), notes


@pytest.mark.slow
def test_intervals_of_fleets_with_a_shared_scale_hold_the_truth():
    assert [line for line in counted.shared_scale(1000) if line.unexplained] == []
