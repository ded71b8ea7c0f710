"""Facts form a tree: each number in it has functions, rows and notes."""

from dataclasses import replace

import pytest
from fact_trees import walk

from uq.assess.fact import Fact
from uq.result.result import Result


def mean():
    """Return the mean."""


def low():
    """Return the lower end."""


def quality():
    """Return the quality."""


ROWS = object.__new__(Result)
TREE = Fact(
    {
        "n": 4,
        "rows": Fact(3, (quality,), rows=ROWS),
        "y": Fact({"a/b": {"value": Fact(1.5, (low,)), "words": "b"}, "list": [{"x": 2}]}),
    },
    (mean,),
    notes=("all",),
)


def test_plain_data_have_the_order_of_the_members():
    assert list(TREE.json.items()) == [
        ("n", 4),
        ("rows", 3),
        ("y", {"a/b": {"value": 1.5, "words": "b"}, "list": [{"x": 2}]}),
    ]


@pytest.mark.parametrize(
    ("path", "number", "by", "rows"),
    [
        (("n",), 4, mean, None),
        (("rows",), 3, quality, ROWS),
        (("y", "list", "0", "x"), 2, mean, None),
        (("y", "a/b", "value"), 1.5, low, None),
    ],
)
def test_a_number_has_the_functions_and_rows_of_the_nearest_fact(path, number, by, rows):
    place = TREE.at(*path)
    assert (place.json, place.by, place.rows) == (number, (by,), rows)


@pytest.mark.parametrize("path", [("m",), ("n", "x"), ("rows", "x"), ("y", "list", "1")])
def test_a_path_that_leads_nowhere_is_refused(path):
    with pytest.raises(KeyError):
        TREE.at(*path)


def test_a_change_reaches_every_fact():
    changed = TREE.each(lambda fact: replace(fact, by=fact.by and (quality, *fact.by)))
    assert changed.at("y", "a/b", "value").by == (quality, low)
    assert changed.at("y", "list", "0").by == (quality, mean) and changed.json == TREE.json
    assert {path for path, _ in walk(TREE)} == {(), ("rows",), ("y",), ("y", "a/b", "value")}
