"""The answer where rows are not independent, or depend on chance: sentences against numbers."""

import re
from dataclasses import replace

import numpy as np
import pytest
from computed import asking, computed, linear, study_of, summarised, with_output
from noisy_studies import noisy

from uq import what_if
from uq.assess.answer.answer import answer

DAY = 86400.0
NUMBER = r"(-?[\d.]+(?:e-?\d+)?)"
LEVELS = {"rate": "shared", "threshold": "own", "depth": "chance"}


def numbers(pattern, text):
    found = re.fullmatch(pattern.replace("#", NUMBER), text)
    assert found, text
    return [float(one) for one in found.groups()]


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
    _, found, said = nested
    promise = found.lead.promise
    days, cautious = numbers("95 % last longer than # days, cautiously # days.", promise.sentence)
    known = said["quantiles"]["0.05"]
    assert days * DAY == pytest.approx(known["value"], rel=5e-3)
    assert known["low"] * 0.99 < cautious * DAY <= known["low"]
    assert promise.basis == (
        "No tolerance bound: the rows of one sample are not independent."
        " Instead, conservatively: the end of the 95 % interval."
    )


def test_lives_that_never_end_are_said_in_the_range(nested):
    _, found, said = nested
    low, median, *never = numbers(
        r"5 % end within # days; median # days; # % \(# to # %\) never end\.",
        found.lead.range.sentence,
    )
    known = found.lead.range.never
    assert never == pytest.approx([100 * one for one in known.numbers], abs=0.06)
    assert known.value == said["never"] / 2400 and known.low < known.value < known.high
    assert said["quantiles"]["0.95"]["never"] and said["never"] > 0.05 * 2400
    shown = [said["quantiles"][p]["value"] / DAY for p in ("0.05", "0.5")]
    assert [low, median] == pytest.approx(shown, rel=5e-3)


def test_a_probability_rests_on_samples(nested):
    ds, found, said = nested
    (event,) = found.lead.events
    share, low, high = numbers(r"# % \(# to # %\) end within 10 days\.", event.sentence)
    known = said["thresholds"][repr(10 * DAY)]["below"]
    shown = [100 * known[key] for key in ("value", "low", "high")]
    assert [share, low, high] == pytest.approx(shown, abs=0.05)
    assert high - low > 2 * 1.96 * (share * (100 - share) / 2400) ** 0.5  # as of 2400 rows
    assert "most by rate" in event.decided_by


def test_rows_to_add_are_those_of_samples(nested):
    ds, found, said = nested
    (advice,) = [one for one in found.advice if one.rule == "rows"]
    rows, samples = re.match(
        r"Compute about ([\d ]+) rows \(([\d ]+) samples\) instead of 2 400: ", advice.text
    ).groups()
    rows, samples = (int(one.replace(" ", "")) for one in (rows, samples))
    known = said["quantiles"]["0.05"]
    factor = ((known["value"] - known["low"]) / (0.1 * known["value"])) ** 2
    assert rows == pytest.approx(factor * 2400, rel=0.06) and rows >= advice.rows - 1
    assert samples == pytest.approx(factor * 300, rel=0.06)


def test_half_the_scatter_is_what_the_weighted_rows_say(nested):
    ds, found, _ = nested
    one = next(one.tightened for one in found.advice if one.rule == "tighten")
    now, then, low, high = numbers(
        r"Half the scatter of rate \(sigma 0.25 instead of 0.5\) would move the share of rows that"
        r" end within 10 days"
        r" from # % to # % \(# to # %\)\.",
        one.sentence,
    )
    line = what_if(ds, {"uncertain.rate.sigma": 0.25}).loc["life"]
    known = [100 * line[f"P(<{10 * DAY!r}){end}"] for end in ("", "_low", "_high")]
    assert [then, low, high] == pytest.approx(known, abs=0.05)


def test_rows_of_samples_in_replicates_are_weighted():
    ds = wear(method="sobol", samples=16, replicates=8, repeats=3)
    found = answer(ds)
    assert found.lead.promise.basis == (
        "No tolerance bound: the rows of one sample are not independent."
        " Instead, conservatively: the end of the 95 % interval."
    )
    (tighten,) = [one.text for one in found.advice if one.rule == "tighten"]
    assert re.match(r"Half the scatter of rate .* would move the share of rows that end", tighten)
    assert "inf" not in repr(found)


def test_a_random_model_is_answered_as_any_other():
    ds = computed(noisy("monte-carlo", 400, 1))
    found, said = answer(ds), summarised(ds)["outputs"]["y"]
    low, high, median = numbers("90 % lie between # and #; median #.", found.lead.range.sentence)
    shown = [said["quantiles"][p]["value"] for p in ("0.05", "0.95", "0.5")]
    assert [low, high, median] == pytest.approx(shown, rel=5e-3)
    assert "With 95 % confidence" in found.lead.promise.sentence


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
    promise, said = answer(ds).lead.promise, summarised(ds)["outputs"]["life"]
    assert said["tolerance"]["lower"] > said["quantiles"]["0.05"]["value"]
    (days,) = numbers(
        "No tolerance bound: counted from the rows, # days, it lies beyond the quantile itself."
        " Instead, conservatively: the end of the 95 % interval.",
        promise.basis,
    )
    assert days * DAY == pytest.approx(said["tolerance"]["lower"], rel=5e-3)
    shown = numbers("95 % last longer than # days, cautiously # days.", promise.sentence)
    ends = [said["quantiles"]["0.05"][key] / DAY for key in ("value", "low")]
    assert shown == pytest.approx(ends, rel=1e-2) and shown[1] <= ends[1]


def test_a_missing_ranking_is_explained_once():
    ds = with_output(linear(samples=32), "z", linear(samples=32)["y"].values)
    found = answer(asking(ds, outputs=["z"], thresholds={"z": "5 m"}))
    reason = "only 32 rows with a value; 64 are needed"
    assert repr(found).count(reason) == 1
    alone = replace(found.lead, events=())
    assert reason in alone.ranking_sentence


def test_a_regime_that_no_first_row_of_a_sample_has_is_not_ranked(nested):
    ds = nested[0]
    rare = np.arange(ds.sizes["sample"]) % 8 == 5  # one of the other rows of each sample
    attrs = {"role": "output", "kind": "category", "long_name": "how it ended", "units": "1"}
    attrs |= {"may_be_undefined": 0}
    attrs |= {"flag_values": np.int8([0, 1]), "flag_meanings": "calm rough"}
    found = answer(ds.assign(regime=("sample", rare.astype(np.int8), attrs)))
    (rough,) = [one for one in found.regimes if one.predicate == "rough"]
    assert rough.decided_by == "No ranking of the inputs: no row that it could rest on is rough."
