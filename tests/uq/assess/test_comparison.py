"""Comparisons of two results: intervals of differences, with pairs and without."""

import numpy as np
import pytest
from compared_studies import FOUR, NARROW, study
from computed import (
    UNIFORM,
    asking,
    compared,
    kinds,
    linear,
    summarised,
    with_output,
    with_status,
)
from scipy import stats

import uq as api
from uq.contract import Status
from uq.result.result import Result
from uq.stats.estimate import Estimate, difference
from uq.stats.intervals import wilson_interval
from uq.stats.moments import sd_interval


def width(row, estimate="mean"):
    line = row.loc[("y", estimate)]
    return line["high"] - line["low"]


def share(hits, rows):
    return Estimate(hits / rows, *wilson_interval(hits / rows, rows))


def test_a_difference_of_shares_has_the_published_interval():
    # Newcombe, Stat. Med. 17, 873 (1998), Table II, method 10.
    estimate = difference(share(48, 80), share(56, 70), 0.0)
    assert estimate.numbers == pytest.approx((0.2, 0.0524, 0.3339), abs=5e-5)
    estimate = difference(share(0, 10), share(10, 10), 0.0)
    assert estimate.numbers == pytest.approx((1.0, 0.6075, 1.0), abs=5e-5)


def test_a_difference_of_paired_shares_has_the_published_interval():
    # Newcombe, Stat. Med. 17, 2635 (1998), Table III, method 10: of 50 pairs 36 agree.
    first = np.repeat([1.0, 1.0, 0.0, 0.0], [36, 2, 12, 0])
    second = np.repeat([1.0, 0.0, 1.0, 0.0], [36, 2, 12, 0])
    ds = study(FOUR, samples=50)
    pair = [
        asking(with_output(ds, "hit", hits), thresholds={"hit": [0.5]}) for hits in (first, second)
    ]
    line = api.compare(*pair).loc[("hit", "P(>0.5)")]
    assert tuple(line[["difference", "low", "high"]]) == pytest.approx(
        (0.2, 0.0569, 0.3404), abs=5e-5
    )


@pytest.mark.parametrize("design", [{}, {"samples": 100, "replicates": 2}])
def test_pairs_of_rows_give_students_paired_test_and_allow_for_two_more_outliers(design):
    first, other = study(FOUR, **design), study(FOUR | {"x4": NARROW}, **design)
    line = api.compare(first, other).loc[("y", "mean")]
    test = stats.ttest_rel(other["y"].values, first["y"].values).confidence_interval()
    apart = other["y"].values - first["y"].values
    shift = 2 * (apart.max() + apart.min() - 2 * apart.mean()) / len(apart)
    widened = test.low + min(shift, 0.0), test.high + max(shift, 0.0)
    assert (line["low"], line["high"]) == pytest.approx(widened)
    assert line["difference"] == pytest.approx(float(other["y"].mean() - first["y"].mean()))


@pytest.mark.parametrize("estimate", ["mean", "sd", "quantile 0.5", "P(>4.0)"])
@pytest.mark.parametrize("design", [{}, {"method": "sobol", "samples": 32, "replicates": 8}])
def test_what_is_known_of_the_rows_decides_the_width(estimate, design):
    first, narrow = study(FOUR, **design), FOUR | {"x4": NARROW}
    pairs = width(api.compare(first, study(narrow, **design)), estimate)
    independent = width(api.compare(first, study(narrow, seed=8, **design)), estimate)
    assert pairs < independent


def test_paired_replicates_tell_a_quantile_apart_as_well_as_all_their_rows_do():
    # Twice the output: how far its quantile lies from the first is known as well as the first. The
    # replicates' own quantiles, of 32 rows each, would say something else.
    first = study(FOUR, method="sobol", samples=32, replicates=8)
    doubled = first.assign(y=first["y"] * 2)
    for p in ("0.05", "0.5", "0.95"):
        quantiles = compared(first, doubled)["outputs"]["y"]["quantiles"][p]
        apart, alone = (
            quantiles[side]["high"] - quantiles[side]["low"] for side in ("difference", "a")
        )
        assert apart == pytest.approx(alone, rel=1e-6)


def test_intervals_of_studies_that_share_a_seed_without_pairs_are_conservative():
    three = {name: law for name, law in FOUR.items() if name != "x3"}
    comparison = compared(study(FOUR), study(three))
    assert comparison["pairing"] == "unknown" and "different seeds" in comparison["notes"][0]
    output = comparison["outputs"]["y"]
    for entry in (output["mean"], output["sd"], output["quantiles"]["0.5"]):
        a, b, apart = entry["a"], entry["b"], entry["difference"]
        assert apart["high"] == pytest.approx(b["high"] - a["low"])
        assert apart["low"] == pytest.approx(b["low"] - a["high"])


