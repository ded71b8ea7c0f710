"""The tables of ``uq compare``: in units people use, marked where there is a difference."""

import re

import numpy as np
import pytest
from computed import asking, computed, linear, study_of, with_output, with_status

from uq.contract import Status
from uq.files.whole_files import write_result

DAY = 86400.0


@pytest.fixture
def compared(uq, folder):
    """Return a function that compares two results: the lines printed, split into words."""

    def lines(first, other):
        write_result(first, folder / "a.nc")
        write_result(other, folder / "b.nc")
        ended = uq("compare", "a.nc", "b.nc")
        assert (ended.code, ended.err) == (0, "")
        return [line.split() for line in ended.out.splitlines()]

    return lines


def lives(factor):
    values = factor * DAY * np.r_[np.linspace(5, 15, 62), np.nan, np.nan]
    ds = with_output(linear(samples=64), "life", values, "lifetime")
    ds = with_status(ds, [62, 63], Status.RAISED)
    return asking(ds, outputs=["life"], thresholds={"life": [7 * DAY]})


def line(lines, *label):
    """Return what stands behind a label, where it stands first."""
    return next(text[len(label) :] for text in lines if tuple(text[: len(label)]) == label)


def test_lives_are_given_in_days_with_all_that_belongs_to_them(compared):
    lines = compared(lives(1.0), lives(1.5))
    a, b, apart, low, _, high, mark = line(lines, "mean")
    assert (a, b, apart, mark) == ("10", "15", "5", "*")
    assert 4 < float(low) < 5 < float(high) < 6
    assert line(lines, "P(>", "7", "days)")[:3] == ["0.79032", "1", "0.20968"]
    assert line(lines, "A", "a.nc") == "linear (64 rows; 2 raised)".split()


def test_a_mark_stands_where_an_interval_excludes_no_difference(compared):
    lines = compared(lives(1.0), lives(1.0))
    assert not any("*" in text for text in lines)
    assert line(lines, "sd,", "B", "over", "A") == ["1", "identical", "rows"]
    assert line(lines, "mean")[-3:] == ["0", "identical", "rows"]
    fewer = compared(lives(1.5), lives(1.0))
    assert line(fewer, "mean")[-1] == "*"
    assert line(fewer, "sd,", "B", "over", "A") == ["0.66667"]  # of 62 rows, without an interval


@pytest.mark.parametrize(("lower", "moved"), [(0.25, ""), (0.0, r", mean 0\.5\d* to 0\.25\d*")])
def test_what_a_change_of_one_input_did_is_a_sentence(compared, lower, moved):
    def study(lower, upper):
        law = {"distribution": "uniform", "lower": lower, "upper": upper}
        design = {"method": "sobol", "samples": 256, "replicates": 8}
        tables = {"study": {"name": "one", "model": "linear"}, "design": design}
        return computed(study_of(tables | {"uncertain": {"x1": law}}))

    lines = compared(study(0.0, 1.0), study(lower, lower + 0.5))
    words = " ".join(" ".join(text) for text in lines)
    assert re.search(rf"Only x1 differs \(sd 0\.28\d* to 0\.14\d*{moved}\)\.", words)
    assert "sd of y: 0.5 times its former value" in words and "75% less variance." in words
