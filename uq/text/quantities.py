"""Parser of quantities with units: ``24 hours``, ``12 degrees``, ``30 mm/s``."""

import re
from contextlib import suppress
from difflib import get_close_matches
from fractions import Fraction
from math import pi

from uq.errors import InputError, nearest
from uq.text.units import DEGREES, PREFIXED, ReadableUnit

_TIMES = {"min": "minutes", "h": "hours", "d": "days", "a": "years"}
_SECONDS = {"min": 60, "h": 3600, "d": 86400, "a": 31557600}
_PREFIXES = {"p": -12, "n": -9, "u": -6, "µ": -6, "μ": -6, "m": -3, "c": -2, "k": 3, "M": 6, "G": 9}
_BASES = {*PREFIXED, "Ω"}
_UNPREFIXED = (
    "g t K degC mol cd T H S C Wb lm lx l L bar atm eV Ah Wh VA dB ppm rpm Bq Gy Sv"
    " cycle cycles revolutions turns strokes starts impacts counts"
).split()  # known, too, but shown without a prefix
_OTHER_NAMES = {"second": "s", "seconds": "s", "Ω": "ohm", "ohms": "ohm"}
_DECODED = {word: name for name, word in _TIMES.items()} | {
    "seconds": "s",
    "milliseconds": "ms",
    "microseconds": "us",
    "nanoseconds": "ns",
}
_OTHER_TIMES = {"y": "a", "yr": "a", "hr": "h"}
_WRITTEN_OUT = {
    **dict.fromkeys(("micron", "microns", "micrometer", "micrometre"), "um"),
    **dict.fromkeys(("millimeter", "millimetre"), "mm"),
    **dict.fromkeys(("meter", "metre"), "m"),
    **dict.fromkeys(("sec", "secs"), "s"),
    **{"newton": "N", "pascal": "Pa", "hertz": "Hz", "watt": "W", "radian": "rad"},
    **dict.fromkeys(("week", "weeks", "month", "months"), "days"),
}
_DEGREES = ("°", "deg", "degree", "degrees")

_NUMBER = r"[-+]?(?:[0-9]{1,40}\.?[0-9]{0,40}|\.[0-9]{1,40})(?:[eE][-+]?[0-9]{1,3})?"
_LONGEST = 41  # characters of a unit
_UNIT = rf"[A-Za-zµμΩ°%].{{0,{_LONGEST - 1}}}"
_QUANTITY = re.compile(rf"\s*((?>{_NUMBER}))\s*({_UNIT})")

EXAMPLE = '"24 hours", "250 um"'

SHAPE = rf"^\s*{_NUMBER}\s*{_UNIT}$"
"""Regular expression of a quantity, for editors."""

_PART = re.compile(r"\s*([/*·]?)\s*([A-Za-zµμΩ°%]+)(?:\^|\*\*)?([-⁻]?[\d⁰¹²³⁴-⁹]{1,2})?\s*")
_FRACTION = re.compile(r"(?:\^|\*\*|[^\W\d_])\(?[-+]?\d*(?:\.|\d/)\d")
WHOLE_POWERS = "powers are whole numbers, as in 'm s-2' or 'm/s^2'"
_PLAIN_DIGITS = str.maketrans("⁻⁰¹²³⁴⁵⁶⁷⁸⁹", "-0123456789")

Dimensions = dict[str, int]
"""Unit without prefix -> its power."""


class Written(float):
    """A number in a CF unit that was written with its unit.

    It behaves as a plain number.

    Attributes
    ----------
    number : str
        The number as written.
    unit : ReadableUnit
        The unit as written, in the spelling of tables.
    dimensions : dict of str to int
    """

    number: str
    unit: ReadableUnit
    dimensions: Dimensions


