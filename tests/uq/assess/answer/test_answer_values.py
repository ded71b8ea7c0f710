"""What is said of inputs with few values, and of values that recur, are missing or little known."""

import re
from dataclasses import replace

import numpy as np
import pytest
from computed import asking, computed, linear, study_of, with_output

from uq.assess.answer.answer import answer
from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.answer.tolerance_effects import TighterTolerance
from uq.assess.answer.wording import DisplayUnit
from uq.stats.estimate import Estimate


def graded(samples=1000):
    """Return a value that a grade doubles in some rows: it has most of the variance."""
    x1 = {"distribution": "uniform", "lower": 0.0, "upper": 1.0}
    x2 = {"distribution": "discrete-choice", "values": [0.1, 0.2, 0.3], "weights": [0.6, 0.3, 0.1]}
    tables = {
        "study": {"name": "graded", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": samples, "seed": 1},
        "uncertain": {"x1": x1, "x2": x2 | {"source": "assumed"}},
    }
    ds = computed(study_of(tables))
    level = np.where(ds["x2"].values > 0.25, 4.0, 1.0) * (1 + 0.2 * ds["x1"].values)
    ds = with_output(ds, "level", level)
    return asking(ds, outputs=["level"], thresholds={"level": 3.0}, wanted={"level": "below"})


@pytest.fixture(scope="module")
def conclusions():
    return answer(graded())


def test_an_input_with_few_values_is_ranked(conclusions):
    (contribution,) = conclusions.lead.ranking.contributions
    assert contribution.inputs == ("x2",) and contribution.indices[0].value > 0.95
    assert conclusions.lead.ranking.with_effect.endswith(
        "More raises it."
    )  # it has no small changes
    assert [advice.rule for advice in conclusions.advice][0] == "measure" and conclusions.advice[
        0
    ].inputs == ("x2",)


def test_the_probability_of_an_event_is_that_at_each_value(conclusions):
    (event,) = conclusions.lead.events
    assert event.decided_by == (
        "Main driver: x2. Over x2, the share ranges from 0 % below 0.25 to 100 % above 0.25."
    )
    assert event.limited == (
        "With 95 % confidence, fewer than 5 % exceed 3 m if x2 is at most 0.25."
    )


def valued(values, kind="value", samples=400, **asked):
    """Return a result whose first output has some values, functions of four uniform inputs."""
    ds = linear(samples=samples)
    ds = with_output(ds, "found", values(*(ds[f"x{i}"].values for i in (1, 2, 3, 4))), kind)
    return asking(ds, outputs=["found"], **asked)


def test_a_bound_that_many_rows_have_is_not_said_to_be_exceeded():
    """A tenth ends at the third cycle itself."""
    cycles = valued(lambda x, *_: 3.0 + np.floor(8 * x), "lifetime", thresholds={"found": 5.0})
    lead = answer(cycles).lead
    assert lead.tolerance_bound.sentence == "With 95 % confidence, at least 95 % last at least 3 s."
    assert lead.events[0].predicate == "fail before 5 s"  # those that end at 5 s are not among them
    gaps = valued(lambda x, *_: np.maximum(x - 0.97, 0) * -1.0)
    assert answer(gaps).lead.tolerance_bound.sentence == (
        "With 95 % confidence, at least 95 % of values are at least 0 m. 97.8 % of the rows have"
        " the"
        " largest value, 0 m: values may be truncated there."
    )
    assert valued_promise(lambda x, *_: 3.0 + x, "lifetime").startswith("last longer than")


def valued_promise(values, kind):
    return (
        answer(valued(values, kind))
        .lead.tolerance_bound.sentence.partition("95 % ")[2]
        .split("95 % ")[-1]
    )


def test_bounds_and_ranges_say_which_values_they_are_about():
    ds = valued(lambda x, *_: np.where(x < 0.2, np.nan, 1 + x))
    ds["found"].attrs["may_be_undefined"] = 1
    lead = answer(ds).lead
    assert "at least 95 % of defined values are above" in lead.tolerance_bound.sentence
    assert re.match(
        "90 % of defined values are between .* of the rows have no value", lead.range.sentence
    )


def test_what_the_rows_cannot_show_is_no_advice():
    """Half the scatter of a symmetric input leaves half of the values above the middle."""
    asked = {"thresholds": {"found": 0.0}, "wanted": {"found": "above"}}
    whole = answer(valued(lambda x, y, *_: x - 0.5 + 0.1 * y - 0.05, samples=1000, **asked))
    (advice,) = [remedy for remedy in whole.advice if remedy.rule == "tighten"]
    assert advice.tightened.statistic == "the 5 % quantile"
    assert not any(tolerance.may_stay for tolerance in [advice.tightened, *advice.alike])


def test_no_less_is_promised_than_now():
    tolerance_bound = ToleranceBound(0.95, 0.95, 13.9, np.nan, DisplayUnit("h"), is_life=True)
    before = Estimate(19.0, 14.0, 21.0)
    assert tolerance_bound.would_be(Estimate(20.0, 13.95, 22.0), before) == ""
    # The bound that heads the answer, 13.9 h, is of another estimator, and keeps its own name.
    assert tolerance_bound.would_be(Estimate(20.0, 14.2, 22.0), before) == (
        "The lower end of the 95 % interval of the 5 % quantile would be 14.2 h, up from 14 h by"
        " the same method."
    )


def test_an_estimate_without_interval_is_not_promised():
    sentence = answer(linear(samples=20)).lead.tolerance_bound.sentence
    assert re.fullmatch(
        r"About 95 % of values are above .*; about 95 % of values are below .*\.", sentence
    )


def test_failed_rows_lie_beyond_what_could_then_be_promised():
    tolerance_bound = ToleranceBound(0.95, 0.95, 13.9, np.nan, DisplayUnit("h"), is_life=True)
    before, after = Estimate(18.0, 14.5, 21.0), Estimate(20.0, 15.0, 22.0)
    tolerance = TighterTolerance(
        ("x1",), "the 5 % quantile", before, after, tolerance_bound=tolerance_bound
    )
    assert "would be 15 h, up from 14.5 h" in tolerance.bound_sentence
    assert tolerance.bound_sentence.endswith(" from 14.5 h by the same method.")
    tolerance_bound = replace(tolerance_bound, failed=(Estimate(low=13.7, high=21.0), None))
    worst = replace(
        tolerance, tolerance_bound=tolerance_bound, failed=Estimate(low=14.2, high=22.0)
    )
    assert "would be 14.2 h, up from 13.7 h" in worst.bound_sentence
    assert worst.bound_sentence.endswith(" from 13.7 h by the same method.")
    assert replace(worst, failed=Estimate(low=0.0, high=22.0)).bound_sentence == ""
