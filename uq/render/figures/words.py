"""Words, units and symbols in figures and reports, and on the axes of quantities of a Dataset."""

import re
import textwrap
from collections.abc import Iterator, Mapping, Sequence
from functools import partial
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from uq.errors import InputError, nearest
from uq.render.figures.figure import COLOURS
from uq.result.elements import Element, Floats
from uq.result.result import Result
from uq.text.literals import plain
from uq.text.numbers import capitalized, grouped, minus, quantity
from uq.text.units import IN_TEXT, LETTERS, WORD, ReadableUnit, unit_of
from uq.text.units import powers as powers
from uq.text.units import symbol as as_text

_WHOLE = re.compile(r"(?:[A-Za-z]+(?:_[A-Za-z0-9]+)?(?![A-Za-z_])|[\d ()+*/'.-])+")

_SHORT = re.compile(rf"(?:[A-Za-z]|{'|'.join(LETTERS)})(?:\d+|_[A-Za-z0-9]+)?")


def literal(text: str) -> str:
    """Return text with escaped dollar signs, which begin no formula."""
    return text.replace("$", r"\$")


def formula(symbol: str) -> str:
    r"""Return a symbol as a formula: ``k_tra`` becomes ``$k_{\mathrm{tra}}$``.

    Parameters
    ----------
    symbol : str
        ASCII letters, digits and signs, each letter with at most one index; any other symbol is
        returned as text.

    Returns
    -------
    str
    """
    if not _WHOLE.fullmatch(symbol):
        return literal(symbol)
    text = symbol if "_" in symbol else re.sub(r"(?<=[A-Za-z])(\d+)\b", r"_\1", symbol)
    text = re.sub(r"_([A-Za-z0-9]+)", _subscript, text.replace(" ", r"\,"))
    return f"${WORD.sub(lambda match: chr(92) + match[0], text)}$"


def is_short(symbol: str) -> bool:
    """Return whether a symbol is one letter with at most one index: ``x1``, ``omega``, ``k_c``."""
    return _SHORT.fullmatch(symbol) is not None


def _subscript(match: re.Match[str]) -> str:
    upright = match[1].isalpha() and not WORD.fullmatch(match[1])
    return rf"_{{\mathrm{{{match[1]}}}}}" if upright else f"_{{{match[1]}}}"


def typeset(text: str) -> str:
    """Return text with symbols as formulas and typographic roots and minus signs."""
    text = IN_TEXT.sub(lambda match: formula(match[0]), literal(minus(text)))
    return text.replace("sqrt(", "√(").replace(" - ", " \N{MINUS SIGN} ")


def as_label(text: str, unit: str = "", width: int = 44, symbol: str = "") -> str:
    """Return a label for an axis or a panel: capitalised and wrapped, with symbols and unit.

    If text and symbol are equal, it is written once, as a formula unless it is a word: ``x1``,
    ``load``.
    """
    once = text == symbol
    text = formula(text) if once and is_short(text) else typeset(plain(capitalized(text)))
    if symbol and not once:
        text += f" ({formula(plain(symbol))})"
    if unit and unit != "1":
        text += f"\u00a0[{unbroken(unit)}]"  # not alone on a line
    return _wrapped(text, width).replace("\u00a0", " ")


def _wrapped(text: str, width: int) -> str:
    """Wrap text by its visible width: a formula is narrower than its source and never broken."""
    text = re.sub(r" ([+−=]) ", "\u00a0\\1\u00a0", text)  # a difference is one word
    text = re.sub(r"(?<=[a-z]) (?=\d+\b)", "\u00a0", text)  # as is "motor 1"
    formulas = re.findall(_FORMULA, text)
    letters = (re.sub(r"\\mathrm|\\\W|[${}_]", "", source) for source in formulas)
    seen = (re.sub(r"\\[A-Za-z]+", "x", word) for word in letters)
    masked = re.sub(_FORMULA, lambda _: _MASK * len(next(seen)), text)
    whole = iter(formulas)
    return re.sub(f"{_MASK}+", lambda _: next(whole), "\n".join(_lines(masked, width)))


