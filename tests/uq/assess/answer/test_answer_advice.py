"""What to do: each piece of advice against the numbers under it."""

import re
from dataclasses import replace

import answered
import numpy as np
import pytest
from answered import DAY, numbers
from computed import (
    as_text,
    asking,
    kinds,
    linear,
    with_output,
)

import uq
from uq.assess.answer.answer import answer
from uq.assess.answer.piece_of_advice import Advice
from uq.assess.answer.tightening import halved
from uq.assess.answer.tolerance_effects import TighterTolerance
from uq.stats.estimate import Estimate
from uq.study.reading import read_study_text


@pytest.fixture(scope="module")
def lifetime():
    return answered.lifetime()


def test_rows_too_few_for_a_ranking_are_added():
    """The answer must not say that nothing is to be done."""
    conclusions = answer(linear(samples=20))
    assert [advice.rule for advice in conclusions.advice] == ["rows"]
    assert conclusions.advice[0].rows == 64
    assert (
        "Compute about 64 rows instead of 20: no ranking of the inputs"
        in conclusions.advice[0].text
    )


def test_an_assumed_law_that_matters_is_measured_first(lifetime):
    ds, conclusions = lifetime
    assert [advice.rule for advice in conclusions.advice] == ["measure", "tighten"]
    assert conclusions.advice[0].text == (
        "Measure rate first: it matters most for the share that fail within 10 days, and its law is"
        " assumed."
    )
    measured_rate = ds.copy()
    measured_rate["rate"].attrs["source"] = "given by the supplier"
    conclusions = answer(measured_rate)
    assert [advice.rule for advice in conclusions.advice] == ["tighten", "nothing"]
    assert conclusions.advice[1].text.endswith(", and no influential law is assumed.")


def test_a_law_of_which_no_source_says_how_well_it_is_known_is_asked_for(lifetime):
    ds, _ = lifetime
    unstated = ds.copy()
    unstated["rate"].attrs["source"] = "the supplier"
    first, *_, last = answer(unstated).advice
    assert first.rule == "source"
    assert first.text.startswith("State in 'source' how rate is known (given")
    assert last.text == "Nothing else is needed: all questions of the study are settled."


def test_a_range_of_designs_is_neither_measured_nor_tightened(lifetime):
    ds, _ = lifetime
    chosen = ds.copy()
    chosen["rate"].attrs["source"] = "chosen: the rates of three alloys"
    entries = answer(chosen).advice
    assert not {"measure", "source", "known"} & {advice.rule for advice in entries}
    assert not any(advice.inputs == ("rate",) for advice in entries if advice.rule == "tighten")


def test_what_starts_a_motion_is_not_measured(lifetime):
    ds, _ = lifetime
    start = ds.copy()
    start["rate"].attrs["initial"] = 1
    assert not {"measure", "source"} & {advice.rule for advice in answer(start).advice}


def test_half_the_scatter_is_what_the_weighted_rows_say(lifetime):
    ds, conclusions = lifetime
    tolerance = next(advice.tightened for advice in conclusions.advice if advice.rule == "tighten")
    _, now, then, low, high = numbers(
        r"Halving the scatter of rate \(sigma 0.25 instead of 0.5\) would change the share of"
        r" rows that"
        r" fail within # days"
        r" from # % to # % \(# to # %\)\.",
        tolerance.sentence,
    )
    column = f"P(<{10 * DAY!r})"
    weighted = uq.what_if(ds, {"uncertain.rate.sigma": 0.25}).loc["life"]
    expected = [100 * weighted[f"{column}{end}"] for end in ("", "_low", "_high")]
    assert [then, low, high] == pytest.approx(expected, abs=0.05)
    assert now == pytest.approx(100 * uq.summary(ds).loc["life", column], abs=0.05)
    assert tolerance.effective_rows < 1000


def test_half_the_scatter_of_a_law():
    laws = {
        "uniform": ({"lower": 1.0, "upper": 3.0}, {"lower": 1.5, "upper": 2.5}),
        "loguniform": ({"lower": 1.0, "upper": 16.0}, {"lower": 2.0, "upper": 8.0}),
        "triangular": (
            {"lower": 0.0, "mode": 1.0, "upper": 4.0},
            {"lower": 0.5, "upper": 2.5},
        ),
        "lognormal": ({"mean": 2.0, "cv": 0.2}, {"cv": 0.1}),
        "weibull": ({"shape": 2.0, "scale": 1.0}, {}),
    }
    for name, (arguments, expected) in laws.items():
        uncertain = {"x1": {"distribution": name, **arguments}}
        tables = {
            "study": {"name": "laws", "model": "ishigami"},
            "design": {"method": "monte-carlo", "samples": 8},
            "uncertain": uncertain,
        }
        law = read_study_text(as_text(tables), "study").uncertain["x1"]
        assert halved(law) == pytest.approx(expected)


