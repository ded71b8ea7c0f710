"""Numbers, intervals and laws in the words of a table, on a terminal and in a report."""

from collections.abc import Mapping
from math import isfinite
from typing import Any

from uq.literals import shown
from uq.time_units import time_unit

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
    prefix = "" if key == "value" else f"{key}_"
    if entry.get(f"{prefix}never"):
        return "never"
    return "beyond the horizon" if entry.get(f"{prefix}censored") else "-"


def interval(entry: Entry, per: float = 1.0) -> str:
    """Return the ends of the interval of an entry; nothing where it has none, or both never."""
    ends = [known(entry, end, per) if end in entry else "-" for end in ("low", "high")]
    return "" if ends in (["-", "-"], ["never", "never"]) else " to ".join(ends)


def law(stated: Any) -> str:
    """Return the law of an input as one would say it: ``normal(mean = 1.0, sd = 0.1)``."""
    given = stated.model_dump(exclude={"distribution", "source", "times"}, exclude_none=True)
    if given.get("file") is not None:
        del given["values"]
    arguments = ", ".join(f"{name} = {shown(value)}" for name, value in given.items())
    return f"{stated.distribution}({arguments})"
