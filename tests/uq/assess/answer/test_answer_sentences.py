"""Sentences of the answer that few studies need, each against the numbers under it."""

import re

import numpy as np
import pytest
from answered import numbers
from computed import (
    UNIFORM,
    asking,
    computed,
    kinds,
    linear,
    study_of,
    summarised,
    with_output,
    with_status,
)
from nested_studies import nested_result
from scipy.stats import binomtest

from uq.assess.answer.answer import answer, verdict
from uq.assess.answer.answer_sentences import Answer
from uq.assess.answer.events import Event
from uq.assess.answer.tolerance_effects import TighterTolerance
from uq.assess.findings import Findings
from uq.cli.summary_tables import show_answer
from uq.contract import Status
from uq.render.html.answer import fragment
from uq.result.result import Result
from uq.stats.estimate import Estimate

DAY = 86400.0


def days(lives, flags=None, **analysis):
    """Return a result with these lives."""
    ds = with_output(linear(samples=len(lives)), "life", np.array(lives) * DAY, "lifetime", flags)
    return asking(ds, outputs=["life"], **analysis)


def test_lives_of_which_some_never_end():
    ended = np.linspace(1, 10, 150)
    ds = days(np.r_[ended, np.full(50, np.inf)], quantiles=[0.05, 0.5])
    sentence = answer(ds).lead.range.sentence
    pattern = r"5 % of lives are below # days; median # days; # % \(# to # %\) never fail\."
    low, median, *never = numbers(pattern, sentence)
    exact = 100 * np.array(binomtest(50, 200).proportion_ci(method="wilson"))
    assert never == pytest.approx([25, *exact], abs=0.05)
    quantiles = summarised(ds)["outputs"]["life"]["quantiles"]
    assert low == pytest.approx(quantiles["0.05"]["value"] / DAY, rel=5e-3)
    assert median == pytest.approx(quantiles["0.5"]["value"] / DAY, rel=5e-3)
    assert 1 + 9 * 9 / 149 <= low <= 1 + 9 * 10 / 149  # between the tenth life and the next
    mostly = answer(days(np.r_[ended[:50], np.full(150, np.inf)])).lead
    assert re.search(r"; 75\.0 % \(\S+ to \S+ %\) never fail\.$", mostly.range.sentence)
    assert mostly.tolerance_bound.sentence.startswith(
        "With 95 % confidence, at least 95 % last longer"
    )


def test_lives_of_which_some_exceed_the_horizon():
    flags = np.arange(200) >= 150
    ds = days(np.where(flags, 10.0, np.linspace(1, 9, 200)), flags, thresholds={"life": 20 * DAY})
    lead = answer(ds).lead
    assert "more than 5 % exceed the horizon" in lead.range.sentence
    (event,) = lead.events
    assert np.isnan(event.share.value)
    assert (
        event.sentence
        == "The share that fail within 20 days cannot be estimated: it is after the last"
        " observation."
    )


def test_a_success_succeeds():
    times = np.linspace(1, 9, 200)
    ds = with_output(linear(samples=200), "locking", times, "lifetime")
    ds["locking"].attrs["success"] = "the motors have locked"
    lead = answer(asking(ds, outputs=["locking"], thresholds={"locking": 5.0})).lead
    (latest,) = numbers(
        r"With 95 % confidence, at least 95 % succeed within # s\.", lead.tolerance_bound.sentence
    )
    assert latest >= np.quantile(times, 0.95)
    share, *_, at = numbers(r"# % \(# to # %\) succeed within # s\.", lead.events[0].sentence)
    assert (share, at) == (pytest.approx(100 * (times < 5).mean(), abs=0.05), 5)
    never = np.r_[times[:150], np.full(50, np.inf)]
    ds = ds.assign(locking=ds["locking"].copy(data=never))
    sentence = answer(asking(ds, outputs=["locking"])).lead.range.sentence
    assert "5 % of times are below" in sentence and sentence.endswith(
        "(19.5 to 31.4 %) never succeed."
    )


