"""The unit in which a quantity is read, in tables and figures alike."""

import numpy as np
import pytest

from uq.text.units import beside, typical, unit_of


@pytest.mark.parametrize(
    ("units", "value", "name", "number"),
    [
        ("m", 2.5e-4, "µm", 250),
        ("m", 0.4, "m", 0.4),
        ("N m-1", 2.07e6, "MN m-1", 2.07),
        ("ohm", 27.5, "ohm", 27.5),
        ("m2 N-1", 1e-14, "10⁻¹⁵ m2 N-1", 10),
        ("rad", np.radians(12), "°", 12),
        ("rad", 7.5e-5, "µrad", 75),
        ("s", 86400.0, "hours", 24),
        ("s", 3e-5, "µs", 30),
        ("1", 1e-6, "1", 1e-6),
        ("m", 0.0, "m", 0),
        ("s", np.inf, "s", np.inf),
    ],
)
def test_a_quantity_is_read_in_a_unit_that_people_use(units, value, name, number):
    unit = unit_of(units, value)
    assert unit.name == name
    assert value / unit.size == pytest.approx(number)


def test_a_block_has_the_unit_of_a_typical_value():
    assert typical([-0.018, 0.0002, 0.018]) == 0.018
    assert typical([0.0, 0.0, np.inf, np.nan, 3.0]) == 3.0
    assert typical([]) == 0.0


@pytest.mark.parametrize("unit", ["", "1"])
def test_a_number_that_ends_in_one_stays_whole(unit):
    assert beside("-2 and 1", unit) == "-2 and 1"
    assert beside("1", unit) == "1"
