"""What can be promised, how often, and in which regime: each sentence against its numbers."""

import re

import answered
import numpy as np
import pytest
from answered import DAY, numbers
from computed import (
    asking,
    kinds,
    linear,
    summarised,
    with_output,
    with_status,
)

import uq
from uq.assess.answer.answer import answer
from uq.assess.answer.events import Event
from uq.assess.answer.rankings import Ranking
from uq.contract import Status
from uq.stats.estimate import Estimate
from uq.text.numbers import printed


@pytest.fixture(scope="module")
def lifetime():
    return answered.lifetime()


def test_the_promise_of_a_life_is_its_lower_tolerance_bound_rounded_down(lifetime):
    ds, conclusions = lifetime
    assert conclusions.lead.tolerance_bound.basis == (
        "Tolerance bound from order statistics (rank 39 of 1 000), valid for any distribution."
    )
    (days,) = numbers(
        "With 95 % confidence, at least 95 % last longer than # days.",
        conclusions.lead.tolerance_bound.sentence,
    )
    asked = {"coverage": 0.95, "confidence": 0.95}
    bound = summarised(asking(ds, tolerance=asked))["outputs"]["life"]["tolerance"]["lower"]
    assert conclusions.lead.tolerance_bound.lower == bound
    assert bound * 0.99 < days * DAY <= bound


def test_the_likely_range_is_that_of_the_quantiles(lifetime):
    ds, conclusions = lifetime
    low, high, median, never = numbers(
        r"90 % of lives are between # and # days; median # days; all fail \(at most # % survive,"
        r" 95 % limit\)\.",
        conclusions.lead.range.sentence,
    )
    assert never == pytest.approx(100 * (1 - 0.025**1e-3), abs=0.005)  # no row of 1000
    quantiles = summarised(ds)["outputs"]["life"]["quantiles"]
    shown = {"0.05": low, "0.95": high, "0.5": median}
    for p, value in shown.items():
        assert value * DAY == pytest.approx(quantiles[p]["value"], rel=5e-3)


def test_a_threshold_has_its_probability_and_what_decides_it(lifetime):
    ds, conclusions = lifetime
    (event,) = conclusions.lead.events
    *shown, at = numbers(r"# % \(# to # %\) fail within # days\.", event.sentence)
    probability = summarised(ds)["outputs"]["life"]["thresholds"][repr(10 * DAY)]["below"]
    assert at == 10
    ends = [100 * probability[key] for key in ("value", "low", "high")]
    assert shown == pytest.approx(ends, abs=0.05)
    least, below, most, above = numbers(
        r"Main driver: rate. Over rate, the share ranges from # % below # pm s⁻¹"
        r" to # % above # pm s⁻¹\.",
        event.decided_by,
    )
    rate, life = ds["rate"].values, ds["life"].values
    low, high = event.curve.around(0)[1], event.curve.around(len(event.curve.shares) - 1)[0]
    assert low >= event.curve.edges[1] and high < event.curve.edges[-2]  # parts alike are one
    assert (below, above) == pytest.approx((low * 1e12, high * 1e12), rel=5e-3)
    assert least == pytest.approx(100 * (life[rate < low] < 10 * DAY).mean(), abs=0.06)
    assert most == pytest.approx(100 * (life[rate >= high] < 10 * DAY).mean(), abs=0.06)


def test_an_angle_is_promised_by_its_magnitude_in_degrees():
    turn = np.random.default_rng(1).uniform(-0.5, 0.5, 200)
    ds = with_output(linear(samples=200), "turn", turn, "angle")
    ds["turn"].attrs["units"] = "rad"
    lead = answer(asking(ds, outputs=["turn"], thresholds={"turn": 0.4})).lead
    (bound,) = numbers(
        "With 95 % confidence, at least 95 % of magnitudes are below #°.",
        lead.tolerance_bound.sentence,
    )
    assert np.degrees(lead.tolerance_bound.upper) == pytest.approx(bound, rel=5e-3) and bound > 27
    share, _, _, at = numbers(
        r"# % \(# to # %\) exceed # rad in magnitude\.", lead.events[0].sentence
    )
    assert share == pytest.approx(100 * (abs(turn) > 0.4).mean(), abs=0.05)
    assert at == 0.4  # as the study has it