def test_a_rare_event_asks_for_more_rows():
    ds = linear(samples=200)
    ds = with_output(ds, "rare", np.r_[np.ones(8), np.zeros(192)] + 1e-6 * ds["x1"].values)
    conclusions = answer(asking(ds, outputs=["rare"], thresholds={"rare": 0.5}))
    share = conclusions.lead.events[0].share
    half = (share.high - share.low) / 2
    (rows,) = [advice for advice in conclusions.advice if advice.rule == "rows"]
    most = max(
        (half / 0.01) ** 2, conclusions.lead.ranking.rows_factor
    )  # eight rows make the variance
    assert rows.rows == pytest.approx(200 * most, rel=0.01)


def with_valley(samples=400):
    """Return a result in which a wanted y is high where x4 is far from its middle."""
    ds = linear(samples=samples)
    far = (ds["x4"].values - 0.5) ** 2 + 1e-4 * ds["x1"].values
    asked = {"outputs": ["far"], "thresholds": {"far": 0.01}, "wanted": {"far": "above"}}
    return asking(with_output(ds, "far", far), **asked)


def test_where_less_scatter_does_not_help_the_answer_says_where_to_keep_the_input():
    ds = with_valley()
    conclusions = answer(ds)
    assert [advice.rule for advice in conclusions.advice][:2] == ["source", "keep"]
    event = conclusions.lead.events[0]
    assert event.share.value > 0.5
    share, low, high = numbers(
        r"To increase the share that exceed 10 mm, keep x4 [^:]*: # % \(# to # %\) do there\.",
        conclusions.advice[1].text,
    )
    most = event.curve.shares[event.curve.most]
    assert [share, low, high] == pytest.approx([100 * number for number in most.numbers], abs=0.05)
    assert most.low > event.share.high


@pytest.mark.parametrize(("wanted", "side"), [("above", "are above"), ("below", "are below")])
def test_the_side_that_is_wanted_is_promised_and_advised(wanted, side):
    asked = {"outputs": ["y"], "thresholds": {"y": 5.0}, "wanted": {"y": wanted}}
    conclusions = answer(asking(linear(samples=400), **asked))
    bound = rf"With 95 % confidence, at least 95 % of values {side} [\d.]+\."
    assert re.fullmatch(bound, conclusions.lead.tolerance_bound.sentence)
    (remedy,) = (each for each in conclusions.advice if each.rule in ("tighten", "keep"))
    if remedy.rule == "tighten":
        before, after = remedy.tightened.before.value, remedy.tightened.after.value
        assert after > before if wanted == "above" else after < before
    else:
        assert remedy.text.startswith(
            f"To {'increase' if wanted == 'above' else 'reduce'} the share that exceed 5, keep "
        )


def test_what_nobody_wants_is_not_called_better():
    ds = with_valley()
    conclusions = answer(asking(ds, outputs=["far"], thresholds={"far": 0.01}, wanted={}))
    assert conclusions.lead.wants_more is None
    assert not any(advice.rule == "keep" for advice in conclusions.advice)


def test_a_large_angle_may_be_wanted():
    asked = {"outputs": ["angle"], "thresholds": {"angle": 1.0}}
    assert answer(kinds(samples=100, analysis=asked)).lead.wants_more is False
    lead = answer(kinds(samples=100, analysis=asked | {"wanted": {"angle": "above"}})).lead
    assert lead.wants_more
    assert "at least 95 % of defined magnitudes are above" in lead.tolerance_bound.sentence


def test_more_successes_and_fewer_other_ends_are_better():
    lives = np.random.default_rng(0).uniform(1, 9, 64)
    ds = with_output(linear(samples=64), "life", lives, "lifetime")
    asked = {"outputs": ["life"], "thresholds": {"life": 8.0}}
    lead = answer(asking(ds, **asked)).lead
    assert not lead.wants_more
    ds["life"].attrs["success"] = "the lock has closed"
    lead = answer(asking(ds, **asked)).lead
    assert lead.wants_more
    better = TighterTolerance(("x",), "", Estimate(0.5), Estimate(0.6), wants_more=True)
    assert better.helps and not replace(better, wants_more=False).helps
    assert replace(better, wants_more=None).helps


def test_two_pieces_of_advice_of_one_rule_have_a_key_each():
    conclusions = answer(linear(samples=20))
    advice = [Advice("rows", "Compute more."), Advice("keep", "Stay."), Advice("rows", "Wait.")]
    document = replace(conclusions, advice=tuple(advice)).fact.json["advice"]
    assert {key: entry["text"] for key, entry in document.items()} == {
        "rows": "Compute more.",
        "keep": "Stay.",
        "rows_2": "Wait.",
    }
