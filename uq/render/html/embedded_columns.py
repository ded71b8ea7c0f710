"""Columns of numbers inside a page: their names, axes and bytes."""

import base64
import re
from collections.abc import Sequence
from math import floor, isfinite, log10
from typing import Any

import numpy as np
from markupsafe import Markup
from matplotlib.ticker import LogLocator, MaxNLocator
from numpy.typing import NDArray

from uq.assess.answer.wording import called
from uq.contract import Floats
from uq.render.figures.elements_plot import display_unit
from uq.render.figures.panel import is_wide
from uq.render.figures.words import element_in_words, meaning_of, symbol_beside, unbroken
from uq.result.element import Element
from uq.result.result import Result
from uq.study.file import AnalysisTable
from uq.text.literals import plain
from uq.text.numbers import printed
from uq.text.units import ReadableUnit, readable

_MOST_TICKS = 7
_MOST_DIGITS = 13
_SHORT = 8.0  # a logarithmic axis spanning a smaller factor has evenly spaced ticks


def axis_of(values: Floats, per: float) -> dict[str, Any]:
    """Return the ends of an axis, whether it is logarithmic, and its ticks.

    Parameters
    ----------
    values : ndarray
        Values, possibly infinite.
    per : float
        Size of the displayed unit, in which ticks are round.
    """
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
    if low == high:
        low, high = low - abs(low or 1.0) / 2, high + abs(high or 1.0) / 2
    wide = bool(is_wide(finite)) and low > 0
    return {"low": low, "high": high, "wide": wide, "ticks": _ticks(low, high, per, wide)}


def common_digits(axis: dict[str, Any]) -> int:
    """Return the number of leading digits common to the values of an axis."""
    low, high = axis["low"], axis["high"]
    alike = floor(log10(max(-low, high)) - log10(high - low)) if isfinite(high - low) else 0
    return min(max(alike, 0), _MOST_DIGITS)


def _ticks(low: float, high: float, per: float, wide: bool) -> list[float]:
    """Return round numbers between two ends in the displayed unit; without any, the ends."""
    first, last = low / per, high / per
    if not (isfinite(last - first) and last - first > np.finfo(float).tiny):
        return [low, high]
    if wide and last / first > _SHORT:
        decades = log10(last) - log10(first)
        steps = (1.0, 2.0, 5.0) if decades <= 2 else (1.0, 3.0) if decades <= 4 else (1.0,)
        places = LogLocator(subs=steps, numticks=_MOST_TICKS).tick_values(first, last)
    else:
        places = MaxNLocator(_MOST_TICKS, steps=[1, 2, 5, 10]).tick_values(first, last)
    inside = [float(place * per) for place in places if first <= place <= last]
    return inside if len(inside) > 1 else [low, high]


IMPOSSIBLE = 255
"""Byte of a row with zero weight."""

_STEPS = 254
_ALIKE = 1e-9  # differences of logarithms due to rounding
_DEEPEST = 16.0
"""Largest fall of a logarithm that is kept: less than a ten millionth of the largest weight is
negligible."""


def encoded(values: Any, kind: str) -> str:
    """Return an array as base64 of its bytes.

    Parameters
    ----------
    values : array-like
    kind : str
        NumPy dtype, such as ``"<f8"``.

    Returns
    -------
    str
    """
    return base64.b64encode(np.ascontiguousarray(values, dtype=kind).tobytes()).decode()


def log_bytes(weights: Floats) -> dict[str, Any]:
    """Return the logarithms of weights as one byte each.

    Parameters
    ----------
    weights : ndarray, shape (n,)
        Weights, at least one of them positive.

    Returns
    -------
    dict
        The logarithm is ``top - step * byte``, or -inf where the byte is `IMPOSSIBLE`.
    """
    possible = weights > 0
    logs = np.log(weights, where=possible, out=np.full(len(weights), -np.inf))
    top = float(logs.max())
    depth = np.minimum(top - logs, _DEEPEST)
    step = max(float(depth[possible].max()) / _STEPS, _ALIKE)
    codes = np.where(possible, np.round(depth / step), IMPOSSIBLE)
    return {"top": top, "step": step, "bytes": encoded(codes, "u1")}


def parts_of(symbol: str) -> list[str]:
    """Split a symbol before and after its index: ``k_c(0)`` becomes ``k``, ``c``, ``(0)``.

    A symbol with several consecutive indices is a name, and not split.
    """
    if re.search(r"_[A-Za-z0-9]*_", symbol):
        return [plain(symbol)]
    return re.split(r"_([A-Za-z0-9]+)", plain(symbol))


def indexed(symbol: str) -> Markup:
    """Return a symbol with its index as an HTML subscript: ``k_c`` as ``k<sub>c</sub>``."""
    parts = (
        Markup("<sub>{}</sub>" if i % 2 else "{}").format(part)
        for i, part in enumerate(parts_of(symbol))
    )
    return Markup("").join(parts)


_ENDED, _CENSORED, _NEVER, _UNDEFINED, _FAILED = range(5)
"""Status codes of rows, as in the scripts."""


def input_column(rows: Result, name: str, unit: ReadableUnit) -> dict[str, Any]:
    """Return the column of an input, with the quartiles of its values."""
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
    """Return the label of the curve drawn for an output."""
    if element.declared.success:
        return "Share that has not yet succeeded"
    return "Share that survives each time" if element.is_lifetime else "Share above each value"


def _states(element: Element) -> NDArray[np.int_]:
    """Return the status of each row, as coded in the scripts."""
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
    """Return a column of numbers with its name, unit, format and axis."""
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
    """Return a unit as written after a number."""
    if unit in ("", "\N{DEGREE SIGN}"):
        return unit
    space = "\N{NO-BREAK SPACE}"
    return f"{space}\N{MULTIPLICATION SIGN}{space}{unit}" if unit.startswith("10") else f" {unit}"