def test_an_extended_study_shares_its_first_rows():
    first, other = study(FOUR), study(FOUR, samples=400)
    assert width(api.compare(first, other)) < width(
        api.compare(first, study(FOUR, samples=400, seed=3))
    )
    comparison = compared(first, other)
    assert [(c["name"], c["a"], c["b"]) for c in comparison["changed"]] == [
        ("samples", "200", "400")
    ]


def test_results_that_agree_have_no_interval_of_zero_width():
    for design in ({}, {"method": "sobol", "samples": 32, "replicates": 8}):
        table = api.compare(*[study(FOUR, **design)] * 2)
        assert (table["difference"] == 0).all()
        gap = (table["high"] - table["low"]).drop([("y", "mean"), ("y", "sd")])
        assert ((gap > 0) | gap.isna()).all()
    # The same scramble, a mean that Sobol' points integrate exactly: only rounding differs.
    pair = [
        study(FOUR | {"x4": law}, method="sobol", samples=64, replicates=8)
        for law in (UNIFORM, NARROW)
    ]
    assert np.isnan(width(api.compare(*pair)))


def test_each_side_is_what_its_own_summary_says():
    pair = [study(FOUR), study(FOUR | {"x4": NARROW}, samples=300)]
    statistics = compared(*pair)["outputs"]["y"]
    for key, ds in zip("ab", pair, strict=True):
        entry = summarised(ds)["outputs"]["y"]
        assert statistics["mean"][key] == {"value": entry["mean"], **entry["mean_interval"]}
        assert statistics["sd"][key]["value"] == entry["sd"]
        assert statistics["quantiles"]["0.5"][key] == entry["quantiles"]["0.5"]
        assert statistics["thresholds"]["4.0"]["above"][key] == entry["thresholds"]["4.0"]["above"]


def test_what_was_changed_is_named_and_what_it_bought():
    first = study(FOUR)
    comparison = compared(first, study(FOUR | {"x4": NARROW}))
    (change,) = comparison["changed"]
    assert change == {
        "kind": "input",
        "name": "x4",
        "a": "uniform(lower = 0.0, upper = 1.0)",
        "b": "uniform(lower = 0.3, upper = 0.7)",
    }
    assert comparison["only"]["name"] == "x4"
    assert comparison["only"]["sd"]["b"] == pytest.approx(0.4 * comparison["only"]["sd"]["a"])
    ratio = comparison["outputs"]["y"]["sd"]["ratio"]
    truth = ((1 + 4 + 9 + 0.16 * 16) / 30) ** 0.5
    assert ratio["low"] < truth < ratio["high"] and ratio["high"] - ratio["low"] < 0.12
    sourced = study(FOUR | {"x4": UNIFORM | {"source": "found in a drawer"}})
    assert not compared(first, sourced)["changed"]
    fixed = {name: law for name, law in FOUR.items() if name != "x4"}
    comparison = compared(
        first, study(fixed, {"fixed": {"x4": 0.25}, "settings": {"fail_above": 0.9}})
    )
    assert [(c["kind"], c["name"], c["b"]) for c in comparison["changed"]] == [
        ("setting", "fail_above", "0.9"),
        ("input", "x4", "0.25"),
    ]
    assert comparison["only"] is None  # the setting changes outputs too
    both = study(FOUR | {"x4": NARROW, "x3": NARROW})
    assert compared(first, both)["only"] is None


def test_ties_and_rank_correlations_are_stated():
    first = study({"x1": UNIFORM, "x2": UNIFORM})
    tied = study({"x1": UNIFORM, "x2": {"equals": "x1"}})
    assert compared(first, tied)["changed"][0]["b"] == "equals x1"
    together = {"parameters": ["x1", "x2"], "rank_correlation": [[1.0, 0.5], [0.5, 1.0]]}
    comparison = compared(first, study({"x1": UNIFORM, "x2": UNIFORM}, {"dependence": together}))
    assert [(c["kind"], c["b"]) for c in comparison["changed"]] == [("dependence", "x1, x2")]
    assert comparison["only"] is None
    gumbel = study({"x1": UNIFORM, "x2": UNIFORM}, {"dependence": together | {"copula": "gumbel"}})
    (change,) = compared(first, gumbel)["changed"]
    assert (change["kind"], change["b"]) == ("dependence", "x1, x2 (Gumbel copula, 0.5)")


