"""Units that xarray would turn into time differences, cutting numbers off and losing infinity."""

import pytest

from uq.text.quantities import fault_of_unit


@pytest.mark.parametrize(
    ("unit", "meant"),
    [("milliseconds", "ms"), ("Microseconds", "us"), ("nanoseconds", "ns"), ("Days", "d")],
)
def test_a_unit_that_is_decoded_is_refused(unit, meant):
    assert fault_of_unit(unit) == f"write it as '{meant}'"
    assert fault_of_unit(meant) == ""
