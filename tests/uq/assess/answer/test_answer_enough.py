"""Whether the rows are enough, for what the study is about and besides."""

import re

import numpy as np
import pytest
from answered import lifetime, numbers
from computed import asking, kinds, linear, with_output

from uq import answer, trace
from uq.assess.answer.answer import verdict
from uq.assess.findings import Findings
from uq.render.html.answer import fragment
from uq.result.result import Result


def rules(conclusions):
    return [advice.rule for advice in conclusions.advice]


def test_enough_rows_say_so_with_what_another_seed_would_find():
    ds, conclusions = lifetime()
    assert conclusions.enough.question == () and not conclusions.enough.errors
    low, high = numbers(
        r"Sample size is sufficient: in a repeat with another seed, the 5 % quantile would be #"
        r" to #"
        r" days \(95 %\); rate would again contribute most\.",
        conclusions.enough.sentence,
    )
    assert low < conclusions.lead.tolerance_bound.quantiles[0].value / 86400 < high
    assert verdict(Findings(Result(ds))) == [
        "Sample size is sufficient for all results of the study."
    ]
    assert conclusions.enough.sentence.split(":")[0] in fragment(conclusions)


def test_too_few_rows_say_so():
    ds = linear(samples=200)
    ds = with_output(ds, "rare", np.r_[np.ones(8), np.zeros(192)] + 1e-6 * ds["x1"].values)
    conclusions = answer(asking(ds, outputs=["rare"], thresholds={"rare": 0.5}))
    sentence = "Sample size is not sufficient for all of this. In a repeat with another seed, "
    assert conclusions.enough.sentence.startswith(sentence)
    assert "rows" in rules(conclusions)


def test_rows_are_advised_for_what_the_study_is_about_alone():
    """Four inputs contribute alike to the second output: their order is never settled."""
    ds = linear(samples=1000)
    ds = with_output(ds, "even", sum(ds[name].values for name in ("x1", "x2", "x3", "x4")))
    asked = asking(ds, outputs=["y", "even"])
    conclusions = answer(asked)
    assert "rows" not in rules(conclusions) and conclusions.enough.sentence.startswith(
        "Sample size is sufficient: "
    )
    (sentence,) = conclusions.enough.others
    assert sentence.startswith("The order of x") and "(meaning of even)" in sentence
    assert "Other results not settled</summary><ul><li>The order of x" in fragment(conclusions)
    first, second = verdict(Findings(Result(asked)))
    assert first == "Sample size is sufficient for the main question of the study."
    assert second.startswith("More rows needed: the order of x")
    assert "all questions of the study are settled" not in repr(conclusions)
    assert "rows" in rules(answer(asking(ds, outputs=["even"])))


def test_inputs_that_many_rows_do_not_tell_apart_contribute_alike():
    ds = linear(samples=6000, seed=4)
    ds = with_output(ds, "even", sum(ds[name].values for name in ("x1", "x2", "x3", "x4")))
    conclusions = answer(asking(ds, outputs=["even"]))
    sentence = conclusions.lead.ranking.sentence
    assert re.fullmatch(
        r"(x\d, ){3}x\d contribute about equally: S1 is at most 0\.2\d\.", sentence
    ), sentence
    assert "rows" not in rules(conclusions) and conclusions.enough.sentence.startswith(
        "Sample size is sufficient: "
    )


def test_where_many_inputs_contribute_little_none_explains_much():
    ds = linear(samples=6000)
    noise = np.random.default_rng(1).normal(0.0, 1.5, 6000)
    faint = noise + sum(ds[name].values for name in ("x1", "x2", "x3", "x4"))
    conclusions = answer(asking(with_output(ds, "faint", faint), outputs=["faint"]))
    sentence = conclusions.lead.ranking.sentence
    assert re.fullmatch(
        r"No single input explains much alone: S1 is at most 0\.0\d, and single inputs leave 8\d %"
        r" \(8\d to 9\d %\) unexplained; a 'saltelli' design shows whether inputs interact\.",
        sentence,
    ), sentence
    assert conclusions.lead.ranking.denies_a_leader and "rows" not in rules(conclusions)


def test_where_the_rows_themselves_err_more_than_sampling_more_of_them_do_not_help():
    ds = asking(linear(samples=1000), outputs=["y"])
    conclusions = answer(with_output(ds, "y_error", np.full(1000, 0.2)))
    half = 1.96 * ds["y"].values.std() / 1000**0.5
    solver_error, sampling = numbers(
        r"Reduce numerical error \(finer settings or longer averages\) before adding rows: it may"
        r" change the mean by #, sampling by #\.",
        conclusions.advice[0].text,
    )
    assert solver_error == 0.2 and sampling == pytest.approx(half, rel=0.03)
    assert rules(conclusions)[0] == "finer" and not {"rows", "nothing"} & {*rules(conclusions)}
    assert conclusions.enough.sentence.startswith(
        "Numerical error dominates: more accurate rows would help, more rows not. In a repeat"
        " with another seed, "
    )
    exact = answer(with_output(ds, "y_error", np.full(1000, 0.01)))
    assert "finer" not in rules(exact)
    assert exact.enough.sentence.startswith("Sample size is sufficient: ")


def test_where_the_study_is_about_the_regimes_their_shares_decide():
    conclusions = answer(kinds(samples=400, analysis={"outputs": ["regime", "work"]}))
    low, high = numbers(
        r"Sample size is sufficient: in a repeat with another seed, # to # % would be slow \(95"
        r" %\).*",
        conclusions.enough.sentence,
    )
    assert low < 100 * conclusions.regimes[0].share.value < high


def test_numbers_of_the_errors_and_the_shares_can_be_traced():
    ds = asking(linear(samples=1000), outputs=["y"])
    ds = with_output(ds, "y_error", np.full(1000, 0.2))
    assert trace(ds, "answer/enough/own_error")["value"] == pytest.approx(0.2)
    regimes = kinds(samples=400, analysis={"outputs": ["regime", "work"]})
    document = trace(regimes, "answer/enough/expected/low")
    assert document["equal"] and document["value"] == pytest.approx(
        answer(regimes).enough.again.members["expected"]["low"]
    )


def test_without_rows_or_intervals_nothing_is_called_enough():
    few = answer(asking(linear("latin-hypercube", samples=64), outputs=["y"]))
    assert "is sufficient" not in few.enough.sentence and "rows" in rules(few)
    conclusions = answer(linear(samples=1))
    assert "is sufficient" not in conclusions.enough.sentence and "rows" in rules(conclusions)


def test_regimes_that_are_not_settled_are_said_in_a_sentence():
    conclusions = answer(kinds(samples=64, analysis={"outputs": ["regime", "work"]}))
    (rows,) = (advice.text for advice in conclusions.advice if advice.rule == "rows")
    assert (
        ": the share that are slow is uncertain" in rows
        or ": the share that are fast is uncertain" in rows
    )
    assert "the share that slow" not in repr(conclusions) and "the share that fast" not in repr(
        conclusions
    )
