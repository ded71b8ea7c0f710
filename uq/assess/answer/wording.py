"""Inputs and outputs in words, with the quality of their sources and the units of their numbers."""

import re
from collections.abc import Collection, Sequence, Sized
from math import ceil, floor, isfinite, log10
from typing import NamedTuple

import numpy as np

from uq.assess.fact import Fact
from uq.assess.targets import split_name
from uq.result.element import Element
from uq.result.result import Result
from uq.sampling.listed_values import Empirical
from uq.stats.estimate import Estimate
from uq.study.file import Tied, source_of_fixed
from uq.study.input_checks import laws_of
from uq.text.numbers import (
    capitalized,
    compared,
    counted,
    digits,
    estimated,
    percent,
    percent_interval,
)
from uq.text.units import beside, powers, readable, unit_of

ASSUMED = "assumed"
CHOSEN = "chosen"
"""Label of a range of designs: there is nothing to measure and no tolerance."""

_WORDS = f"(given|measured|inferred|fitted|{ASSUMED}|{CHOSEN})"
_MARK = re.compile(rf"(?:^|[:;,] ){_WORDS}\b|(?<!\bnot )\b{_WORDS}$")


def mark(source: str) -> str:
    """Return the quality of a number according to its source, or "".

    Parameters
    ----------
    source : str
        Such as ``"Knudsen & Massih 2002, Table 1: given, its exponent inferred"``.

    Returns
    -------
    str
        ``given``, ``measured``, ``inferred``, ``fitted``, ``assumed`` or ``chosen``: the first that
        begins the sentence or one of its parts, or ends it.
    """
    match = _MARK.search(source)
    return (match[1] or match[2]) if match else ""


def source_of(result: Result, name: str) -> str:
    """Return the source of a law or fixed value, or that of the nominal value if a law has none."""
    source = str(result.dataset[name].attrs.get("source", ""))
    return source if _states_source(result, name) else f"none; its nominal value: {source}"


def mark_of(result: Result, name: str) -> str:
    """Return the quality of a parameter of a result; "" also without a source.

    The scatter of a law without a source is at best as well known as an assumed nominal value.
    """
    quality = mark(source_of(result, name))
    return quality if _states_source(result, name) or quality == ASSUMED else ""


def _states_source(result: Result, name: str) -> bool:
    """Return whether a parameter has a source: a value in [fixed] replaces the sourced one."""
    study = result.study
    return (
        bool(study.uncertain[name].source)
        if name in study.uncertain
        else name not in study.fixed or bool(source_of_fixed(study.fixed[name]))
    )


FEW_VALUES = 100
"""An empirical law of fewer values is itself an estimate, which no interval allows for."""


def tied_to(result: Result, inputs: Collection[str]) -> dict[str, str]:
    """Return the inputs that equal one of some others in every row: name -> the other."""
    return {
        name: law.equals
        for name, law in result.study.uncertain.items()
        if isinstance(law, Tied) and law.equals in inputs
    }


def few_values(result: Result) -> dict[str, int]:
    """Return the empirical laws of few values: parameter -> number of values."""
    counts = {
        name: len(law.values or ())
        for name, law in laws_of(str(result.dataset.attrs["study"])).items()
        if isinstance(law, Empirical) and name in result.dataset.variables
    }
    return {name: count for name, count in counts.items() if count < FEW_VALUES}


def without_source(result: Result) -> list[str]:
    """Return the parameters whose values in [fixed] replace the nominal ones, without a source.

    A value equal to the nominal one has the source of that.
    """
    ds = result.dataset
    return [
        name
        for name, value in result.study.fixed.items()
        if name in ds.variables
        and not source_of_fixed(value)
        and not np.array_equal(ds[name].attrs.get("nominal", ()), ds[name].values)
    ]


class DisplayUnit(NamedTuple):
    """A unit in which numbers are shown.

    Attributes
    ----------
    name : str
        "" for a pure number.
    per : float
        Divisor of the numbers.
    resolution : float
        The smallest difference that digits must show, before the division; 0 for three digits.
    """

    name: str = ""
    per: float = 1.0
    resolution: float = 0.0

    def number(self, value: float, towards: float = 0.0) -> str:
        """Return a number in this unit to its digits; `towards` -inf or inf rounds that way."""
        return rounded(value / self.per, towards, self.resolution / self.per)

    def text(self, value: float, towards: float = 0.0) -> str:
        """Return a number with its unit."""
        if not isfinite(value):
            return "never" if value > 0 else "-"
        return beside(self.number(value, towards), self.name)

    def between(self, low: float, high: float, joined: str = " to ") -> str:
        """Return two numbers with their unit once."""
        if not (isfinite(low) and isfinite(high)):
            return f"{self.text(low)}{joined}{self.text(high)}"
        return beside(f"{self.number(low)}{joined}{self.number(high)}", self.name)

    def bare_between(self, low: float, high: float) -> str:
        """Return the ends of an interval beside a number that has the unit."""
        return f"{self.number(low)} to {self.number(high)}"


