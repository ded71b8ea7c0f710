"""Formatting of numbers and laws as text, for tables on a terminal and in a report."""

import re
from collections.abc import Iterable, Sequence
from math import ceil, floor, isclose, isfinite, isnan, log10
from typing import Any

from uq.text.literals import shown
from uq.text.quantities import Written
from uq.text.units import PREFIXED, PURE, ReadableUnit, beside, powers, time_unit, unit_of

HUGE = 1e9
"""Numbers of rows above this limit are written as powers of ten."""


def capitalized(text: str) -> str:
    """Return text with a capital first letter; symbols such as ``k`` or ``x1`` do not change."""
    first = text.split(" ", 1)[0].rstrip(",.:;")
    symbol = len(first) == 1 and first != "a" or re.search(r"[\d_]", first)
    return text if symbol else f"{text[:1].upper()}{text[1:]}"


def number(value: float | None, resolution: float = 0.0) -> str:
    """Return a number for a table, to five digits or its resolution; a dash if it is missing."""
    return "-" if value is None else f"{value:.{digits(value, resolution, 5)}g}"


def digits(value: float, resolution: float, least: int) -> int:
    """Return the number of significant digits that resolves differences of this size.

    Parameters
    ----------
    value : float
    resolution : float
        Difference to resolve; 0 if `least` digits are sufficient.
    least : int

    Returns
    -------
    int
        At most 17, which distinguish all numbers.
    """
    if not (resolution > 0 and isfinite(value) and value):
        return least
    return min(max(least, floor(log10(abs(value))) - floor(log10(resolution)) + 1), 17)


def quantity(value: float, units: str) -> str:
    """Return a value [CF units] in a readable unit: ``13.75 kN m⁻¹``."""
    if isnan(value):
        return "-"
    return in_unit(value, unit_of(units, value))


def in_unit(value: float, unit: ReadableUnit) -> str:
    """Return a value [CF unit] as text in a readable unit: ``250 µm``, ``12°``, or a number."""
    return beside(number(value / unit.size), unit.name)


def in_brackets(unit: ReadableUnit) -> str:
    """Return a unit in brackets, to follow a name: `` [µm]``; "" for a pure number."""
    return "" if unit.name == "1" else f" [{powers(unit.name)}]"


