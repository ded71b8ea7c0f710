"""Units in which people picture a time."""

from typing import NamedTuple


class TimeUnit(NamedTuple):
    """A unit of time, its length [s], and the time [s] from which people use it."""

    name: str
    seconds: float
    used_from: float


_DAY = 86400.0
_YEAR = 365.25 * _DAY
_TIME_UNITS = (
    TimeUnit("seconds", 1.0, 0.0),
    TimeUnit("hours", 3600.0, 3600.0),
    TimeUnit("days", _DAY, 2 * _DAY),
    TimeUnit("years", _YEAR, 2 * _YEAR),
)


def time_unit(seconds: float) -> TimeUnit:
    """Return the unit in which people say a time [s] that is not negative."""
    return [unit for unit in _TIME_UNITS if seconds >= unit.used_from][-1]
