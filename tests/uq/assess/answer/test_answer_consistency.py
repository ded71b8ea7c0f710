"""Sentences of the answer against the rows and against each other, on studies of several kinds."""

from dataclasses import fields, is_dataclass, replace
from functools import cache
from math import isfinite

import answered
import numpy as np
import pytest
from answer_checks import Checker
from answer_contradictions import denied_by_each_other
from computed import asking, computed, kinds, linear, study_of, with_output
from nested_studies import nested_result

from uq.assess.answer.answer import answer
from uq.assess.answer.answer_sentences import Answer
from uq.assess.answer.rankings import Ranking
from uq.assess.fact import Fact

MOVED = 1.9
"""By what a number is multiplied: no interval is as wide."""


def life_of_known_law():
    return answered.lifetime()[0]


def life_with_a_late_threshold():
    """Less scatter lengthens the shortest lives, and lets more end in time."""
    ds = linear(samples=1000)
    life = 1 + 8 * ds["x4"].values + ds["x1"].values
    return asking(
        with_output(ds, "life", life, "lifetime"), outputs=["life"], thresholds={"life": 7.0}
    )


def values_below_a_threshold():
    return asking(linear(samples=1000), outputs=["y"], thresholds={"y": 7.0}, wanted={"y": "below"})


def rows_of_a_crossed_design():
    ds = linear("saltelli", samples=64, replicates=8)
    return asking(ds, outputs=["y"], thresholds={"y": 6.0})


def regimes_and_angles():
    return kinds(samples=400, analysis={"outputs": ["angle"], "thresholds": {"angle": 0.5}})


def some_never_succeed():
    return answered.locking(samples=400)


def nothing_to_find():
    ds = linear(samples=400)
    ds = with_output(ds, "noise", np.random.default_rng(2).normal(10, 1, 400))
    return asking(ds, outputs=["noise"], thresholds={"noise": 11.0})


def a_rare_event_by_pawn():
    """As of the feed of the vibrator: few hits, and a method whose index of them is small."""
    names = {name: {"distribution": "normal", "mean": 0.5, "sd": 0.05} for name in ("x1", "x4")}
    tables = {
        "study": {"name": "rare", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 400, "seed": 4},
        "uncertain": names,
        "analysis": {"thresholds": {"y": 5.4}, "sensitivity": ["delta", "pawn"]},
    }
    return computed(study_of(tables))


def a_start_that_decides():
    """Pairs of repeats that end as their start has it, but one in twenty as its machine."""
    levels = {"x1": "own", "x2": "chance"}
    ds = nested_result(levels=levels, samples=400, units=1)
    ended = ds["x2"].values > 0.5
    ended ^= (np.arange(ds.sizes["row"]) % 20 == 0) & (ds["x1"].values > 0.5)
    attrs = {"role": "output", "kind": "category", "long_name": "how it ended", "units": "1"}
    attrs |= {"may_be_undefined": 0, "flag_values": np.int8([0, 1]), "flag_meanings": "calm rough"}
    ds["x2"].attrs["initial"] = 1
    ds = ds.assign(regime=("row", ended.astype(np.int8), attrs))
    return asking(ds, outputs=["regime", "y"])


def rows_that_err():
    ds = asking(linear(samples=1000), outputs=["y"])
    return with_output(ds, "y_error", np.full(1000, 0.2))


def few_rows():
    return asking(linear(samples=5), outputs=["y"], thresholds={"y": 5.0})


STUDIES = [
    life_of_known_law,
    life_with_a_late_threshold,
    values_below_a_threshold,
    rows_of_a_crossed_design,
    regimes_and_angles,
    some_never_succeed,
    nothing_to_find,
    a_rare_event_by_pawn,
    a_start_that_decides,
    rows_that_err,
    few_rows,
]


@cache
def checked(study):
    ds = study()
    return Checker(ds), answer(ds)


@pytest.mark.parametrize("study", STUDIES)
def test_no_sentence_is_denied_by_the_rows_or_by_another(study):
    checker, conclusions = checked(study)
    assert list(checker.wrong(conclusions)) == []


def mutants(record, path=()):
    """Yield copies of an answer, each with one number changed, and where."""
    for field in fields(record):
        value, here = getattr(record, field.name), (*path, field.name)
        for changed, where in changes(value, here):
            yield replace(record, **{field.name: changed}), where


def changed_sentences(fact, path):
    """Yield copies of a fact, each with one number of its sentence changed, and where."""
    text = fact.sentence
    for match in answered.IN_TEXT.finditer(text):
        if number := float(match[0].rstrip(".")):
            moved = f"{text[: match.start()]}{number * MOVED:.4g}{text[match.end() :]}"
            yield replace(fact, members={**fact.members, "sentence": moved}), (*path, match[0])


def changes(value, path):
    if isinstance(value, float) and isfinite(value) and value:
        yield value * MOVED, path
    elif isinstance(value, Fact):  # its sentence was written with its numbers
        yield from changed_sentences(value, path)
    elif is_dataclass(value) and not isinstance(value, type):
        yield from mutants(value, path)
    elif type(value) is tuple:
        for i, each in enumerate(value):
            for changed, where in changes(each, (*path, i)):
                yield (*value[:i], changed, *value[i + 1 :]), where


def sentences(conclusions: Answer):
    """Return all that an answer says."""
    texts = [*conclusions.lines, *(event.with_cause for event in conclusions.events)]
    for quantity in conclusions.quantities:
        texts += [
            *quantity.head,
            *(event.with_cause for event in quantity.events),
            quantity.ranking_sentence,
        ]
        texts += (
            [each.effect for each in quantity.ranking.contributions] if quantity.ranking else []
        )
        texts += quantity.earliest.lines if quantity.earliest else []
    return texts


@pytest.mark.slow
@pytest.mark.parametrize("study", STUDIES[:-1])
def test_a_changed_number_under_a_sentence_is_noticed(study):
    checker, conclusions = checked(study)
    texts, missed, count = sentences(conclusions), [], 0
    for mutant, path in mutants(conclusions):
        try:
            shown = sentences(mutant)
        except (ValueError, OverflowError):
            continue
        if shown != texts:
            count += 1
            if not list(checker.wrong(mutant)):
                missed.append((path, [new for new, old in zip(shown, texts) if new != old]))  # noqa: B905
    assert count >= 5 and missed == []


def test_contradictions_are_noticed():
    checker, conclusions = checked(life_of_known_law)
    lead = conclusions.lead
    event = replace(lead.events[0], ranking=Ranking("", "", reason="no", is_flat=True))
    flat = replace(conclusions, quantities=(replace(lead, events=(event,)),))
    assert any("Halving the scatter" in text for text in denied_by_each_other(flat))
    assert list(denied_by_each_other(conclusions)) == []


def test_no_input_moves_an_event_that_no_single_input_decides():
    for study in STUDIES:
        conclusions = checked(study)[1]
        for event in conclusions.lead.events if conclusions.lead else ():
            if event.ranking is not None and event.ranking.denies_a_leader:
                assert not any(
                    event.predicate in advice.text
                    for advice in conclusions.advice
                    if advice.rule == "tighten"
                )
