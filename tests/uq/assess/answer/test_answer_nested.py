"""The answer where rows are not independent, or depend on chance: sentences against numbers."""

import re
from dataclasses import replace

import numpy as np
import pytest
from answered import numbers
from computed import asking, computed, linear, study_of, summarised, with_output
from noisy_studies import noisy

from uq import what_if
from uq.assess.answer.answer import answer

DAY = 86400.0
LEVELS = {"rate": "shared", "threshold": "own", "depth": "chance"}


def wear(**design):
    """Return lives of units that share the rate; a higher threshold of their own lets wear stop."""
    lognormal = {"distribution": "lognormal"}
    laws = {
        "rate": lognormal | {"median": 2.5e-10, "sigma": 0.5, "source": "assumed: a guess"},
        "threshold": {"distribution": "uniform", "lower": 0.5e-10, "upper": 2e-10},
        "depth": lognormal | {"median": 2.5e-4, "sigma": 0.3},
    }
    tables = {
        "study": {"name": "wear", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 300, "seed": 1} | design,
        "uncertain": {name: law | {"level": LEVELS[name]} for name, law in laws.items()},
        "analysis": {"thresholds": {"life": "10 days"}},
    }
    return computed(study_of(tables))


@pytest.fixture(scope="module")
def nested():
    ds = wear(units=4, repeats=2)
    return ds, answer(ds), summarised(ds)["outputs"]["life"]


def test_units_promise_a_quantile_with_the_reason(nested):
    _, conclusions, statistics = nested
    tolerance_bound = conclusions.lead.tolerance_bound
    days, cautious = numbers(
        r"95 % last longer than # days \(conservative bound: # days\)\.", tolerance_bound.sentence
    )
    quantile = statistics["quantiles"]["0.05"]
    assert days * DAY == pytest.approx(quantile["value"], rel=5e-3)
    assert quantile["low"] * 0.99 < cautious * DAY <= quantile["low"]
    assert tolerance_bound.basis == (
        "No tolerance bound: the rows of one sample are not independent."
        " The conservative bound is the end of the 95 % interval of the quantile."
    )


def test_lives_that_never_end_are_said_in_the_range(nested):
    _, conclusions, statistics = nested
    low, median, *never = numbers(
        r"5 % of lives are below # days; median # days; # % \(# to # %\) never fail\.",
        conclusions.lead.range.sentence,
    )
    share = conclusions.lead.range.never
    assert never == pytest.approx([100 * number for number in share.numbers], abs=0.06)
    assert share.value == statistics["never"] / 2400 and share.low < share.value < share.high
    assert statistics["quantiles"]["0.95"]["never"] and statistics["never"] > 0.05 * 2400
    shown = [statistics["quantiles"][p]["value"] / DAY for p in ("0.05", "0.5")]
    assert [low, median] == pytest.approx(shown, rel=5e-3)


def test_a_probability_rests_on_samples(nested):
    ds, conclusions, statistics = nested
    (event,) = conclusions.lead.events
    share, low, high = numbers(r"# % \(# to # %\) fail within 10 days\.", event.sentence)
    probability = statistics["thresholds"][repr(10 * DAY)]["below"]
    shown = [100 * probability[key] for key in ("value", "low", "high")]
    assert [share, low, high] == pytest.approx(shown, abs=0.05)
    assert high - low > 2 * 1.96 * (share * (100 - share) / 2400) ** 0.5  # as of 2400 rows
    assert "Main single input: rate." in event.decided_by


def test_rows_to_add_are_those_of_samples(nested):
    ds, conclusions, statistics = nested
    (advice,) = [remedy for remedy in conclusions.advice if remedy.rule == "rows"]
    rows, samples = re.match(
        r"Compute about ([\d ]+) rows \(([\d ]+) samples\) instead of 2 400: ", advice.text
    ).groups()
    rows, samples = (int(text.replace(" ", "")) for text in (rows, samples))
    quantile = statistics["quantiles"]["0.05"]
    factor = ((quantile["value"] - quantile["low"]) / (0.1 * quantile["value"])) ** 2
    assert rows == pytest.approx(factor * 2400, rel=0.06) and rows >= advice.rows - 1
    assert samples == pytest.approx(factor * 300, rel=0.06)


