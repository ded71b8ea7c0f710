"""The answer where little or nothing can be said."""

import json

import numpy as np
import pytest
from computed import asking, linear, with_output, with_status

from uq import answer
from uq.contract import Status
from uq.render.html.answer import fragment

DAY, ROWS = 86400.0, 200


def lives(values, censored=None, days=10):
    ds = with_output(linear(samples=len(values)), "life", np.array(values), "lifetime", censored)
    return asking(ds, outputs=["life"], thresholds={"life": f"{days} days"})


def values(of, **more):
    ds = with_output(linear(samples=len(of)), "z", np.array(of, dtype=float))
    return asking(ds, outputs=["z"], thresholds={"z": "1 m"}, **more)


def all_failed():
    ds = linear(samples=ROWS)
    ds = with_status(ds.assign(y=ds["y"] * np.nan), range(ROWS), Status.RAISED)
    ds["y"].attrs = linear(samples=ROWS)["y"].attrs
    return asking(ds, outputs=["y"], thresholds={"y": 5.0})


def all_censored():
    return lives(np.full(ROWS, 5 * DAY), np.ones(ROWS, dtype=bool))


def none_ends():
    return lives(np.full(ROWS, np.inf))


def one_ends():
    return lives([3 * DAY] + [np.inf] * (ROWS - 1))


def one_row():
    return lives([3 * DAY])


def all_alike():
    return lives(np.full(ROWS, 3 * DAY))


def all_undefined():
    return values(np.full(ROWS, np.nan))


CASES = [all_failed, all_censored, none_ends, one_ends, one_row, all_alike, all_undefined]


@pytest.mark.parametrize("case", CASES)
def test_every_reader_gets_an_answer(case):
    conclusions = answer(case())
    text = repr(conclusions)
    assert not {"nan", "inf", "None"} & {*text.replace("(", " ").replace("%", " ").split()}
    assert fragment(conclusions).startswith('<div class="answer">')
    json.dumps(conclusions.fact.json, allow_nan=False)


def test_where_all_rows_fail_nothing_else_is_advised():
    conclusions = answer(all_failed())
    assert conclusions.lines[0] == "200 of 200 rows are invalid."
    assert [advice.rule for advice in conclusions.advice] == [
        "failed"
    ] and not conclusions.enough.sentence


def test_an_event_beyond_the_horizon_is_not_settled_by_rows():
    conclusions = answer(all_censored())
    assert conclusions.lead.tolerance_bound.sentence.endswith("last longer than 5 days.")
    (advice,) = conclusions.advice
    assert advice.text == (
        "More rows would not help: the share that fail within 10 days cannot be estimated: it is"
        " after the last"
        " observation."
    )
    assert "is settled" not in repr(conclusions)


def test_where_none_ends_the_rows_are_enough():
    conclusions = answer(none_ends())
    assert conclusions.lead.first.sentence == "0 % (0 to 1.8 %) fail within 10 days."
    assert conclusions.enough.sentence.startswith(
        "Sample size is sufficient: in a repeat with another seed, 0 to "
    )
    assert conclusions.lead.earliest is None


def test_a_single_life_has_the_unit_of_a_person():
    conclusions = answer(one_ends())
    assert conclusions.lead.earliest.first == "Row 0 (3 days) fails first."


def test_one_row_settles_nothing():
    conclusions = answer(one_row())
    assert conclusions.enough.sentence.startswith("Sample size is not sufficient for all of this.")
    assert [advice.rule for advice in conclusions.advice] == ["rows"]


def test_of_lives_that_are_all_alike_none_ends_first():
    conclusions = answer(all_alike())
    assert conclusions.lead.earliest is None and "again be 3 days" in conclusions.enough.sentence


def test_an_output_that_no_row_has_is_left_out():
    conclusions = answer(all_undefined())
    assert conclusions.quantities == () and conclusions.lines == ["All 200 rows were computed."]
