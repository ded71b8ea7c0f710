"""Words and units in figures and reports."""

import re
import textwrap
from collections.abc import Mapping, Sequence
from typing import Any

import xarray as xr
from matplotlib.ticker import EngFormatter

from uq.literals import plain
from uq.rows.elements import Element
from uq.wording import percent


def as_label(text: str, unit: str = "", width: int = 44) -> str:
    """Return text for an axis or a panel: capitalised, with its unit, wrapped."""
    text = plain(text[:1].upper() + text[1:])
    if unit and unit != "1":
        text += f" [{unbroken(unit)}]"
    return textwrap.fill(text, width).replace("\u00a0", " ")


def powers(unit: str) -> str:
    """Return a CF unit with raised exponents: ``m2 N-1`` becomes ``m² N⁻¹``."""
    raised = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    return re.sub(r"(?<=[A-Za-z])-?\d+", lambda found: found[0].translate(raised), unit)


def unbroken(unit: str) -> str:
    """Return a unit as in `powers`, with spaces at which no line breaks."""
    return powers(unit).replace(" ", "\u00a0")


def place_in_words(ds: xr.Dataset, element: Element) -> str:
    """Return the place of an element within its output: ``left, 250 µm``."""
    words, variable = [], ds[element.output]
    for dim, value in element.place.items():
        attrs: Mapping[str, Any] = variable[dim].attrs if dim in variable.coords else {}
        if isinstance(value, str):
            words.append(value)
        elif attrs.get("units") in ("m", "s", "Hz"):
            words.append(EngFormatter(attrs["units"])(value))
        else:
            words.append(f"{dim} {value:g}")
    return ", ".join(words)


def label(ds: xr.Dataset, element: Element, never: float = 0.0) -> str:
    """Return the label of a curve: its place, and the share of rows that never end."""
    share = f"never: {percent(never)}" if never > 0 else ""
    return ", ".join(filter(None, (place_in_words(ds, element), share)))


def rows_in_words(chosen: Sequence[Element]) -> str:
    """Return how many rows there are, and how many failed or have no value."""
    counts = [f"{len(chosen[0].values)} rows"]
    for state in ("failed", "undefined", "censored"):
        most = max(int(getattr(element, state).sum()) for element in chosen)
        if most:
            counts.append(f"{'up to ' if len(chosen) > 1 else ''}{most} {state}")
    return ", ".join(counts)


def element_in_words(ds: xr.Dataset, element: Element) -> str:
    """Return the meaning of an element and its place: ``time to wear depth, left, 250 µm``."""
    return ", ".join(filter(None, (element.meaning, place_in_words(ds, element))))


def in_words(variable: xr.DataArray) -> str:
    """Return the meaning of a variable, with its symbol (never broken) where it has one."""
    meaning = str(variable.attrs.get("long_name", str(variable.name).replace("_", " ")))
    symbol = str(variable.attrs.get("symbol", "")).replace(" ", "\u00a0")
    return f"{meaning} ({symbol})" if symbol else meaning


def named_input(parameter: xr.DataArray, width: int = 44) -> str:
    """Return the label of an input for an axis."""
    return as_label(in_words(parameter), parameter.attrs["units"], width)
