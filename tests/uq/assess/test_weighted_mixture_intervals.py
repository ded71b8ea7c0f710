"""Intervals of populations of laws: few rows, replicates, samples of several rows, outliers."""

import numpy as np
import pytest
from computed import computed, summarised, with_seed
from scaled_studies import NORMAL, WHOLE, lognormal, populated, scaled_study
from scipy import special, stats

from uq.assess.comparison import compare
from uq.assess.integrated_inputs import elements_with_laws
from uq.assess.weighted_mixture import WeightedMixture
from uq.contract import Output
from uq.result.element import Element
from uq.result.result import Result
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.estimate import difference
from uq.stats.importance_weights import effective_rows, smoothed
from uq.stats.weighted_means import (
    EXACT,
    FEW,
    moments_of_rows,
    share_to_compare,
    weighted_moments,
    weighted_share,
)


def test_the_difference_of_two_probabilities_is_not_widened_for_outliers_twice():
    """Both are skewed to the same side; each alone has a wider interval."""
    rare = {"analysis": {"outputs": ["life"], "thresholds": {"life": [0.2]}}}
    first, second = (computed(with_seed(scaled_study(WHOLE, **rare), seed)) for seed in (1, 2))
    key = ("life", "P(<0.2)")
    row = compare(first, second).loc[key]
    numbers = [next(elements_with_laws(Result(ds), ["life"])).below(0.2) for ds in (first, second)]
    expected = difference(*map(share_to_compare, numbers), 0.0)
    assert (row["low"], row["high"]) == pytest.approx((expected.low, expected.high))
    alone = difference(*map(weighted_share, numbers), 0.0)
    assert row["high"] - row["low"] < 0.95 * (alone.high - alone.low)


def test_failed_rows_still_give_bounds():
    ds = computed(scaled_study(WHOLE, settings={"fail_above": 1.5}))
    below = summarised(ds)["outputs"]["life"]["thresholds"]["1.0"]["below"]
    assert below["failed_low"] < below["low"] < below["high"] < below["failed_high"]


def test_few_replicates_of_nested_samples_are_not_few_rows():
    design = {"method": "sobol", "replicates": 4, "units": 2}
    probability = populated(computed(scaled_study(WHOLE, design, samples=32)))[0].below(1.0)
    assert probability.low < 0.5 < probability.high and probability.high - probability.low < 0.2


def test_rows_that_all_failed_have_no_worth():
    ds = computed(scaled_study(WHOLE, samples=10, settings={"fail_above": -99.0}))
    assert summarised(ds)["outputs"]["life"]["failed"] == 10


def test_probabilities_of_one_but_for_rounding_are_not_exact():
    """Rows that all end show no more than that a longer life is rare."""
    share = weighted_share(np.full(16, 1 - 2.0**-53))
    assert share.value == share.high == 1.0 and 0.7 < share.low < 0.85 and not share.reason
    assert weighted_share(np.full(16, 1e-9)).reason == EXACT


def test_replicates_give_the_interval_of_other_designs():
    design = {"method": "sobol", "replicates": 8}
    rows, _ = populated(computed(scaled_study(WHOLE, design, samples=64)))
    probability = rows.below(1.0)
    assert probability.low < 0.5 < probability.high and probability.high - probability.low < 0.02
    alone, _ = populated(computed(scaled_study(WHOLE, {"method": "sobol"}, samples=64)))
    assert np.isnan(alone.below(1.0).low)


def test_rows_that_differ_in_nothing_else_are_exact():
    rows, _ = populated(computed(scaled_study({"a": lognormal(0.5)})))
    quantile = rows.quantile(0.1)
    assert quantile.value == pytest.approx(np.exp(0.5 * stats.norm.ppf(0.1)), rel=1e-9)
    assert quantile.reason == EXACT


def test_a_mean_that_few_rows_carry_is_not_trusted():
    """Where no row is likely to end, the interval is that of no hit in so many rows."""
    numbers = np.full(50, 1e-12)
    numbers[0] = 1e-6
    assert effective_rows(numbers) < FEW
    share = weighted_share(numbers)
    assert share.low < 1e-300 and share.high == pytest.approx(1 - 0.025 ** (1 / 50), rel=1e-4)


