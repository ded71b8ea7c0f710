"""Which tolerance helps most, and which about as much, against known laws."""

import numpy as np
import pytest
from answered import numbers
from computed import asking, computed, study_of

from uq.assess.answer.answer import answer
from uq.render.html.answer import fragment

COEFFICIENTS = {"x1": 1.0, "x2": 2.0, "x3": 3.0, "x4": 4.0}


def sum_of(deviations):
    """Return a result of y = x1 + 2 x2 + 3 x3 + 4 x4 of normal inputs with these deviations."""
    tables = {
        "study": {"name": "linear", "model": "linear"},
        "design": {"method": "monte-carlo", "samples": 8000, "seed": 1},
        "uncertain": {
            name: {"distribution": "normal", "mean": 0.5, "sd": sd, "source": "measured"}
            for name, sd in deviations.items()
        },
    }
    return asking(computed(study_of(tables)), outputs=["y"], wanted={"y": "above"})


def advised(ds):
    (remedy,) = (each for each in answer(ds).advice if each.rule == "tighten")
    return remedy


def quantile(deviations):
    """Return the 5 % quantile: the middle, x1 = 0.5 too, less 1.645 deviations of the sum."""
    sizes = [COEFFICIENTS[name] * sd for name, sd in deviations.items()]
    return 0.5 * sum(COEFFICIENTS.values()) - 1.6449 * np.hypot.reduce(sizes)


ALIKE = {"x2": 0.05, "x3": 0.062, "x4": 0.05}  # deviations of the terms: 0.1, 0.186, 0.2


def test_tolerances_that_help_about_as_much_are_named_together():
    advice = advised(sum_of(ALIKE))
    now, then, low, high = numbers(
        r"Halving the scatter of x4 \(sd 0.025 instead of 0.05\) would change the 5 % quantile"
        r" from # to # \(# to #\)\.",
        advice.sentence,
    )
    assert now == pytest.approx(quantile(ALIKE), abs=0.03)
    assert low < then < high and low < quantile(ALIKE | {"x4": 0.025}) < high
    (then,) = numbers(r"x3 \(5 % quantile #\) would help about as much\.", advice.also)
    assert then == pytest.approx(quantile(ALIKE | {"x3": 0.031}), abs=0.03)
    sure, studied = numbers(
        "The lower end of the 95 % interval of the 5 % quantile would be #, up from # by the"
        " same method.",
        advice.sure.bound_sentence,
    )
    assert studied < now < sure <= low
    assert advice.text == f"{advice.sentence} {advice.sure.bound_sentence} {advice.also}"


def test_each_tolerance_has_its_line_in_the_report():
    ds = sum_of(ALIKE)
    advice = advised(ds)
    assert {each.inputs for each in advice.tolerances} == {("x2",), ("x3",), ("x4",)}
    for each in advice.tolerances:
        (name,) = each.inputs
        expected = quantile(ALIKE | {name: ALIKE[name] / 2})
        assert each.after.value == pytest.approx(expected, abs=0.03)
    page = fragment(answer(ds))
    assert page.count("<details>") == 1 and page.count('<th scope="row">') == 4
    assert all(each.text(each.after) in page for each in advice.tolerances)


def test_one_tolerance_that_helps_most_stands_alone():
    advice = advised(sum_of({"x3": 0.02, "x4": 0.05}))
    assert advice.tightened.inputs == ("x4",) and advice.also == ""


def test_the_tolerance_that_helps_most_need_not_be_that_of_the_leader():
    """Where the leader widens the upper end alone, another input moves the lower end more."""
    ds = sum_of({"x3": 0.05, "x4": 0.05})
    x3, x4 = (ds[name].values - 0.5 for name in ("x3", "x4"))
    ds["y"].values[:] = 3 + np.where(x4 > 0, 8 * x4, x4) + 3 * x3
    advice = advised(ds)
    gains = {each.inputs: each.gain for each in advice.tolerances}
    assert answer(ds).lead.ranking.leader.inputs == ("x4",)
    assert advice.tightened.inputs == ("x3",) and gains["x3",] > 2 * gains["x4",]