def test_rows_that_are_not_independent_give_a_cautious_quantile_and_the_reason():
    ds = linear("saltelli", samples=64, replicates=4)
    lead = answer(ds).lead
    low, cautious, high, bold = numbers(
        r"95 % of values are above # \(conservative bound: #\); 95 % of values are below #"
        r" \(conservative bound: #\)\.",
        lead.tolerance_bound.sentence,
    )
    quantiles = summarised(ds)["outputs"]["y"]["quantiles"]
    shown = [quantiles["0.05"]["value"], quantiles["0.05"]["low"]]
    shown += [quantiles["0.95"]["value"], quantiles["0.95"]["high"]]
    assert [low, cautious, high, bold] == pytest.approx(shown, rel=1e-2)
    assert cautious <= shown[1] and bold >= shown[3]
    assert lead.tolerance_bound.basis.startswith(
        "No tolerance bound: the rows of a 'saltelli' design are not independent."
    )
    first = lead.ranking.contributions[0]
    assert first.inputs == ("x4",) and first.indices[0].low < 16 / 30 < first.indices[0].high
    (by,) = numbers(
        r"one standard deviation \(0.289\) more raises it by #", first.effect
    )  # it is linear
    assert by == pytest.approx(4 / 12**0.5, rel=0.02)


def test_regimes_are_named_with_their_shares():
    ds = kinds(samples=200)
    conclusions = answer(ds)
    shares = summarised(ds)["regime"]
    assert len(conclusions.regimes) == 2
    for regime in conclusions.regimes:
        share, low, high = numbers(rf"# % \(# to # %\) {regime.predicate}\.", regime.sentence)
        expected = [100 * shares[regime.predicate][key] for key in ("share", "low", "high")]
        assert [share, low, high] == pytest.approx(expected, abs=0.05)
    assert all(regime.predicate in conclusions.regimes_sentence for regime in conclusions.regimes)


@pytest.mark.parametrize("rows", [1, 5])
def test_few_rows_promise_nothing(rows):
    conclusions = answer(linear(samples=rows))
    assert "confidence" not in repr(conclusions)
    assert conclusions.lead.tolerance_bound.sentence == ""
    assert re.fullmatch(
        r"No tolerance bound: \d+ rows are required\.", conclusions.lead.tolerance_bound.basis
    )
    assert conclusions.lead.ranking.leader is None


def test_where_every_row_failed_only_that_is_said():
    ds = linear(samples=20)
    ds["y"][:] = np.nan
    conclusions = answer(with_status(ds, range(20), Status.RAISED))
    assert (
        conclusions.quantities == () and conclusions.rows_sentence == "20 of 20 rows are invalid."
    )
    assert [advice.rule for advice in conclusions.advice] == ["failed"]
    assert (
        "20 of 20 rows are invalid." in repr(conclusions)
        and "20 of 20" in conclusions._repr_html_()
    )


def test_nothing_is_said_of_an_event_without_rows():
    assert Event("P(y>1.0)", "exceed 1", Estimate()).sentence == ""
    assert Ranking("y", "sobol").sentence == ""


def test_undefined_rows_are_named_beside_a_probability():
    turn = np.random.default_rng(1).uniform(-0.5, 0.5, 200)
    turn[:50] = np.nan
    ds = with_output(linear(samples=200), "turn", turn, "angle")
    ds["turn"].attrs |= {"units": "rad", "may_be_undefined": 1}
    ds = asking(ds, outputs=["turn"], thresholds={"turn": "20 degrees"})
    (event,) = answer(ds).lead.events
    share, _, _, undefined = numbers(
        r"# % \(# to # %\) exceed 20° in magnitude; # % are undefined\.", event.sentence
    )
    probability = summarised(ds)["outputs"]["turn"]["thresholds"][repr(event_at(event))]
    assert share == pytest.approx(100 * probability["above"]["value"], abs=0.05)
    assert undefined == 100 * probability["undefined"] == 25


def event_at(event):
    return float(event.name.partition(">")[2].rstrip(")"))


def test_a_notebook_shows_the_same_sentences():
    conclusions = uq.answer(linear("saltelli", samples=64, replicates=4))
    html = conclusions._repr_html_()
    assert html.startswith("<style>") and printed(conclusions.lead.range.sentence) in html
    assert conclusions.lead.range.sentence in repr(conclusions)
