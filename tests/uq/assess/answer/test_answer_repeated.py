"""What the answer says of another seed, against studies with other seeds."""

import numpy as np
import pytest
from answered import lifetime, numbers
from computed import asking, kinds, linear, with_output

from uq.assess.answer.answer import answer
from uq.assess.answer.contributions import Contribution
from uq.assess.answer.rankings import Ranking
from uq.assess.answer.repeat_interval import found_again, repeated_quantile
from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.answer.wording import DisplayUnit
from uq.stats import order_statistics
from uq.stats.estimate import Estimate
from uq.stats.intervals import share_interval

SEEDS = 2000


def held(estimates, is_positive):
    """Return how often the estimate from one seed lies where that from another says."""
    both = zip(estimates[::2], estimates[1::2], strict=True)
    ends = [(*found_again(estimate, is_positive), other.value) for estimate, other in both]
    return np.mean([low <= value <= high for low, high, value in ends])


def test_other_seeds_find_a_quantile_where_the_answer_says():
    lives = np.random.default_rng(1).lognormal(size=(SEEDS, 400))
    estimates = [
        Estimate(order_statistics.quantile(x, 0.1), *order_statistics.quantile_interval(x, 0.1))
        for x in lives
    ]
    assert 0.93 < held(estimates, True) < 0.98


def test_other_seeds_find_a_share_where_the_answer_says():
    rows = np.random.default_rng(2).uniform(size=(SEEDS, 300)) < 0.2
    estimates = [Estimate(float(hits.mean()), *share_interval(hits)) for hits in rows]
    assert 0.93 < held(estimates, False) < 0.98


def test_an_estimate_without_an_interval_says_nothing_of_other_seeds():
    assert all(map(np.isnan, found_again(Estimate(1.0), True)))
    (quantity,) = answer(asking(linear(samples=5), outputs=["y"])).quantities
    assert "expected" not in quantity.repeated.members and quantity.repeated.mentions == ()


def test_the_quantile_and_the_input_that_contributes_most_are_said():
    _, conclusions = lifetime()
    low, high = numbers(
        r"In a repeat with another seed, the 5 % quantile would be # to # days \(95 %\);"
        r" rate would again contribute most\.",
        conclusions.lead.repeated.sentence,
    )
    quantile, day = conclusions.lead.tolerance_bound.quantiles[0], 86400.0
    ends = [
        quantile.value * (end / quantile.value) ** 2**0.5 / day
        for end in (quantile.low, quantile.high)
    ]
    assert [low, high] == pytest.approx(ends, rel=5e-3)
    sentence = conclusions.lead.repeated.sentence
    assert f"Sample size is sufficient: i{sentence[1:]}" in conclusions.lines


def test_where_nothing_is_promised_the_share_is_said():
    lives = np.where(np.arange(200) < 150, 1.0 + np.arange(200), np.inf)
    ds = with_output(linear(samples=200), "locking", lives, "lifetime")
    ds["locking"].attrs["success"] = "the motors have locked"
    lead = answer(asking(ds, outputs=["locking"], thresholds={"locking": 100.0})).lead
    low, high = numbers(
        r"In a repeat with another seed, # to # % would succeed before 100 s \(95 %\).*",
        lead.repeated.sentence,
    )
    share = lead.first.share
    ends = [share.value + 2**0.5 * (end - share.value) for end in (share.low, share.high)]
    assert [low, high] == pytest.approx([100 * end for end in ends], abs=0.06)


@pytest.mark.slow
def test_other_seeds_rank_first_one_of_the_inputs_that_are_named():
    """x4 explains 16/30 of the variance, x3 9/30."""
    studies = [linear(samples=250, seed=seed) for seed in range(40)]
    rankings = [answer(asking(ds, outputs=["y"])).lead.ranking for ds in studies]
    leaders = [ranking.contributions[0].inputs[0] for ranking in rankings if ranking.contributions]
    named = [ranking.rivals for ranking in rankings if ranking.rivals]
    assert named and set(leaders) <= {"x4", "x3"}
    assert np.mean([leader in names for leader in leaders for names in named]) > 0.95


def test_ends_that_look_alike_are_one_number_and_names_are_a_list():
    unit = DisplayUnit("rad s⁻¹")
    quantiles = Estimate(154.0, 153.9, 154.1), Estimate()
    tolerance_bound = ToleranceBound(0.95, 0.95, np.nan, np.nan, unit, quantiles)
    assert repeated_quantile(tolerance_bound, None, None).sentence == (
        "In a repeat with another seed, the 5 % quantile would again be 154 rad s⁻¹ (95 %)."
    )
    index = Estimate(0.5, 0.4, 0.6)
    leader = Contribution(("a",), (index,), True)
    ranking = Ranking("y", "sobol", contributions=(leader,), rivals=("a_1", "b", "c"))
    sentence = repeated_quantile(None, None, ranking).sentence
    assert sentence == "In a repeat with another seed, a 1, b or c would contribute most."


def test_a_low_quantile_at_a_jump_stays_within_the_likely_range():
    x = np.random.default_rng(3).uniform(size=300)
    ds = with_output(
        linear(samples=300), "speed", np.where(x < np.sort(x)[17], 90.0 + x, 156.0 + x)
    )
    lead = answer(asking(ds, outputs=["speed"])).lead
    low, high = numbers(
        r"In a repeat with another seed, the 5 % quantile would be # to # mm? \(95 %\).*",
        lead.repeated.sentence.replace("\N{NO-BREAK SPACE}", " "),
    )
    quantile = lead.tolerance_bound.quantiles[0]
    assert (
        quantile.value + 2**0.5 * (quantile.high - quantile.value)
        > 170
        > 157
        >= high
        >= quantile.high - 0.5
    )


def test_quantiles_of_an_angle_are_said_to_be_of_magnitudes():
    ds = kinds(samples=400, analysis={"outputs": ["angle"], "thresholds": {"angle": 0.5}})
    assert "of the magnitudes would be" in answer(ds).lead.repeated.sentence
