"""How figures look, how they are written, and the words and units on their axes."""

import re
import textwrap
from collections.abc import Mapping
from io import BytesIO
from itertools import pairwise
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import EngFormatter, LogFormatter

from uq.literals import plain
from uq.places import file_behind
from uq.rows.elements import Element, Floats

WIDTH = 3.4
"""One column of a journal [inch]."""

DOTS_PER_INCH = 200
_DOTS_PER_INCH_SHOWN = 144

_CHARACTERS = 6
"""Of a number beside each of the ticks that an axis has room for."""

# Okabe and Ito, "Color universal design" (2008), without yellow and black.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
LINES = ("-", "--", "-.", ":")

_STYLE: Any = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.formatter.limits": (-4, 5),
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "text.parse_math": False,  # a dollar sign in a file is one
    "svg.hashsalt": "vibrolife",
    "pdf.fonttype": 42,  # text that can be searched and edited
}
styled = mpl.rc_context(_STYLE)
"""Decorates whatever draws or writes a figure."""


class Drawing(Figure):
    """A figure that a notebook shows, also where pyplot, which else sees to that, is not in use."""

    def _repr_png_(self) -> bytes:
        png = BytesIO()
        self.savefig(png, format="png", dpi=_DOTS_PER_INCH_SHOWN)
        return png.getvalue()


def roomy(axes: Axes, ticks: int = 6) -> None:
    """Have so few ticks on a horizontal axis, not yet logarithmic, that long numbers have room."""
    whole_numbers(axes.xaxis)
    for count in range(ticks, 0, -1):
        axes.locator_params(axis="x", nbins=count)
        low, high = sorted(axes.get_xlim())
        shown = [tick for tick in axes.get_xticks() if low <= tick <= high]
        widths = [len(text) for text in axes.xaxis.get_major_formatter().format_ticks(shown)]
        gaps = np.diff(shown) / (high - low) * _CHARACTERS * ticks
        if all(gap >= (a + b) / 2 + 1 for gap, (a, b) in zip(gaps, pairwise(widths), strict=True)):
            return
    axes.set_xticks([shown[0], shown[-1]])  # no step of round numbers leaves less than three


def whole_numbers(axis: Axis) -> None:
    """Write each number in full: a common factor at the end of an axis covers its label."""
    axis.set_major_formatter(lambda value, _: _short(value))


def _short(value: float) -> str:
    """Return a number with the minus sign of other axes, and no more exponent than it needs."""
    text = re.sub(r"e\+?(-?)0*", r"e\1", f"{value:.6g}")
    return text.replace("-", "\N{MINUS SIGN}")


class _PlainLog(LogFormatter):
    """Numbers as one writes them, at the ticks that matplotlib would label; never as TeX."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:g}".replace("-", "\N{MINUS SIGN}") if super().__call__(x, pos) else ""


def logarithmic(axes: Axes, vertical: bool = False) -> None:
    """Make the horizontal axis logarithmic, or the vertical one, its numbers in plain text."""
    axis, scale = (axes.yaxis, axes.set_yscale) if vertical else (axes.xaxis, axes.set_xscale)
    scale("log")
    axis.set_major_formatter(_PlainLog())
    axis.set_minor_formatter(_PlainLog())


@styled
def lay_out(figure: Figure) -> None:
    """Give everything in a figure its place, for all files alike."""
    figure.set_dpi(DOTS_PER_INCH)
    FigureCanvasAgg(figure)
    if engine := figure.get_layout_engine():
        before = _tick_labels(figure)
        engine.execute(figure)
        if _tick_labels(figure) != before:  # in its place an axis may have longer numbers
            engine.execute(figure)
        figure.set_layout_engine("none")  # it would be done again for each file


def _tick_labels(figure: Figure) -> list[str]:
    sides = (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis))
    return [label.get_text() for axis in sides for label in axis.get_ticklabels()]


@styled
def write(figure: Figure, path: Path) -> list[Path]:
    """Write a figure as PNG, SVG and PDF, the same bytes each time, and return their paths.

    Parameters
    ----------
    figure : Figure
    path : Path
        Without an ending.

    Returns
    -------
    list of Path

    Raises
    ------
    InputError
        When one of them is there and is no file.
    """
    png, svg, pdf = files = tuple(
        path.with_name(f"{path.name}.{ending}") for ending in ("png", "svg", "pdf")
    )
    for file in files:
        file_behind(file)
    lay_out(figure)
    FigureCanvasAgg(figure).print_png(png, metadata={"Software": None})
    FigureCanvasSVG(figure).print_svg(svg, metadata={"Date": None, "Creator": None})
    FigureCanvasPdf(figure).print_pdf(
        pdf, metadata={"CreationDate": None, "Creator": None, "Producer": None}
    )
    return [png, svg, pdf]


def file_name(*words: str) -> str:
    """Return words as the name of a file, without anything that a shell would notice."""
    return re.sub(r"[^A-Za-z0-9.+-]+", "_", "-".join(words)).strip("_")


def sentence(text: str, unit: str = "", width: int = 44) -> str:
    """Return text for an axis: wrapped, with a capital, its unit behind, nothing read as TeX."""
    text = plain(text[:1].upper() + text[1:])
    if unit and unit != "1":
        text += " " + f"[{powers(unit)}]".replace(" ", "\u00a0")  # a unit stays in one piece
    return textwrap.fill(text, width).replace("\u00a0", " ")


def powers(unit: str) -> str:
    """Return a CF unit with raised exponents: ``m2 N-1`` becomes ``m² N⁻¹``."""
    raised = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    return re.sub(r"(?<=[A-Za-z])-?\d+", lambda found: found[0].translate(raised), unit)


def place_in_words(element: Element, variable: xr.DataArray) -> str:
    """Return which element of its output this is: ``left, 250 µm``."""
    words = []
    for dim, value in element.place.items():
        attrs: Mapping[str, Any] = variable[dim].attrs if dim in variable.coords else {}
        if isinstance(value, str):
            words.append(value)
        elif attrs.get("units") in ("m", "s", "Hz"):
            words.append(EngFormatter(attrs["units"])(value))
        else:
            words.append(f"{dim} {value:g}")
    return ", ".join(words)


def named_input(parameter: xr.DataArray, width: int = 44) -> str:
    """Return the name of an input for an axis: its symbol tells apart those of one meaning."""
    return sentence(with_symbol(parameter), parameter.attrs["units"], width)


def with_symbol(parameter: xr.DataArray) -> str:
    """Return what an input is, and its symbol, which stays in one piece."""
    symbol = str(parameter.attrs["symbol"]).replace(" ", "\u00a0")
    return f"{parameter.attrs['long_name']} ({symbol})"


def is_wide(values: Floats) -> bool:
    """Whether values, all positive, crowd so far down that a logarithmic axis shows them better."""
    if len(values) == 0 or values.min() <= 0:
        return False
    low, middle, high = np.quantile(values, (0.005, 0.5, 0.995))
    return bool(high > 30 * low and middle - low < (high - low) / 4)


def thinned(count: int, most: int = 1000) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Return which of `count` points of a curve to draw: the ends and enough between."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.intp))
