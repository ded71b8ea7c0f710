"""Inspections that no row agrees with: the refusal names those that contradict."""

import numpy as np
import pytest
from learnt_studies import measured, wear
from worn_studies import pads

from uq.errors import InputError
from uq.explore.updating import update

LEFT = "depth[side=left]"


@pytest.fixture(scope="module")
def batch():
    return wear(samples=300, rate="shared", units=3)


def life(unit, kind, time):
    return {"unit": unit, "output": "life", "kind": kind, "time": time}


def depth(unit, kind, time, value):
    return {"unit": unit, "output": LEFT, "kind": kind, "time": time, "value": value}


def refusal(ds, told):
    with pytest.raises(InputError) as refused:
        update(ds, told)
    return refused.value.lines


def test_a_line_that_no_row_agrees_with(batch):
    told = [*measured(5e5), life("B", "ended", 1.0), life("C", "survived", 1e12)]
    assert refusal(batch, told) == (
        "inspection 2 (unit B, life, ended): no row of this result agrees with it",
        "inspection 3 (unit C, life, survived): no row of this result agrees with it",
    )


def test_two_lines_of_a_unit_that_contradict_each_other():
    told = [
        depth("B", "below", 10.0, 90.0),
        depth("A", "above", 20.0, 60.0),
        depth("A", "below", 30.0, 50.0),
    ]
    assert refusal(pads(samples=300), told) == (
        "inspection 2 (unit A, depth[side=left], above) and inspection 3 (unit A, depth[side=left],"
        " below): no row of this result agrees with both",
    )


def test_all_lines_of_a_unit_together():
    """A noise that only one row has, and a wear that stops early, as in rows on either side."""
    stop = {"distribution": "uniform", "lower": 60.0, "upper": 140.0}
    ds = pads(samples=30, units=1, stop=stop)
    by_noise = ds.sortby("noise")
    noise, late = by_noise["noise"].values, by_noise["stop"].values > 100
    row = int(np.flatnonzero(late)[late.sum() // 2])
    told = [
        {"unit": "A", "output": "noise", "kind": kind, "value": (noise[row] + beside) / 2}
        for kind, beside in (("above", noise[row - 1]), ("below", noise[row + 1]))
    ]
    assert refusal(ds, [*told, depth("A", "below", 1e4, 60.0)]) == (
        "unit A: no row of this result agrees with all its inspections (inspection 1, inspection 2,"
        " inspection 3)",
    )


def test_units_that_share_what_contradicts():
    ds = pads(samples=300)
    told = [depth("A", "above", 20.0, 30.0), depth("B", "below", 20.0, 25.0)]
    assert refusal(ds, told) == (
        "units A and B: no row of this result agrees with the inspections of both (inspection 1,"
        " inspection 2)",
    )


def test_an_input_of_its_own_contradicts_no_other_unit():
    ds = pads(samples=300, level="own")
    told = [depth("A", "above", 20.0, 30.0), depth("B", "below", 20.0, 25.0)]
    assert update(ds, told)["weight"].sum() > 0
