"""Numbers, intervals and laws in the words of a table, on a terminal and in a report."""

from collections.abc import Mapping
from math import floor, isfinite, log10
from typing import Any, NamedTuple

from uq.literals import shown

Entry = Mapping[str, Any]
"""An estimate in plain data: ``value``, ``low``, ``high``, and why one of them is None."""


def number(value: float | None) -> str:
    """Return a number for a table; a dash for none."""
    return "-" if value is None else f"{value:.5g}"


def duration(seconds: float | None) -> str:
    """Return a time in hours, days or years; nothing for less than an hour.

    Parameters
    ----------
    seconds : float or None
        [s]

    Returns
    -------
    str
    """
    if seconds is None or not isfinite(seconds):
        return ""
    unit = time_unit(abs(seconds))
    return "" if unit.name == "seconds" else f"{seconds / unit.seconds:.3g} {unit.name}"


def known(entry: Entry, key: str = "value", per: float = 1.0) -> str:
    """Return one number of an entry, or why there is none.

    Parameters
    ----------
    entry : dict
    key : str
    per : float
        What the number is divided by: the length of a unit.

    Returns
    -------
    str
    """
    if entry[key] is not None:
        return number(entry[key] / per)
    if key == "value" and "rows_needed" in entry:
        return f"needs {entry['rows_needed']} rows"
    if key == "value" and "kaplan_meier" in entry:  # it may lie within the horizon
        return "-"
    prefix = "" if key == "value" else f"{key}_"
    if entry.get(f"{prefix}never"):
        return "never"
    return "beyond the horizon" if entry.get(f"{prefix}censored") else "-"


def interval(entry: Entry, per: float = 1.0) -> str:
    """Return the ends of the interval of an entry; nothing where it has none, or both never."""
    ends = [known(entry, end, per) if end in entry else "-" for end in ("low", "high")]
    return "" if ends == ["-", "-"] or ends[0] == "never" else " to ".join(ends)


def failed_interval(entry: Entry, per: float = 1.0) -> str:
    """Return the bounds with failed rows at best and at worst; nothing where no row failed."""
    if "failed_low" not in entry:
        return ""
    low, high = (known(entry, f"failed_{end}", per) for end in ("low", "high"))
    if low == "-":
        return "no bound" if high == "-" else f"up to {high}"
    return f"from {low} on" if high == "-" else f"{low} to {high}"


def estimated(label: str, per: float = 1.0) -> str:
    """Return what is estimated: ``P(>86400.0)`` is ``P(> 24)`` in a table of hours."""
    if not label.startswith("P("):
        return label
    return f"{label[:3]} {number(float(label[3:-1]) / per)})"


def brief(entry: Entry, per: float = 1.0) -> tuple[str, str]:
    """Return an estimate for a sentence, no more exact than it is known, and its interval.

    Parameters
    ----------
    entry : dict
    per : float
        What the numbers are divided by: the length of a unit.

    Returns
    -------
    tuple of str
        The interval is "" where there is none.
    """
    found: list[Any] = [entry.get(key) for key in ("value", "low", "high")]
    if None in found or not found[2] > found[1]:
        told = known(entry, per=per) if found[0] is None else f"{found[0] / per:.3g}"
        return told, interval(entry, per)
    decimals = -floor(log10((found[2] - found[1]) / per / 3))
    value, low, high = (_rounded(one / per, decimals) for one in found)
    return value, f"{low} to {high}"


def _rounded(value: float, decimals: int) -> str:
    rounded = round(value, decimals) + 0.0  # no minus sign before what is zero
    return f"{rounded:.{decimals}f}" if 0 <= decimals <= 6 else number(rounded)


def percent(share: float) -> str:
    """Return a share in per cent: to a tenth, or more exactly where it is close to none or all."""
    if 0 < share < 0.01:
        return f"{100 * share:.2g} %"
    rest = round(1 - share, 12)
    return f"{100 * share:.{-floor(log10(100 * rest)) if 0 < rest < 0.001 else 1}f} %"


def percent_with_interval(entry: Entry) -> str:
    """Return a share in per cent, with its interval where it has one."""
    ends = [entry[end] for end in ("low", "high")]
    told = percent(entry["value"])
    if None in ends:
        return told
    bounds = [entry[end] for end in ("failed_low", "failed_high") if entry.get(end) is not None]
    worst = f"; with failed rows {percent_interval(*bounds)}" if len(bounds) == 2 else ""
    return f"{told} ({percent_interval(*ends)}{worst})"


def percent_interval(low: float, high: float) -> str:
    """Return the ends of the interval of a share in per cent."""
    return f"{percent(low).removesuffix(' %')} to {percent(high)}"


def accuracy_not_reached(accuracy: Entry) -> str:
    """Return in how many rows the stated error exceeds the accuracy asked for."""
    missed, share = accuracy["missed"], percent(accuracy["share"])
    rows = f"{missed} row{'s' if missed > 1 else ''} ({share})"
    return f"accuracy {accuracy['asked']:g} not reached in {rows}"


def variance_between(split: Entry) -> str:
    """Return the share of variance between regimes, less what chance makes of it."""
    return number(split["value"]) if split["value"] > 0 else "none seen"


def law(stated: Any) -> str:
    """Return the law of an input as one would say it: ``normal(mean = 1.0, sd = 0.1)``."""
    given = stated.model_dump(exclude={"distribution", "source", "times"}, exclude_none=True)
    if given.get("file") is not None:
        del given["values"]
    arguments = ", ".join(f"{name} = {shown(value)}" for name, value in given.items())
    return f"{stated.distribution}({arguments})"


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
