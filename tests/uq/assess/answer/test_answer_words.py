"""Inputs, bounds and numbers of rows in the words of the answer."""

import numpy as np

from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.answer.wording import DisplayUnit, called_together, rounded
from uq.text.numbers import rows_in_words


def test_twins_are_named_together():
    assert called_together(["bearing_constant_1", "bearing_constant_2"]) == "both bearing constants"
    assert called_together(["unbalance_1"]) == "unbalance 1"
    assert called_together(["a", "b_1", "c"]) == "a, b 1 and c"
    assert called_together(["b_2", "c_1", "b_1", "a"]) == "both bs, c 1 and a"


def test_bounds_are_rounded_to_the_safe_side():
    assert rounded(1.1879, -np.inf) == "1.18" and rounded(1.1821, np.inf) == "1.19"
    assert rounded(1.18, -np.inf) == rounded(1.18, np.inf) == "1.18"
    assert rounded(-0.0012345, -np.inf) == "-0.00124"
    assert (rounded(5e-324), rounded(1.7976e308, np.inf)) == ("4.94e-324", "1.8e+308")
    bound = ToleranceBound(0.95, 0.95, np.nan, 1.1821, DisplayUnit("m"))
    assert bound.sentence == "With 95 % confidence, at least 95 % of values are below 1.19 m."


def test_numbers_of_rows_are_rounded_up():
    assert [rows_in_words(n) for n in (8, 59, 1234, 98765)] == ["8", "59", "1 300", "99 000"]


def test_thousands_are_written_out():
    shown = [rounded(value) for value in (999.4, 999.6, 1234.0, -1500.0, 9994.0, 12345.0)]
    assert shown == ["999", "1000", "1230", "-1500", "9990", "1.23e+04"]
    assert rounded(1120.4, np.inf) == "1130" and rounded(1120.4, -np.inf) == "1120"