def test_rows_that_never_end_or_fail_are_no_numbers():
    never = with_output(linear(samples=64), "life", np.full(64, np.inf), "lifetime")
    ends = with_output(linear(samples=64), "life", np.linspace(1, 2, 64), "lifetime")
    never, ends = asking(never, outputs=["life"]), asking(ends, outputs=["life"])
    statistics = compared(never, ends)["outputs"]["life"]
    assert statistics["quantiles"]["0.5"]["a"]["never"] and statistics["mean"]["a"]["value"] is None
    nothing = {"value": None, "low": None, "high": None}
    assert statistics["quantiles"]["0.5"]["difference"] == statistics["sd"]["ratio"] == nothing
    lost = with_status(
        with_output(ends, "life", np.full(64, np.nan), "lifetime"), slice(None), Status.RAISED
    )
    lost = asking(lost, outputs=["life"])
    comparison = compared(ends, lost)
    assert comparison["b"]["status"] == {"ok": 0, "raised": 64}
    assert comparison["outputs"]["life"]["b_lives"]["B10"]["difference"] == nothing
    assert np.isnan(api.compare(ends, lost)["difference"]).all()


def test_regimes_and_elements_that_both_have_are_compared():
    comparison = compared(kinds(samples=100), kinds(samples=200))
    assert list(comparison["regime"]) == ["slow", "fast"]
    assert (
        comparison["regime"]["slow"]["a"]["count"] + comparison["regime"]["fast"]["a"]["count"]
        == 100
    )
    assert "life[side=left,depth=0.5]" in comparison["outputs"]
    assert list(api.compare(kinds(samples=50), kinds(samples=50)).index[0]) == ["regime", "slow"]


def test_the_interval_of_a_scatter_suits_laws_with_heavy_and_light_tails():
    rng = np.random.default_rng(1)
    for law in (stats.uniform(), stats.norm(), stats.expon()):
        held = 0
        for _ in range(400):
            low, high = sd_interval(law.rvs(200, random_state=rng))
            held += low < law.std() < high
        assert 0.91 < held / 400 < 0.98
    assert np.isnan(sd_interval(np.ones(50))).all() and np.isnan(sd_interval(np.arange(3.0))).all()


SOBOL = {"method": "sobol", "samples": 64, "replicates": 8}
PLAIN = {"samples": 200}
CASES = {
    "strangers": (PLAIN, PLAIN, 10_000),
    "pairs": (PLAIN, PLAIN, 0),
    "extended": (PLAIN, {"samples": 400}, 0),
    "replicates, strangers": (SOBOL, SOBOL, 10_000),
    "replicates, pairs": (SOBOL, SOBOL, 0),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_differences_hold_the_truth_as_often_as_they_say(case):
    design, other_design, apart = CASES[case]
    laws = FOUR, FOUR | {"x4": NARROW}
    many = {"method": "sobol", "samples": 2**18}
    truth = api.compare(*(study(law, **many) for law in laws))
    held = {key: [] for key in truth.index}
    for seed in range(200):
        table = api.compare(
            study(laws[0], seed=seed, **design),
            study(laws[1], seed=seed + apart, **other_design),
        )
        for key, line in table.iterrows():
            if np.isfinite(line["low"]) and np.isfinite(line["high"]):
                held[key].append(line["low"] <= truth.loc[key, "difference"] <= line["high"])
    for key, covers in held.items():
        # Sobol' points integrate this mean to rounding: what is left of its difference is no error
        # of sampling.
        if not ("replicates" in case and key[1] == "mean"):
            print(f"{case:24} {key[1]:16} {np.mean(covers):6.1%} of {len(covers)}")
            assert np.mean(covers) >= 0.9 and len(covers) > 150, key


def test_a_smaller_scatter_of_paired_skewed_rows_is_covered():
    """The tail of the law that is narrowed does not cancel: exp(a) and exp(a / 2), a normal."""
    rows, rng = 200, np.random.default_rng(5)
    plain = linear(samples=rows)
    truths = [(np.exp(s**2 / 2), np.sqrt(np.expm1(s**2)) * np.exp(s**2 / 2)) for s in (1.0, 0.5)]
    wanted = [after - before for before, after in zip(*truths, strict=True)]
    covered = []
    for _ in range(60):
        a = rng.standard_normal(rows)
        pair = [Result.of(with_output(plain, "level", np.exp(s * a))) for s in (1.0, 0.5)]
        table = api.compare(*pair)
        ends = [table.loc[("level", name), ["low", "high"]] for name in ("mean", "sd")]
        covered.append([low <= t <= high for (low, high), t in zip(ends, wanted, strict=True)])
    shares = np.mean(covered, axis=0)
    assert shares[0] >= 0.93 and shares[1] >= 0.88
