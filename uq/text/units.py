"""Readable units of quantities, and symbols of formulas, as text."""

import re
from collections.abc import Iterable
from math import floor, inf, isfinite, log10, pi
from typing import NamedTuple
from unicodedata import lookup

import numpy as np

PREFIXED = {"m", "s", "N", "W", "J", "A", "V", "F", "ohm", "Pa", "rad", "Hz"}
_PREFIXES = {-12: "p", -9: "n", -6: "µ", -3: "m", 3: "k", 6: "M", 9: "G"}
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
_SMALLEST, _LARGEST = 0.1, 1e4  # range of numbers that need no prefix
_SMALLEST_IN_DEGREES = 1e-3  # rad

DEGREES = "°"
_TIME_WORDS = ("minutes", "hours", "days", "years")


class ReadableUnit(NamedTuple):
    """A readable unit: its name, as in CF except for prefixes, and its size in the CF unit."""

    name: str
    size: float


PURE = ReadableUnit("1", 1.0)
"""The unit of a pure number."""


def beside(number: str, unit: str) -> str:
    """Return a number followed by its unit, if any: ``250 µm``, ``12°``, ``3 × 10⁻¹⁵ m² N⁻¹``."""
    if number == "1" and unit in _TIME_WORDS:
        unit = unit.removesuffix("s")
    if unit in ("", "1"):
        return number
    between = "" if unit == DEGREES else " × " if unit.startswith("10") else " "
    return f"{number}{between}{powers(unit)}"


_DAY = 86400.0
_YEAR = 365.25 * _DAY
_TIME_UNITS = {
    0.0: ReadableUnit("seconds", 1.0),
    3600.0: ReadableUnit("hours", 3600.0),
    2 * _DAY: ReadableUnit("days", _DAY),
    2 * _YEAR: ReadableUnit("years", _YEAR),
}
"""Units of time, by the smallest time [s] for which each is used."""


def time_unit(seconds: float) -> ReadableUnit:
    """Return the usual unit of a non-negative time [s]."""
    return [unit for shortest, unit in _TIME_UNITS.items() if seconds >= shortest][-1]


def unit_of(units: str, typical: float) -> ReadableUnit:
    """Return the readable unit of a quantity.

    Parameters
    ----------
    units : str
        CF unit string: ``m``, ``N m-1``.
    typical : float
        A typical value, in `units`; NaN or 0 if unknown. Use the median for numbers in a table, and
        the largest magnitude for an axis.

    Returns
    -------
    ReadableUnit
        µm for 0.00025 m; degrees for radians; hours, days or years for long times; ``10⁻¹⁵ m2
        N-1`` for a unit that takes no prefix; the unit itself for a pure number.
    """
    size = abs(typical) if isfinite(typical) else 0.0
    if units == "s" and size < inf and time_unit(size).name != "seconds":
        return time_unit(size)
    if units == "rad" and (size >= _SMALLEST_IN_DEGREES or size == 0):
        return ReadableUnit(DEGREES, pi / 180)
    if units == "1" or size == 0 or _SMALLEST <= size < _LARGEST:
        return ReadableUnit(units, 1.0)
    power = max(3 * floor(log10(size) / 3), -300)
    name = f"10{str(power).translate(_RAISED)} {units}"
    if units.split(" ")[0] in PREFIXED and power in _PREFIXES:
        name = _PREFIXES[power] + units
    return ReadableUnit(name, float(f"1e{power}"))


def typical(values: Iterable[float]) -> float:
    """Return the median magnitude of the finite nonzero values; 0 if there is none."""
    sizes = np.abs(values if isinstance(values, np.ndarray) else np.fromiter(values, float))
    positive = sizes[np.isfinite(sizes) & (sizes > 0)]
    return (
        float(np.partition(positive, len(positive) // 2)[len(positive) // 2])
        if len(positive)
        else 0.0
    )


def powers(unit: str) -> str:
    """Return a CF unit as printed: ``m2 N-1`` becomes ``m² N⁻¹``, and ``ohm`` an omega."""
    unit = re.sub(r"(?<=[A-Za-z])-?\d+", lambda match: match[0].translate(_RAISED), unit)
    return re.sub(r"\bohm\b", "Ω", unit)


LETTERS = (
    "alpha beta gamma delta epsilon zeta eta theta kappa lambda mu nu xi pi rho sigma tau phi chi "
    "psi omega Gamma Delta Theta Lambda Xi Pi Sigma Phi Psi Omega"
).split()

_LETTER = rf"(?:{'|'.join(LETTERS)})"
WORD = re.compile(rf"(?<![A-Za-z]){_LETTER}(?![A-Za-z])")
"""Regular expression of the name of a Greek letter."""

IN_TEXT = re.compile(
    rf"(?<![\w-])(?:{_LETTER}(?:_[A-Za-z0-9]+|\d+)?|[A-Za-z]_[A-Za-z0-9]+)(?!\w)(?:\(0\))?"
)
"""Regular expression of a symbol in a text."""

_LOWERED = str.maketrans("0123456789", "₀₁₂₃₄₅₆₇₈₉")


def symbol(text: str) -> str:
    """Return a symbol with Greek letters and digits as subscripts: ``Omega/(2 pi)`` as Ω/(2 π)."""
    text = WORD.sub(lambda match: _letter(match[0]), text)
    return re.sub(r"(?<!\w)([^\W\d_])_?(\d+)\b", _lowered, text)


def readable(text: str) -> str:
    """Return text with its symbols as in `symbol`, and with minus signs."""
    text = IN_TEXT.sub(lambda match: symbol(match[0]), text)
    return text.replace(" - ", " \N{MINUS SIGN} ")


def _letter(name: str) -> str:
    case = "CAPITAL" if name[0].isupper() else "SMALL"
    return lookup(f"GREEK {case} LETTER {name.upper().replace('LAMBDA', 'LAMDA')}")


def _lowered(match: re.Match[str]) -> str:
    return match[1] + match[2].translate(_LOWERED)