def _lines(text: str, width: int) -> list[str]:
    """Return lines of about equal length, as few as the width allows.

    Only a word longer than a line, such as a name, is broken, preferably at a hyphen.
    """
    longest = max(map(len, text.split(" ")))
    if longest > width:
        return textwrap.wrap(text, width)
    wrap = partial(textwrap.wrap, text, break_on_hyphens=False)
    lines = wrap(width=width)
    while width > max(longest, 1) and len(shorter := wrap(width=width - 1)) == len(lines):
        lines, width = shorter, width - 1
    return lines


_FORMULA = r"(?<!\\)\$.+?(?<!\\)\$"
_MASK = "\ue000"


def unbroken(unit: str) -> str:
    """Return a unit as in `powers`, with spaces at which no line breaks."""
    return powers(unit).replace(" ", "\u00a0")


def place_in_words(result: Result, element: Element) -> str:
    """Return the coordinates of an element within its output: ``left, 250 µm``."""
    words, variable = [], result.dataset[element.output]
    for dim, value in element.place.items():
        attrs: Mapping[str, Any] = variable[dim].attrs if dim in variable.coords else {}
        if isinstance(value, str):
            words.append(value)
        elif attrs.get("units", "1") != "1":
            words.append(powers(quantity(value, attrs["units"])))
        else:
            words.append(f"{dim.replace('_', ' ')} {value:g}")
    return ", ".join(words)


def label(result: Result, element: Element) -> str:
    """Return the coordinates of an element, by which its curve is labelled."""
    return literal(minus(place_in_words(result, element)))


def row_counts(result: Result, chosen: Sequence[Element]) -> str:
    """Return the number of rows, and the numbers of failed rows and of rows without a value."""
    counts = [result.counted_rows(len(chosen[0].values))]
    for state, word in (("failed", "invalid"), ("undefined",) * 2, ("censored",) * 2):
        most = max(int(getattr(element, state).sum()) for element in chosen)
        if most:
            counts.append(f"{'up to ' if len(chosen) > 1 else ''}{grouped(most)} {word}")
    if chosen[0].weights is not None:
        counts.append("weighted" if result.has_next_rows else "weighted by inspections")
    return ", ".join(counts)


def element_in_words(result: Result, element: Element) -> str:
    """Return the meaning and coordinates of an element: ``time to wear depth, left, 250 µm``."""
    return ", ".join(filter(None, (element.meaning, place_in_words(result, element))))


def in_words(variable: xr.DataArray) -> str:
    """Return the meaning of a variable, with its symbol (never broken), if any."""
    return with_symbol(meaning_of(variable), variable)


def with_symbol(words: str, variable: xr.DataArray) -> str:
    """Return words for a variable with its symbol, unless the words equal the symbol."""
    symbol = symbol_beside(words, variable)
    return f"{words} ({symbol})" if symbol else words


def symbol_beside(words: str, variable: xr.DataArray) -> str:
    """Return the symbol of a variable as text (never broken), "" if it equals the words."""
    symbol = as_text(symbol_of(variable)).replace(" ", "\u00a0")
    return "" if symbol == as_text(words) else symbol


def meaning_of(variable: xr.DataArray) -> str:
    """Return the meaning of a variable."""
    return str(variable.attrs.get("long_name", str(variable.name).replace("_", " ")))


def symbol_of(variable: xr.DataArray) -> str:
    """Return the symbol of a variable, or "" if it is only the meaning in one word."""
    symbol = str(variable.attrs.get("symbol", ""))
    is_name = "_" in symbol and symbol.replace("_", " ") == meaning_of(variable)
    return "" if is_name else symbol


def labelled(variable: xr.DataArray, unit: str = "", width: int = 44) -> str:
    """Return the label of a variable, with its symbol as a formula."""
    return as_label(meaning_of(variable), unit, width, symbol_of(variable))


def input_label(variable: xr.DataArray, unit: str = "", width: int = 44) -> str:
    """Return the label of an input by the name that answers use, with its symbol.

    A name that is only a symbol, such as ``x1``, is replaced by its meaning.
    """
    name, symbol = str(variable.name), symbol_of(variable)
    if is_short(name) or name == symbol:
        return labelled(variable, unit, width)
    return as_label(name.replace("_", " "), unit, width, symbol)