def read_quantity(text: str, units: str = "1") -> Written:
    """Return a quantity converted to a CF unit.

    Parameters
    ----------
    text : str
        Number and unit. Times may be in minutes, hours, days or years of 365.25 days, angles in
        degrees, pure numbers in per cent; other units may have a prefix, and quotients of units a
        slash.
    units : str
        A unit of the same dimensions (see `misfit`); by default the one without prefix.

    Returns
    -------
    Written
        Equal to the bit to the number written in the CF unit; for degrees x pi / 180.

    Raises
    ------
    ValueError
        The text is not a number with a unit.

    Examples
    --------
    >>> read_quantity("24 h"), read_quantity("250 um"), read_quantity("12 degrees").unit.name
    (86400.0, 0.00025, '°')
    >>> read_quantity("90 days", "h")
    2160.0
    """
    match = _QUANTITY.fullmatch(text)
    if match is None:
        raise ValueError(f"must be a number, or have its unit: {EXAMPLE}")
    size, turns, dimensions, name = _taken_apart(match[2].strip())
    per, other_turns, *_ = _taken_apart(units)
    size, turns = size / per, turns - other_turns
    try:
        value = Written(float(Fraction(match[1]) * size) * pi**turns / 180.0**turns)
        value.unit = ReadableUnit(name, float(size) * (pi / 180) ** turns)
    except OverflowError:
        raise ValueError("is too large a number") from None
    value.number = match[1]
    value.dimensions = dimensions
    return value


def misfit(text: str, name: str, units: str) -> str:
    """Return the reason why the unit of a quantity is incompatible; "" if it is compatible.

    Parameters
    ----------
    text : str
        Quantity, as for `read_quantity`.
    name : str
        Parameter, output or key to which the quantity belongs.
    units : str
        CF unit of this parameter, output or key.
    """
    written = read_quantity(text)
    if written.dimensions == _taken_apart(units)[2]:
        try:
            read_quantity(text, units)
        except ValueError as error:
            return str(error)
        return ""
    given = text.strip().removeprefix(written.number).strip()
    allowed = allowed_units(units)
    why = f"; {WHOLE_POWERS}" if _FRACTION.search(given) else ""
    meant = _meant(given, units) or nearest(given, allowed)
    return f"the unit '{given}' does not fit '{name}'{why}{meant} (allowed: {', '.join(allowed)})"


def _meant(given: str, units: str) -> str:
    """Return "; did you mean 'um'?" for a unit written out, such as ``microns``; or ""."""

    def symbol(match: re.Match[str]) -> str:
        close = get_close_matches(match[0].lower(), _WRITTEN_OUT, 1, 0.8)
        return _WRITTEN_OUT[close[0]] if close and unknown_factor(match[0]) else match[0]

    plain = re.sub(r"[().]", " ", given).strip() if not _FRACTION.search(given) else given
    text = re.sub(r"[^\W\d_]+", symbol, plain.replace("/ ", "/"))
    fits = text != given and _taken_apart(text)[2] == _taken_apart(units)[2]
    return f"; did you mean '{text}'?" if fits else ""


def fault_of_unit(unit: str) -> str:
    """Return the reason why a unit string is invalid; "" if it is valid."""
    if meant := _DECODED.get(unit.lower()):  # xarray would decode it as a time difference
        return f"write it as '{meant}'"
    place = 0
    while match := _PART.match(unit, place):
        place = match.end()
    if unit == "1" or (unit and place == len(unit)):
        return ""
    if _FRACTION.search(unit):
        return WHOLE_POWERS
    return "write its factors with their powers, such as 'N m-1', or '1' for a pure number"


def unknown_factor(unit: str) -> str:
    """Return the first factor of a unit that is none of the usual units; "" if all are."""
    if fault_of_unit(unit):
        return unit
    for _, symbol, _ in [] if unit == "1" else _PART.findall(unit):
        if _of_symbol(symbol)[0] in {*_BASES, "1"} or symbol in _UNPREFIXED:
            continue
        if symbol[0] not in _PREFIXES or symbol[1:] not in _UNPREFIXED:
            return str(symbol)
    return ""


