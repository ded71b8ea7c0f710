"""The columns of numbers inside a page: how they are called, written and drawn."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uq.assess.answer.wording import called
from uq.contract import Floats
from uq.render.figures.elements_plot import display_unit
from uq.render.figures.words import element_in_words, meaning_of, symbol_beside, unbroken
from uq.render.html.axes import axis_of, common_digits
from uq.render.html.encoded import encoded
from uq.render.html.symbols import parts_of
from uq.result.element import Element
from uq.result.result import Result
from uq.study.file import AnalysisTable
from uq.text.literals import plain
from uq.text.numbers import printed
from uq.text.symbols import readable
from uq.text.units import ReadableUnit

_ENDED, _CENSORED, _NEVER, _UNDEFINED, _FAILED = range(5)
"""How a row ended, as the scripts number it."""


def input_column(rows: Result, name: str, unit: ReadableUnit) -> dict[str, Any]:
    """Return the column of an input, with the quarters of its values."""
    variable = rows.dataset[name]
    values = variable.values
    symbol = parts_of(symbol_beside(called(name), variable))
    column = _column(name, called(name), unit, values, np.zeros(len(values)), symbol)
    return column | {
        "role": "input",
        "meaning": plain(readable(meaning_of(variable))),
        "curve": "Share above each value",
        "lines": [],
        "quarters": np.quantile(values, (0.25, 0.5, 0.75)).tolist(),
    }


def output_column(rows: Result, element: Element, analysis: AnalysisTable) -> dict[str, Any]:
    """Return the column of an element of an output, with the thresholds to draw."""
    unit = display_unit(element.units, element.values)
    label = element_in_words(rows, element)
    column = _column(element.name, label, unit, element.values, _states(element), [""])
    asked = analysis.thresholds.get(element.output, ())
    lines = [
        side * float(value) for value in asked for side in ((-1, 1) if element.is_angle else (1,))
    ]
    axis = column["axis"]
    return column | {
        "role": "output",
        "meaning": "",
        "curve": _curve(element),
        "lines": [line for line in lines if axis["low"] <= line <= axis["high"]],
    }


def _curve(element: Element) -> str:
    """Return what the curve of an output shows."""
    if element.declared.success:
        return "Share that has not yet succeeded"
    return "Share that outlives each time" if element.is_lifetime else "Share above each value"


def _states(element: Element) -> NDArray[np.int_]:
    """Return how each row ended, as the scripts number it."""
    states = np.where(np.isposinf(element.values), _NEVER, _ENDED)
    states[element.censored] = _CENSORED
    states[np.isnan(element.values)] = _UNDEFINED
    states[element.failed] = _FAILED
    return states


def _column(
    name: str,
    words: str,
    unit: ReadableUnit,
    values: Floats,
    states: NDArray[Any],
    symbol: Sequence[str],
) -> dict[str, Any]:
    """Return a column of numbers: how it is called, written and drawn."""
    label = plain(printed(readable(words)))
    shown = "" if unit.name == "1" else plain(unbroken(unit.name))
    title = f"{label} ({symbol[0]})" if symbol[0] and len(symbol) == 1 else label
    axis = axis_of(values[states <= _CENSORED], unit.size)
    return {
        "name": name,
        "label": label,
        "symbol": symbol,
        "title": f"{title} [{shown}]" if shown else title,
        "after": _after(shown),
        "per": unit.size,
        "common": common_digits(axis),
        "axis": axis,
        "values": encoded(values, "<f8"),
        "states": encoded(states, "u1") if states.any() else None,
    }


def _after(unit: str) -> str:
    """Return a unit as it follows a number."""
    if unit in ("", "\N{DEGREE SIGN}"):
        return unit
    space = "\N{NO-BREAK SPACE}"
    return f"{space}\N{MULTIPLICATION SIGN}{space}{unit}" if unit.startswith("10") else f" {unit}"