def test_where_nothing_can_be_promised_a_probability_comes_first():
    times = np.r_[np.linspace(1, 9, 150), np.full(50, np.inf)]
    ds = linear(samples=200)
    ds = with_output(ds, "locking", times[np.argsort(np.argsort(ds["x4"].values))], "lifetime")
    ds["locking"].attrs["success"] = "the motors have locked"
    conclusions = answer(asking(ds, outputs=["locking"], thresholds={"locking": 20.0}))
    (event,) = conclusions.lead.events
    assert conclusions.lead.tolerance_bound.sentence == "" and conclusions.lead.first is event
    assert conclusions.lead.head[:2] == [event.sentence, event.decided_by] == conclusions.lines[:2]
    share, least, edge, most, same = numbers(
        r"# % \(.*\) succeed within 20 s. Main driver: x4. Over x4, the share ranges from # %"
        r" above #"
        r" to # % below #\.",
        " ".join(conclusions.lines[:2]),
    )
    there = np.isfinite(times[np.argsort(np.argsort(ds["x4"].values))])
    assert share == pytest.approx(100 * there.mean(), abs=0.05)
    assert least == pytest.approx(100 * there[ds["x4"].values > edge].mean(), abs=3)
    assert most == 100 and there[ds["x4"].values < same - 0.005].all() and same > 0.5


def test_more_rows_are_not_advised_for_numerical_errors():
    ds = linear(samples=100)
    ds = with_output(ds, "z", ds["x1"].values)
    ds = with_output(ds, "z_error", np.random.default_rng(0).lognormal(0, 1, 100))

    def rows_advised(*outputs):
        return [
            advice.text
            for advice in answer(asking(ds, outputs=outputs)).advice
            if advice.rule == "rows"
        ]

    assert rows_advised("z", "z_error") == rows_advised("z")
    assert len(rows_advised("z_error")) == 1


def test_failed_rows_widen_a_probability():
    ds = linear(samples=200)
    ds = with_status(ds.assign(y=ds["y"].copy()), range(10), Status.RAISED)
    ds["y"][:10] = np.nan
    (event,) = answer(asking(ds, outputs=["y"], thresholds={"y": 5.0})).lead.events
    *_, low, high = numbers(
        r"# % \(# to # %\) exceed 5; with invalid rows at best and worst, # to # %\.",
        event.sentence,
    )
    assert [low, high] == pytest.approx([100 * event.failed.low, 100 * event.failed.high], abs=0.05)
    assert event.failed.low <= event.share.low and event.share.high <= event.failed.high
    assert event.failed.low <= (ds["y"] > 5.0).mean() <= event.failed.high


def test_a_quantile_moves_where_no_probability_is_asked_for():
    tables = {
        "study": {"name": "linear", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 1000, "seed": 3},
        "uncertain": {
            name: {"distribution": "normal", "mean": 0.5, "sd": 0.05} for name in ("x1", "x4")
        },
    }
    conclusions = answer(computed(study_of(tables)))
    (remedy,) = (each for each in conclusions.advice if each.rule == "tighten")
    before, after, low, high = numbers(
        r"Halving the scatter of x4 \(sd 0.025 instead of 0.05\) would change the 5 % quantile"
        r" from # to # \(# to #\)\.",
        remedy.sentence,
    )
    shares = np.hypot(0.05, 4 * 0.05), np.hypot(0.05, 4 * 0.025)  # of sd, as y = x1 + ... + 4 x4
    middle = 0.5 + 4 * 0.5 + (before - 0.5 - 4 * 0.5 + 1.645 * shares[0])
    assert low < middle - 1.645 * shares[1] < high and before < after


def test_nothing_is_advised_that_changes_no_digit():
    same = TighterTolerance(("x",), "the share", Estimate(0.0), Estimate(1e-9), is_share=True)
    assert not TighterTolerance(("x",), "", Estimate(0.5), Estimate(0.5004), is_share=True).is_seen
    assert not TighterTolerance(("x",), "", Estimate(1.0), Estimate(1.0)).is_seen
    assert same.is_seen and TighterTolerance(("x",), "", Estimate(0.5), Estimate(0.4)).is_seen


def test_samples_of_several_rows_bound_nothing_and_say_why():
    lead = answer(nested_result(samples=60)).lead
    assert lead.tolerance_bound.basis.startswith(
        "No tolerance bound: the rows of one sample are not independent."
    )
    assert (
        np.isnan(lead.tolerance_bound.lower)
        and "conservative bound" in lead.tolerance_bound.sentence
    )