def test_half_the_scatter_is_what_the_weighted_rows_say(nested):
    ds, conclusions, _ = nested
    tolerance = next(advice.tightened for advice in conclusions.advice if advice.rule == "tighten")
    now, then, low, high = numbers(
        r"Halving the scatter of rate \(sigma 0.25 instead of 0.5\) would change the share of"
        r" rows that"
        r" fail within 10 days"
        r" from # % to # % \(# to # %\)\.",
        tolerance.sentence,
    )
    line = what_if(ds, {"uncertain.rate.sigma": 0.25}).loc["life"]
    expected = [100 * line[f"P(<{10 * DAY!r}){end}"] for end in ("", "_low", "_high")]
    assert [then, low, high] == pytest.approx(expected, abs=0.05)


def test_rows_of_samples_in_replicates_are_weighted():
    ds = wear(method="sobol", samples=16, replicates=8, repeats=3)
    conclusions = answer(ds)
    assert conclusions.lead.tolerance_bound.basis == (
        "No tolerance bound: the rows of one sample are not independent."
        " The conservative bound is the end of the 95 % interval of the quantile."
    )
    (tighten,) = [advice.text for advice in conclusions.advice if advice.rule == "tighten"]
    assert re.match(
        r"Halving the scatter of rate .* would change the share of rows that fail", tighten
    )
    assert "inf" not in repr(conclusions)


def test_a_random_model_is_answered_as_any_other():
    ds = computed(noisy("monte-carlo", 400, 1))
    conclusions, statistics = answer(ds), summarised(ds)["outputs"]["y"]
    low, high, median = numbers(
        "90 % of values are between # and #; median #.", conclusions.lead.range.sentence
    )
    shown = [statistics["quantiles"][p]["value"] for p in ("0.05", "0.95", "0.5")]
    assert [low, high, median] == pytest.approx(shown, rel=5e-3)
    assert "With 95 % confidence" in conclusions.lead.tolerance_bound.sentence


def test_a_bound_that_contradicts_the_quantile_is_no_promise():
    # By chance none of these 60 lives is among the shortest 5 %, which the law of depth shows.
    lognormal = {"distribution": "lognormal"}
    tables = {
        "study": {"name": "wear", "model": "exponential-wear"},
        "design": {"method": "monte-carlo", "samples": 60, "seed": 36},
        "uncertain": {
            "rate": lognormal | {"median": 2.5e-10, "sigma": 0.1},
            "depth": lognormal | {"median": 2.5e-4, "sigma": 0.5},
        },
        "analysis": {"tolerance": {"coverage": 0.95, "confidence": 0.95}},
    }
    ds = computed(study_of(tables))
    tolerance_bound, statistics = answer(ds).lead.tolerance_bound, summarised(ds)["outputs"]["life"]
    assert statistics["tolerance"]["lower"] > statistics["quantiles"]["0.05"]["value"]
    (days,) = numbers(
        "No tolerance bound: its value, # days, contradicts the estimate."
        " The conservative bound is the end of the 95 % interval of the quantile.",
        tolerance_bound.basis,
    )
    assert days * DAY == pytest.approx(statistics["tolerance"]["lower"], rel=5e-3)
    shown = numbers(
        r"95 % last longer than # days \(conservative bound: # days\)\.", tolerance_bound.sentence
    )
    ends = [statistics["quantiles"]["0.05"][key] / DAY for key in ("value", "low")]
    assert shown == pytest.approx(ends, rel=1e-2) and shown[1] <= ends[1]


def test_a_missing_ranking_is_explained_once():
    ds = with_output(linear(samples=32), "z", linear(samples=32)["y"].values)
    conclusions = answer(asking(ds, outputs=["z"], thresholds={"z": "5 m"}))
    reason = "only 32 rows with a value; 64 are needed"
    assert repr(conclusions).count(reason) == 1
    alone = replace(conclusions.lead, events=())
    assert reason in alone.ranking_sentence


def test_a_regime_that_no_first_row_of_a_sample_has_is_not_ranked(nested):
    ds = nested[0]
    rare = np.arange(ds.sizes["row"]) % 8 == 5  # one of the other rows of each sample
    attrs = {"role": "output", "kind": "category", "long_name": "how it ended", "units": "1"}
    attrs |= {"may_be_undefined": 0}
    attrs |= {"flag_values": np.int8([0, 1]), "flag_meanings": "calm rough"}
    conclusions = answer(ds.assign(regime=("row", rare.astype(np.int8), attrs)))
    (rough,) = [regime for regime in conclusions.regimes if regime.predicate == "rough"]
    assert rough.decided_by == "No ranking of the inputs: none of the ranked rows is rough."
