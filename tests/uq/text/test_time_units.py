"""One table of units of time, for tables and figures alike."""

import pytest

from uq.cli.printing import duration
from uq.text.numbers import time_unit


@pytest.mark.parametrize(
    ("seconds", "name"),
    [
        (0.0, "seconds"),
        (3599.0, "seconds"),
        (3600.0, "hours"),
        (1.7e5, "hours"),
        (2e5, "days"),
        (6.3e7, "days"),
        (1e8, "years"),
    ],
)
def test_a_time_is_said_in_the_unit_people_use(seconds, name):
    assert time_unit(seconds).name == name
    assert duration(seconds).endswith(name if name != "seconds" else "")
    assert bool(duration(seconds)) == (name != "seconds")