def test_a_ranking_of_lives_says_that_it_integrates_nothing():
    lognormal = {"distribution": "lognormal", "median": 1.0}
    tables = {
        "study": {"name": "scaled", "model": "scaled"},
        "design": {"method": "monte-carlo", "samples": 400},
        "uncertain": {"a": lognormal | {"sigma": 0.5}, "z": UNIFORM},
        "analysis": {"outputs": ["life", "y"]},
    }
    life, y = answer(computed(study_of(tables, "sample_models:SCALED"))).quantities
    assert life.ranking.index_meaning.endswith(", of lives as computed")
    assert "integrated" not in y.ranking.index_meaning


def test_no_single_input_explains_much():
    rng = np.random.default_rng(2)
    ds = linear(samples=2000)
    values = 0.12 * (ds["x1"].values - 0.5) * 12**0.5 + rng.normal(size=2000)
    ds = asking(with_output(ds, "noisy", values), outputs=["noisy"], sensitivity=["rbd-fast"])
    ranking = answer(ds).lead.ranking
    leads = ranking.leader is not None and ranking.leads
    assert not leads
    assert ranking.sentence.startswith(
        ("No single input", "The ranking of the inputs is not settled")
    )


def test_a_study_that_names_the_regime_first_is_about_the_regimes(capsys):
    by_value = kinds(samples=64, analysis={"outputs": ["work", "regime"]})
    by_regime = kinds(samples=64, analysis={"outputs": ["regime", "work"]})
    for ds, first in ((by_value, False), (by_regime, True)):
        conclusions = answer(ds)
        assert (conclusions.regimes[0].sentence in conclusions.lines[0]) == first
        show_answer(conclusions)
        printed = capsys.readouterr().out
        assert printed.startswith(conclusions.regimes_sentence[:20]) == first
        page = fragment(conclusions)
        places = [page.index(words) for words in ("slow", str(answer(ds).lead.words[1:]))]
        assert (places == sorted(places)) == first


def test_the_rarer_regimes_say_what_decides_them():
    often, seldom, rare = (
        Event(f"P(regime={name})", name, Estimate(share, share - 0.005, share + 0.005))
        for name, share in (("a", 0.8), ("b", 0.195), ("c", 0.005))
    )
    conclusions = Answer("", 100, 0, (), (often, seldom, rare), ())
    assert [regime.sentence for regime in conclusions.main_regimes] == [
        "80.0 % (79.5 to 80.5 %) a.",
        "19.5 % (19.0 to 20.0 %) b.",
    ]
    ds = kinds(samples=400)
    first, second = answer(ds).main_regimes
    assert (first.predicate, second.predicate) == ("slow", "fast")
    assert [cause.predicate for cause in answer(ds).regime_causes] == ["fast"]
    *_, never, below, always, above = numbers(
        r"# % \(# to # %\) fast\. Main driver: x1. Over x1, the share ranges from # % below # m"
        r" to # % above # m\.",
        second.with_cause,
    )
    fast = ds["regime"].values == 1
    x = ds["x1"].values
    assert (never, always) == (0, 100)
    assert not fast[x < 0.99 * below].any() and fast[x > 1.01 * above].all()


@pytest.mark.parametrize("method", ["saltelli", "shapley", "sobol"])
def test_nothing_is_settled_without_intervals(method):
    findings = Findings(Result(linear(method, samples=512)))
    (sentence,) = verdict(findings)
    assert sentence.startswith(
        "Whether the sample size is sufficient cannot be assessed: the rows of a"
    )
    assert sentence.endswith("set replicates = 8.")
    conclusions = answer(findings.result)
    rules = {advice.rule: advice.text for advice in conclusions.advice}
    assert "set replicates = 8" in rules["rows"] and "nothing" not in rules
    ranking = conclusions.lead.ranking
    assert all(
        not contribution.effect for contribution in ranking.contributions
    )  # no direction is called unclear
    if method == "saltelli":
        assert ranking.sentence.startswith(
            "The ranking of the inputs is not settled: the total share (ST) of x4 is 0.5"
        )
        assert ranking.sentence.endswith(", without an interval.")


def test_an_input_that_alone_has_an_effect_decides_without_an_interval():
    ds = linear("saltelli", samples=64, replicates=8)
    ds = asking(with_output(ds, "half", (ds["x4"].values > 0.5).astype(float)), outputs=["half"])
    (line,) = answer(ds).quantities
    assert line.ranking.sentence == "x4 contributes most: 100 % of the variance."