def rounded(value: float, towards: float = 0.0, resolution: float = 0.0) -> str:
    """Return a number to three digits, or its resolution; `towards` -inf or inf rounds that way."""
    if not 1e-300 < abs(value) < 1e300:  # a digit of others may be 0 or infinite
        return f"{value or 0.0:.3g}"  # no minus before a zero
    count = digits(value, resolution, 3)
    digit = 10.0 ** (floor(log10(abs(value))) - count + 1)
    places = value / digit
    if towards and abs(places - round(places)) > 1e-9:
        places = ceil(places) if towards > 0 else floor(places)
    shown = f"{places * digit:.{count}g}"
    return f"{float(shown):.0f}" if 1e3 <= abs(float(shown)) < 1e4 else shown


def unit_for(units: str, typical: float) -> DisplayUnit:
    """Return the unit for numbers of a typical size.

    Parameters
    ----------
    units : str
        CF unit string.
    typical : float
        NaN if unknown.
    """
    return _printed(*unit_of(units, typical))


def unit_of_input(result: Result, name: str) -> DisplayUnit:
    """Return the unit for numbers of an input of a result."""
    return _printed(*result.input_unit(name))


def _printed(name: str, size: float) -> DisplayUnit:
    return DisplayUnit() if name == "1" else DisplayUnit(powers(name), size)


def called(name: str) -> str:
    """Return an input or output in words: ``contact stiffness``."""
    return name.replace("_", " ")


def called_together(names: Sequence[str]) -> str:
    """Return several inputs in words: ``both bearing constants``, ``mole and bar friction``.

    Parameters
    ----------
    names : sequence of str
    """
    groups: dict[str, list[str]] = {}
    for name in names:
        groups.setdefault(twin_of(name), []).append(name)
    words = [_twins_called(stem, twins) for stem, twins in groups.items()]
    if len(names) == len(words) == 2:
        first, second = (called(name).split() for name in names)
        while min(len(first), len(second)) > 1 and first[-1] == second[-1] and first[-1].isalpha():
            first, words[0] = first[:-1], " ".join(first[:-1])
            second = second[:-1]
    return joined(words)


def scale_warning(assumed: Sequence[str]) -> str:
    """Return the clause on assumed inputs that set the scale of a life; "" without any."""
    if not assumed:
        return ""
    how = "sets the scale and is assumed" if len(assumed) == 1 else "set the scale and are assumed"
    return f"not a prediction: {called_together(assumed)} {how}"


def cause_warning(assumed: Sequence[str]) -> str:
    """Return the clause on assumed inputs that contribute most to the scatter; "" without any."""
    if not assumed:
        return ""
    how = "contributes most and is" if len(assumed) == 1 else "contribute most and are"
    return f"not a prediction: {called_together(assumed)} {how} assumed"


def joined(words: Sequence[str], last: str = "and") -> str:
    """Return words as a list: ``a, b and c``; "" without any."""
    return f" {last} ".join(filter(None, [", ".join(words[:-1]), *words[-1:]]))


def _twins_called(stem: str, names: Sequence[str]) -> str:
    if len(names) == 1:
        return called(names[0])
    count = "both" if len(names) == 2 else f"all {len(names)}"
    return f"{count} {_plural(called(stem))}"


_TWIN = re.compile(r"(.+)_(\d+)")


def twin_of(name: str) -> str:
    """Return the name of an input without its number: ``unbalance`` of ``unbalance_2``."""
    match = _TWIN.fullmatch(name)
    return match[1] if match else name


def _plural(words: str) -> str:
    if words.endswith("y") and words[-2:-1] not in "aeiou":
        return f"{words[:-1]}ies"
    return words + ("es" if words.endswith(("s", "x")) else "s")


def element_called(result: Result, element: Element) -> str:
    """Return an element in words: ``time to wear depth, left, 250 µm``."""
    words = [readable(element.meaning)]
    for dim, value in element.place.items():
        attrs = (
            result.dataset[element.output][dim].attrs
            if dim in result.dataset[element.output].coords
            else {}
        )
        if isinstance(value, str):
            words.append(value)
        elif attrs.get("units") in ("m", "s", "Hz"):
            words.append(unit_for(attrs["units"], float(value)).text(float(value)))
        else:
            words.append(f"{dim} {value:g}")
    return ", ".join(words)