def nearest_unit(symbol: str) -> str:
    """Return `nearest` of the usual units."""
    return nearest(symbol, [*_TIMES, *_BASES, *_UNPREFIXED, "deg"])


def converted(value: float, units: str) -> float:
    """Return a quantity in the unit of its output; a number without a unit is in that unit."""
    if isinstance(value, Written):
        with suppress(ValueError):  # too large: a study with it is refused
            return read_quantity(f"{value.number} {value.unit.name}", units)
    return value


def allowed_units(units: str) -> tuple[str, ...]:
    """Return the units in which a quantity with a CF unit may be written; prefixes as examples."""
    dimensions = _taken_apart(units)[2]
    if dimensions == {"s": 1}:
        return ("s", *_TIMES.values(), "ms")
    if dimensions == {"rad": 1}:
        return ("rad", "degrees")
    if not dimensions:
        return ("%",)
    first, *others = units.split(" ")
    base = _of_symbol(first)[0]
    prefixed = (" ".join([f"{prefix}{base}", *others]) for prefix in ("", "m", "u", "k"))
    return tuple(dict.fromkeys([units, *(prefixed if base in _BASES else ())]))


def _taken_apart(text: str) -> tuple[Fraction, int, Dimensions, str]:
    """Return size (without degrees), power of degrees, dimensions and name of a unit."""
    size, turns, dimensions, names = Fraction(1), 0, Dimensions(), list[str]()
    if text == "1":
        return size, turns, dimensions, text
    if len(text) > _LONGEST:  # a unit of its own, which no quantity can have
        return size, turns, {text: 1}, text
    place = 0
    while place < len(text):
        match = _PART.match(text, place)
        if match is None:  # unknown form: a unit of its own
            return Fraction(1), 0, {text: 1}, text
        place = match.end()
        power = int((match[3] or "1").translate(_PLAIN_DIGITS)) * (-1 if match[1] == "/" else 1)
        base, factor_size, name = _of_symbol(match[2])
        if name == DEGREES:
            turns += power
        size *= factor_size**power
        if base != "1":
            dimensions[base] = dimensions.get(base, 0) + power
        names.append(name if power == 1 else f"{name}{power}")
    whole = " ".join(names)
    return (
        size,
        turns,
        {unit: exponent for unit, exponent in dimensions.items() if exponent},
        _TIMES.get(whole, whole),
    )


def _of_symbol(symbol: str) -> tuple[str, Fraction, str]:
    """Return unit without prefix, size and name of one factor of a unit."""
    symbol = _OTHER_TIMES.get(symbol, symbol)
    for name, word in _TIMES.items():
        if symbol in (name, word, word.removesuffix("s")):
            return "s", Fraction(_SECONDS[name]), name
    if symbol in _DEGREES:
        return "rad", Fraction(1), DEGREES
    if symbol == "%":
        return "1", Fraction(1, 100), "%"
    symbol = _OTHER_NAMES.get(symbol, symbol)
    if symbol in PREFIXED or symbol[:1] not in _PREFIXES or symbol[1:] not in _BASES:
        return symbol, Fraction(1), symbol
    base = _OTHER_NAMES.get(symbol[1:], symbol[1:])
    prefix = "µ" if symbol[0] in "uμ" else symbol[0]
    return base, Fraction(10) ** _PREFIXES[symbol[0]], prefix + base


def read_threshold(option: str, text: str, name: str, units: str) -> float:
    """Return the number in a command-line option, with or without a unit.

    Parameters
    ----------
    option : str
        Name of the option, such as ``--by``.
    text : str
    name : str
        Name of the quantity for messages.
    units : str
        CF unit of the quantity, and of a plain number.

    Raises
    ------
    InputError
        The text is not a number, or its unit is incompatible.
    """
    try:
        return float(text)
    except ValueError:
        pass
    try:
        quantity, problem = read_quantity(text, units), misfit(text, name, units)
    except ValueError as error:
        quantity, problem = Written(), str(error)
    if problem:
        raise InputError(f"{option} {text}: {problem}")
    return quantity
