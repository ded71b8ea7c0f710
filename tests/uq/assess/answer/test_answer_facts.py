"""The answer as a tree of facts: each number has a path, and the functions that computed it."""

import numpy as np
import pytest
from answered import lifetime
from computed import asking, linear, with_output
from fact_trees import walk

import uq
from uq.assess.answer.answer import answer
from uq.assess.fact import Fact
from uq.render.html.keyed_sentences import keyed
from uq.text.keys import key_of


def functions(facts, *path):
    return [function.__name__ for function in facts.at(*path).by]


def test_numbers_of_a_short_answer_are_reached_without_reading_a_sentence():
    ds, conclusions = lifetime()
    facts = conclusions.fact
    asked = tuple(facts.at("asked").content)
    assert asked == ("quantities", "life")
    assert facts.at(*asked, "promise", "lower").content == conclusions.lead.tolerance_bound.lower
    assert facts.at(*asked, "promise", "unit").content == "days"
    b10 = facts.at(*asked, "b_lives", "B10", "value").content
    assert b10 == uq.summary(ds).loc["life", "B10"]
    leader = facts.at(*asked, "ranking", "contributions", "0").content
    assert list(leader.members["inputs"].members) == ["rate"]
    assert leader.members["effects"].members["rate"].members["value"] < 0
    assert facts.at("enough", "settled").content is True
    assumed = facts.at("unmeasured", "assumed_laws").content.members
    assert assumed == {"inputs": ["rate"], "of": 2}
    halved = facts.at("advice", "tighten", "tolerances", "0").content
    assert halved.more["is_share"]
    assert halved.members["after"]["value"] < halved.members["before"]["value"]


def test_each_number_has_the_functions_that_computed_it():
    facts, life = lifetime()[1].fact, ("quantities", "life")
    for path, fact in walk(facts):
        numbers = [name for name, member in fact.members.items() if isinstance(member, float)]
        assert all(facts.at(*path, name).by for name in numbers), path
    assert functions(facts, "rows") == ["status_counts"]
    assert functions(facts, *life, "earliest", "lives") == ["lowest_rows"]
    assert functions(facts, *life, "earliest", "inputs") == ["inputs_apart"]
    assert functions(facts, *life, "promise", "lower_quantile") == ["quantile", "WeightedMixture"]


def test_a_probability_that_censored_rows_leave_open_names_the_estimator_of_the_answer():
    number = np.arange(400.0)
    lives = np.where(number % 7 == 3, 2.0, 1 + number)  # censored before most end
    ds = with_output(linear(samples=400), "life", lives, "lifetime", number % 7 == 3)
    ds = asking(ds, outputs=["life"], thresholds={"life": 200.0})
    path = ("quantities", "life", "events", "P(life<200.0)", "share")
    assert "kaplan_meier" in functions(answer(ds).fact, *path)
    traced = uq.trace(ds, key_of(*path, verb="answer"))
    assert any(entry["code"].endswith("kaplan_meier") for entry in traced["estimators"])
    assert traced["equal"]


def test_errors_without_a_prediction_are_the_numbers_of_the_sufficiency():
    ds = asking(linear(samples=1000), outputs=["y"])
    traced = uq.trace(with_output(ds, "y_error", np.full(1000, 0.2)), "answer/enough")
    assert traced["equal"] and traced["own_error"] == pytest.approx(0.2)
    assert [entry["code"].rpartition(".")[2] for entry in traced["estimators"]] == ["compared"]


@pytest.mark.parametrize(
    ("path", "text", "html"),
    [
        (("a",), None, '<span data-trace="answer/a/b~1c" title="uq trace: answer/a/b~1c">x</span>'),
        (
            ("a",),
            "&",
            '<span data-trace="answer/a/b~1c" title="uq trace: answer/a/b~1c">&amp;</span>',
        ),
        (("nothing",), None, ""),
        (("nothing",), "y", "y"),
    ],
)
def test_a_sentence_shows_the_keys_of_its_numbers(path, text, html):
    facts = Fact({"a": Fact({"b/c": 1.0}, words="x", mentions=(("b/c",),))})
    assert keyed(facts, *path, text=text) == html