def sentence(text: str) -> str:
    """Return text as a sentence."""
    return f"{capitalized(text)}."


def share_text(share: Estimate) -> str:
    """Return a share in per cent, with its interval."""
    interval = f" ({percent_interval(share.low, share.high)})" if share.has_interval else ""
    return percent(share.value) + interval


class NumberTarget:
    """An element of an output, or a quantity derived from it.

    Parameters
    ----------
    result : Result
    name : str
        As `uq.sensitivity` returns it.

    Attributes
    ----------
    name : str
        Its readable name, also accepted by ``--output``: ``P(life < 24 hours)``.
    units : str
        CF unit of the numbers; ``"1"`` for those of a logarithm, a rank or an event.
    meaning : str
        Of the element, with its place.
    """

    def __init__(self, result: Result, name: str):
        form, inside, _ = split_name(name)
        output = inside.partition("=" if "[" not in inside else "[")[0]
        self.name, self.units, self.meaning = name, "1", ""
        self._compared, self._asked = "", result.analysis.thresholds.get(output, ())
        if result.is_category(output):
            self.meaning = str(result.dataset[output].attrs["long_name"])
        elif output in (outputs := result.outputs):
            element, *others = result.named_elements(inside)
            declared = outputs[output]
            self._units = declared.unit
            self._compared = compared(inside, declared.is_angle)
            self.meaning = element_called(result, element)
            if others:
                self.meaning = f"{readable(element.meaning)}, all {1 + len(others)} elements"
            self.units = "1" if form else declared.unit
            self.name = self.label(name)

    def label(self, label: str) -> str:
        """Return the name of one of its estimates for a person."""
        return estimated(label, self._units, self._compared, self._asked)


def assumptions(result: Result) -> dict[str, Fact]:
    """Return the assumed laws and fixed values, and the laws that do not say how they are known.

    Parameters
    ----------
    result : Result
        A result.

    Returns
    -------
    dict of str to Fact
        ``assumed_laws``, ``assumed_values``, ``laws_without_source``, ``laws_without_quality``,
        ``values_without_source`` and ``laws_of_few_values``, as far as there are any: the
        ``inputs``, and the number that they are ``of``.
    """
    study = result.study.uncertain
    tied = [name for name, law in study.items() if isinstance(law, Tied)]
    laws = {name: how for name, how in _marks(result, "input").items() if name not in tied}
    fixed = _marks(result, "fixed")
    assumed = [name for name, how in laws.items() if how == ASSUMED]
    unstated = [
        name
        for name, how in laws.items()
        if not how and "initial" not in result.dataset[name].attrs
    ]
    values = [name for name, how in fixed.items() if how == ASSUMED]
    empirical, given = few_values(result), without_source(result)
    groups = {
        "assumed_laws": (f"{_counted_with_verb(assumed, laws, 'law')} assumed", assumed, laws),
        "assumed_values": (
            f"{_counted_with_verb(values, fixed, 'fixed value')} assumed",
            values,
            fixed,
        ),
        "laws_without_source": (
            "Laws without a source",
            [name for name in unstated if not _states_source(result, name)],
            laws,
        ),
        "laws_without_quality": (
            "Laws whose source does not say given, measured, inferred, fitted, assumed or chosen",
            [name for name in unstated if _states_source(result, name)],
            laws,
        ),
        "values_without_source": ("Fixed values without a source", given, fixed),
        "laws_of_few_values": (
            f"Laws taken from fewer than {FEW_VALUES} values as if these were all",
            [*empirical],
            laws,
        ),
    }
    return {
        key: Fact(
            {"inputs": names, "of": len(total)},
            words=f"{clause}: {joined(_first_named(names))}.",
        )
        for key, (clause, names, total) in groups.items()
        if names
    }


def _counted_with_verb(names: Sized, total: Sized, noun: str) -> str:
    verb = "is" if len(names) == 1 else "are"
    return f"{len(names)} of {counted(len(total), noun)} {verb}"


_MOST_NAMED = 12
"""Number of inputs that a sentence names; of more, it names the first half of these."""


def _first_named(names: Sequence[str]) -> list[str]:
    if len(names) <= _MOST_NAMED:
        return [called(name) for name in names]
    first = [called(name) for name in names[: _MOST_NAMED // 2]]
    return [*first, f"{len(names) - len(first)} others"]


def _marks(result: Result, role: str) -> dict[str, str]:
    """Return the quality of the source of each parameter with a role."""
    return {
        str(name): mark_of(result, str(name))
        for name, variable in result.dataset.variables.items()
        if variable.attrs.get("role") == role
    }