@pytest.mark.parametrize("hits", [15, 185])
def test_intervals_move_no_faster_than_the_weights_do(hits):
    """As a slider moves, from weights of which few count to equal ones."""
    rest = np.random.default_rng(7).standard_normal(200)
    numbers = special.ndtr(3 * (rest - np.sort(rest)[hits]))
    lines = [weighted_share(numbers, np.exp(x * rest)) for x in np.linspace(-1.5, 1.5, 1001)]
    steps = np.abs(np.diff([estimate.numbers for estimate in lines], axis=0)).max(axis=0)
    assert (steps[1:] < 5 * steps[0]).all(), steps


@pytest.mark.parametrize(
    ("probability", "end", "needed"), [(0.05, "lower", 72), (0.99, "upper", 368)]
)
def test_a_quantile_with_one_end_says_how_many_rows_give_the_other(probability, end, needed):
    def of(samples):
        study = scaled_study({"a": lognormal(0.5), "z": NORMAL}, samples=samples)
        return populated(computed(study))[0].quantile(probability)

    few = of(30)
    assert few.reason == f"no {end} end: 30 effective rows, and {needed} are required"
    assert np.isnan(few.low) == (end == "lower") and np.isnan(few.high) == (end == "upper")
    assert of(needed).has_interval and not of(needed).reason


@pytest.mark.parametrize(("probability", "end"), [(0.01, "lower"), (0.99, "upper")])
def test_the_outermost_row_is_no_end_of_a_quantile_that_may_lie_beyond_all_rows(probability, end):
    """All of 50 rows lie on one side of such a quantile in six of ten samples."""
    nothing, weights = np.zeros(50, dtype=bool), np.linspace(0.9, 1.1, 50)
    values = np.linspace(1.0, 2.0, 50)
    element = Element("y", "y", Output("", "y"), {}, values, nothing, nothing, None, weights)
    quantile = WeightedMixture(element).quantile(probability)
    ends = {"lower": quantile.low, "upper": quantile.high}
    assert np.isnan(ends.pop(end)) and np.isfinite([*ends.values()]).all()
    assert quantile.reason.startswith(f"no {end} end: ")


def test_samples_of_several_rows_count_once():
    rng = np.random.default_rng(1)
    shared = np.repeat(rng.random(60), 20)
    numbers = np.clip(shared + 0.01 * rng.random(1200), 0, 1)
    of = Dependence(np.repeat(np.arange(60), 20), samples=60, are_samples=True)
    wide, narrow = (weighted_share(numbers, dependence=rows) for rows in (of, INDEPENDENT))
    assert wide.high - wide.low > 4 * (narrow.high - narrow.low)


@pytest.mark.slow
@pytest.mark.parametrize("spread", [0.2, 1.0, 5.0])
@pytest.mark.parametrize("rows", [30, 300])
def test_intervals_hold_the_truth(spread, rows):
    """Each end misses in at most 5 % of samples, whatever share of the scatter is integrated."""
    rng = np.random.default_rng(2)
    for p in (1e-4, 0.01, 0.1, 0.5, 0.99):
        y = np.hypot(1, spread) * stats.norm.ppf(p)
        misses = np.zeros(2)
        for _ in range(400):
            rest = spread * rng.standard_normal(rows)
            share = weighted_share(special.ndtr(y - rest))
            misses += share.low > p, share.high < p
        assert (misses <= 0.05 * 400 + 8).all(), (p, misses)


def test_replicates_without_a_heavy_row_do_not_show_their_error():
    """Of an exponential law, weighted to one with a mean 1.3 times as large."""
    replicate, random = np.repeat(np.arange(8), 128), np.random.default_rng(1)
    covered = []
    for _ in range(100):
        order = np.concatenate([random.permutation(128) for _ in range(8)])
        x = -np.log1p(-(order + random.random(1024)) / 128)
        weights = np.exp(x * (1 - 1 / 1.3))
        moments = moments_of_rows(x, weights, Dependence(replicate, x[:, None]))
        covered.append([estimate.low <= 1.3 <= estimate.high for estimate in moments])
    assert np.mean(covered, axis=0).min() >= 0.9


def test_a_mean_is_not_shown_just_where_its_tail_is_missing():
    """Of a b + 0.2 c^3 under shifted a and b: whether it is shown depends on the weights alone."""
    rng, held, shown = np.random.default_rng(15), 0, 0
    for _ in range(200):
        a, b, c = rng.standard_normal((3, 500))
        weights = smoothed(0.9 * a - 0.5 * b).weights
        mean, _ = weighted_moments(a * b + 0.2 * c**3, weights)
        shown += mean.has_interval
        held += mean.low <= -0.45 <= mean.high
    assert shown >= 195 and held >= 0.92 * shown