def duration(seconds: float | None) -> str:
    """Return a time as text in hours, days or years; "" below one hour.

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
    return "" if unit.name == "seconds" else f"{seconds / unit.size:.3g} {unit.name}"


_ELAPSED = (("s", 1.0), ("min", 60.0), ("h", 3600.0), ("days", 86400.0))  # unit, its size [s]


def elapsed(seconds: float) -> str:
    """Return the time of a computation as text: ``8.3 s``, ``3 min``, ``2.5 h``, ``4 days``.

    Parameters
    ----------
    seconds : float
        [s]
    """
    fitting = [unit for unit in _ELAPSED if round(seconds) >= unit[1]]
    name, size = fitting[-1] if fitting else _ELAPSED[0]
    value = seconds / size
    return f"{value:.0f} {name}" if value >= 9.95 else f"{float(f'{value:.2g}'):g} {name}"


def threshold(value: float, units: str) -> str:
    """Return a threshold [CF units] as written by the user: ``24 hours``, ``12°``.

    A threshold written without a unit is converted to a readable unit. It is returned as written if
    five digits do not distinguish it from others.
    """
    if isinstance(value, Written):
        return beside(value.number, value.unit.name)
    unit = unit_of(units, value)
    read = float(number(value / unit.size))
    if not isclose(read * unit.size, value, rel_tol=1e-12):
        read, unit = value, ReadableUnit(units, 1.0)
    return beside(f"{read:.15g}", unit.name)


def compared(name: str, is_angle: bool) -> str:
    """Return the variable compared with a threshold, if not the output itself: ``|psi|``."""
    return f"|{name}|" if is_angle else ""


def estimated(label: str, units: str, variable: str = "", asked: Iterable[float] = ()) -> str:
    """Return the readable label of an estimate: ``P(>86400.0)`` becomes ``P(> 24 hours)``.

    Parameters
    ----------
    label : str
        Label of an estimate, or name of an event: ``P(life<86400.0)``.
    units : str
        CF unit of the output.
    variable : str
        The compared variable, if it differs from the variable in the label: ``|psi|``.
    asked : iterable of float
        Thresholds of the study, which may have their own units.

    Returns
    -------
    str
    """
    thresholds = {repr(value): value for value in asked}

    def shown_event(match: re.Match[str]) -> str:
        at = threshold(thresholds.get(match[3], float(match[3])), units)
        return f"P({' '.join(filter(None, (variable or match[1], match[2], at)))})"

    return re.sub(r"^P\(([^<>=]*(?:\[.*\])?)([<>])([^<>]+?)\)", shown_event, label)


def percent(share: float) -> str:
    """Return a share in per cent, to a tenth, with more digits close to 0 and 100 %."""
    if share in (0.0, 1.0):
        return f"{100 * share:.0f} %"
    if 0 < share < 0.01:
        return f"{100 * share:.2g} %"
    rest = round(1 - share, 12)
    return f"{100 * share:.{-floor(log10(100 * rest)) if 0 < rest < 0.001 else 1}f} %"


TO_THESE_DIGITS = "within these digits"


def percent_interval(low: float, high: float) -> str:
    """Return the interval of a share in per cent, or a note that its ends equal the shown share."""
    return TO_THESE_DIGITS if percent(low) == percent(high) else percent_range(low, high)


def percent_range(low: float, high: float) -> str:
    """Return two shares in per cent, or a single one if both have the same text."""
    if percent(low) == percent(high):
        return percent(low)
    return f"{percent(low).removesuffix(' %')} to {percent(high)}"


def rows_in_words(rows: float) -> str:
    """Return a number of rows, rounded up to two digits; a power of ten if very large."""
    if rows > HUGE:
        return f"{rows:.0e}".replace("e+", "e")
    return grouped(rounded_up(rows))


def rounded_up(count: float) -> int:
    """Return the next count of two digits: 4 200 for 4 130."""
    digit = 10 ** max(floor(log10(count)) - 1, 0)
    return ceil(count / digit) * digit


def counted(count: int, singular: str, plural: str = "") -> str:
    """Return a count with its noun: ``1 row``, ``3 rows``, ``4 000 rows``.

    Parameters
    ----------
    count : int
    singular : str
        The word for a count of one.
    plural : str, optional
        By default the singular with an s.
    """
    return f"{grouped(count)} {singular if count == 1 else plural or f'{singular}s'}"


def grouped(rows: int) -> str:
    """Return a number of rows with separated thousands."""
    return f"{rows:,}".replace(",", " ")


def listed(labels: Sequence[str], most: int = 8) -> str:
    """Return the labels of a category as a list; only the first and last if there are many."""
    displayed = labels if len(labels) <= most else (*labels[:3], "...", labels[-1])
    return ", ".join(displayed)


def law(stated: Any) -> str:
    """Return the law of an input, numbers to six digits: ``normal(mean = 1.0, sd = 0.1)``."""
    given = _arguments(stated)
    given |= {n: float(f"{value:.6g}") for n, value in given.items() if isinstance(value, float)}
    arguments = ", ".join(f"{name} = {shown(value)}" for name, value in given.items())
    return f"{stated.distribution}({arguments})"


def law_in_unit(stated: Any, unit: ReadableUnit) -> str:
    """Return the law of an input in a unit, to six digits: ``normal: mean 250 µm, sd 25 µm``."""

    def words(name: str, value: Any) -> str:
        if isinstance(value, str):
            return value
        argument_unit = PURE if name in stated.pure else unit
        values = value if isinstance(value, tuple) else (value,)
        numbers = [f"{entry / argument_unit.size:.6g}" for entry in values]
        return beside(
            " to ".join(numbers) if name == "truncate" else listed(numbers), argument_unit.name
        )

    given = (f"{name} {words(name, value)}" for name, value in _arguments(stated).items())
    return f"{stated.distribution}: {', '.join(given)}"


def _arguments(stated: Any) -> dict[str, Any]:
    without = {"distribution", "source", "times", "level"}
    given: dict[str, Any] = stated.model_dump(exclude=without, exclude_none=True)
    if given.get("file") is not None:
        given.pop("values", None)  # a result keeps only the name of the file
    return given


_NUMBER = re.compile(r"(?<![^\s(\[])-?(?:\d[\d.]*(?:e[-+]?\d+)?|∞|inf)(?![\w-])")
_TIMES = "minutes?|hours?|days?|years?"
_FACTOR = rf"[pnµmkMG]?(?:{'|'.join(sorted(PREFIXED - {'ohm'}))}|Ω|g)[⁻⁰¹²³⁴-⁹]*(?![\w⁻])"
_UNIT = re.compile(rf"(?<=\d)(?: {_FACTOR})+|(?<=\d) (?=(?:{_TIMES}|%)(?!\w))")
_POWER = r"(?<=\d) (?=× 10)|(?<=×) (?=10)"
_GROUP = r"(?<=\d) (?=\d{3}(?!\d))"
_DIFFERENCE = r"(?<=[₀-₉]) (?=[−+] )|(?<=[₀-₉] [−+]) "
_BEFORE_POWER = re.compile(rf"(?<=\w) (?=\w{{1,3}}[⁻⁰¹²³⁴-⁹])|{_POWER}|{_GROUP}|{_DIFFERENCE}")


def minus(text: str) -> str:
    """Return text with minus signs instead of hyphens in its numbers: ``−1.5e−05``.

    Hyphens in names, dates, code of laws in a study file and options of commands do not change.
    """
    return _NUMBER.sub(lambda match: match[0].replace("-", "\N{MINUS SIGN}"), text)


def printed(text: str) -> str:
    """Return text for a page: minus signs, a dash for a missing number, no breaks in numbers."""
    if text == "-":
        return "\N{EN DASH}"
    text = _UNIT.sub(lambda match: match[0].replace(" ", "\N{NO-BREAK SPACE}"), minus(text))
    return _BEFORE_POWER.sub("\N{NO-BREAK SPACE}", text)