def with_quantities(ds: xr.Dataset) -> xr.Dataset:
    """Return a time history of `uq.simulate` as a Dataset with one variable per quantity.

    Parameters
    ----------
    ds : xarray.Dataset
        Returned unchanged if it has no ``trajectory``.

    Returns
    -------
    xarray.Dataset
    """
    if "trajectory" not in ds:
        return ds
    trajectory = ds["trajectory"]
    series = trajectory.reset_coords(drop=True).to_dataset("quantity")
    for values in trajectory.transpose("quantity", "time"):
        words = {"units": values["units"].item(), "long_name": values["meaning"].item()}
        series[values["quantity"].item()].attrs = words
    return series


def find(ds: xr.Dataset, name: str) -> xr.DataArray:
    """Return a variable by its name.

    Raises
    ------
    InputError
        When there is no such variable.
    """
    if name not in ds.variables:
        names = [str(other) for other in ds.variables]
        raise InputError(f"no such quantity '{name}'{nearest(name, names)}")
    return ds[name]


def pair(ds: xr.Dataset, x: str, y: str) -> tuple[xr.DataArray, xr.DataArray]:
    """Return two variables broadcast against each other, along one or two dimensions.

    Raises
    ------
    InputError
        When a variable does not exist, or the pair does not have one or two dimensions.
    """
    across, up = xr.broadcast(find(ds, x), find(ds, y))
    if across.ndim not in (1, 2):
        dims = ", ".join(map(str, across.dims)) or "nothing"
        raise InputError(f"'{y}' and '{x}' vary along {dims}, not one or two dimensions")
    return across, up


def axis_unit(variables: Sequence[xr.DataArray]) -> ReadableUnit:
    """Return a readable unit for quantities that share an axis: 0.00025 m become 0.25 mm.

    Parameters
    ----------
    variables : sequence of xarray.DataArray
        Numeric.

    Returns
    -------
    ReadableUnit

    Raises
    ------
    InputError
        When their units differ, or they are not numeric.
    """
    for variable in variables:
        if variable.dtype.kind not in "fiub":
            raise InputError(f"'{variable.name}' is not numeric and cannot be drawn")
    units = {str(variable.attrs.get("units", "1")): variable.name for variable in variables}
    if len(units) > 1:
        unlike = ", ".join(f"{name} [{unit}]" for unit, name in units.items())
        raise InputError(f"quantities of different units cannot share an axis: {unlike}")
    (unit,) = units
    return unit_of(unit, max(_largest(variable) for variable in variables))


def label_axes(
    axes: Axes, across: xr.DataArray, up: xr.DataArray, width: int = 26
) -> tuple[ReadableUnit, ReadableUnit]:
    """Label both axes of a panel, and return their units.

    Parameters
    ----------
    axes : Axes
    across, up : xarray.DataArray
        The horizontal and the vertical quantity.
    width : int
        Width of a line beside the vertical axis [characters].
    """
    units = axis_unit([across]), axis_unit([up])
    axes.set_xlabel(labelled(across, units[0].name))
    axes.set_ylabel(labelled(up, units[1].name, width))
    return units


def families(
    across: xr.DataArray, up: xr.DataArray, units: Sequence[ReadableUnit]
) -> Iterator[tuple[Floats, Floats, dict[str, Any]]]:
    """Yield the scaled coordinates, colour and label of each curve along the last dimension."""
    if across.ndim == 1:
        across, up = (variable.expand_dims("") for variable in (across, up))
    for i, (x, y) in enumerate(zip(across.values, up.values, strict=True)):
        name = place_in(across, i) if len(across) > 1 else ""
        style = {"color": COLOURS[i % len(COLOURS)], "label": name}
        yield in_unit(x, units[0]), in_unit(y, units[1]), style


def in_unit(values: Any, unit: ReadableUnit) -> Any:
    """Return values converted to the unit of an axis."""
    return values * (1 / unit.size)


def place_in(variable: xr.DataArray, i: int) -> str:
    """Return the coordinate along the first dimension in words: ``left``, ``start 2``."""
    dim = str(variable.dims[0])
    if dim not in variable.coords:
        return f"{dim} {i + 1}"
    value = variable[dim].values[i]
    if isinstance(value, str):
        return literal(value)
    return literal(f"{in_words(variable[dim])} {value:g}")


def _largest(variable: xr.DataArray) -> float:
    values = np.abs(np.asarray(variable.values, float))
    return float(values[np.isfinite(values)].max(initial=0.0))
