"""Depths of which rows know only bounds: where wear stops, and beyond the horizon."""

import numpy as np
import pytest
from scipy.stats import norm
from worn_studies import RATE, pads

from uq.errors import RunError
from uq.explore.updating import update

STOPS = {"distribution": "discrete-choice", "values": [20.0, 1e8], "weights": [1, 9]}
"""One pad in ten stops wearing before the first declared depth, 50 mm."""


def inspection(kind, value, time=30.0):
    output = "depth[side=left]"
    return {"unit": "A", "time": time, "output": output, "kind": kind, "value": value}


@pytest.fixture(scope="module")
def some_stop():
    return pads(stop=STOPS, units=1)


def test_what_all_depths_between_agree_with_is_no_question(some_stop):
    after = update(some_stop, [inspection("below", 60.0)])
    stopped = after["stop"].values < 50
    share = np.average(stopped, weights=after["weight"].values)
    others = 0.9 * norm.cdf(np.log(60 / 30 / RATE[0]) / RATE[1])
    assert share == pytest.approx(0.1 / (0.1 + others), abs=0.02)


def test_what_they_leave_open_asks_for_more_depths(some_stop):
    with pytest.raises(RunError, match="or their wear stops between two of its depths; .*depths"):
        update(some_stop, [inspection("above", 10.0)])


def test_what_a_horizon_leaves_open_asks_for_a_longer_one():
    with pytest.raises(RunError, match="before its inspections; run the study with a longer"):
        update(pads(300, settings={"horizon": 80.0}), [inspection("below", 60.0, time=90.0)])
