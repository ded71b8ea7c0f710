"""The style of figures, their files, and the words and units on their axes."""

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
"""Decorates every function that draws or writes a figure."""


class Drawing(Figure):
    """A figure that notebooks display without pyplot."""

    def _repr_png_(self) -> bytes:
        png = BytesIO()
        self.savefig(png, format="png", dpi=_DOTS_PER_INCH_SHOWN)
        return png.getvalue()


def roomy(axes: Axes, ticks: int = 6) -> None:
    """Thin out the ticks of a horizontal, linear axis until their numbers do not touch."""
    whole_numbers(axes.xaxis)
    for count in range(ticks, 0, -1):
        axes.locator_params(axis="x", nbins=count)
        low, high = sorted(axes.get_xlim())
        shown = [tick for tick in axes.get_xticks() if low <= tick <= high]
        widths = [len(text) for text in axes.xaxis.get_major_formatter().format_ticks(shown)]
        gaps = np.diff(shown) / (high - low) * _CHARACTERS * ticks
        if all(gap >= (a + b) / 2 + 1 for gap, (a, b) in zip(gaps, pairwise(widths), strict=True)):
            return
    axes.set_xticks([shown[0], shown[-1]])  # steps of round numbers leave at least three


def whole_numbers(axis: Axis) -> None:
    """Write each number in full: a common factor at the end of the axis would cover its label."""

    def short(value: float, _: float) -> str:
        text = re.sub(r"e\+?(-?)0*", r"e\1", f"{value:.6g}")
        return text.replace("-", "\N{MINUS SIGN}")

    axis.set_major_formatter(short)


class _PlainLog(LogFormatter):
    """Plain numbers instead of TeX, at the ticks that matplotlib would label."""

    def __call__(self, x: float, pos: int | None = None) -> str:
        return f"{x:g}".replace("-", "\N{MINUS SIGN}") if super().__call__(x, pos) else ""


def logarithmic(axes: Axes, vertical: bool = False) -> None:
    """Make the horizontal (or the vertical) axis logarithmic, with plain numbers."""
    axis, scale = (axes.yaxis, axes.set_yscale) if vertical else (axes.xaxis, axes.set_xscale)
    scale("log")
    axis.set_major_formatter(_PlainLog())
    axis.set_minor_formatter(_PlainLog())


@styled
def lay_out(figure: Figure) -> None:
    """Lay out a figure once for all its files."""
    figure.set_dpi(DOTS_PER_INCH)
    FigureCanvasAgg(figure)
    if engine := figure.get_layout_engine():
        before = _tick_labels(figure)
        engine.execute(figure)
        if _tick_labels(figure) != before:  # the new size may call for longer numbers
            engine.execute(figure)
        figure.set_layout_engine("none")  # or else each file would repeat it


def _tick_labels(figure: Figure) -> list[str]:
    sides = (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis))
    return [label.get_text() for axis in sides for label in axis.get_ticklabels()]


@styled
def write(figure: Figure, path: Path) -> list[Path]:
    """Write a figure as PNG, SVG and PDF, with reproducible bytes, and return their paths.

    Parameters
    ----------
    figure : Figure
    path : Path
        Without a suffix.

    Returns
    -------
    list of Path

    Raises
    ------
    InputError
        When one of them exists and is not a file.
    """
    png, svg, pdf = files = [path.with_name(f"{path.name}.{end}") for end in ("png", "svg", "pdf")]
    for file in files:
        file_behind(file)
    lay_out(figure)
    FigureCanvasAgg(figure).print_png(png, metadata={"Software": None})
    FigureCanvasSVG(figure).print_svg(svg, metadata={"Date": None, "Creator": None})
    no_metadata = dict.fromkeys(("CreationDate", "Creator", "Producer"))
    FigureCanvasPdf(figure).print_pdf(pdf, metadata=no_metadata)
    return files


def file_name(*words: str) -> str:
    """Join words to a file name without characters special to a shell."""
    return re.sub(r"[^A-Za-z0-9.+-]+", "_", "-".join(words)).strip("_")


def sentence(text: str, unit: str = "", width: int = 44) -> str:
    """Return text for an axis: capitalised, with its unit, wrapped."""
    text = plain(text[:1].upper() + text[1:])
    if unit and unit != "1":
        text += " " + f"[{powers(unit)}]".replace(" ", "\u00a0")  # units are not broken
    return textwrap.fill(text, width).replace("\u00a0", " ")


def powers(unit: str) -> str:
    """Return a CF unit with raised exponents: ``m2 N-1`` becomes ``m² N⁻¹``."""
    raised = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")
    return re.sub(r"(?<=[A-Za-z])-?\d+", lambda found: found[0].translate(raised), unit)


def place_in_words(element: Element, variable: xr.DataArray) -> str:
    """Return the place of an element within its output: ``left, 250 µm``."""
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


def in_words(variable: xr.DataArray) -> str:
    """Return the meaning of a variable, with its symbol (never broken) where it has one."""
    meaning = str(variable.attrs.get("long_name", str(variable.name).replace("_", " ")))
    symbol = str(variable.attrs.get("symbol", "")).replace(" ", "\u00a0")
    return f"{meaning} ({symbol})" if symbol else meaning


def named_input(parameter: xr.DataArray, width: int = 44) -> str:
    """Return the label of an input for an axis."""
    return sentence(in_words(parameter), parameter.attrs["units"], width)


def is_wide(values: Floats) -> bool:
    """Whether positive values spread so widely that a logarithmic axis shows them better."""
    if len(values) == 0 or values.min() <= 0:
        return False
    low, middle, high = np.quantile(values, (0.005, 0.5, 0.995))
    return bool(high > 30 * low and middle - low < (high - low) / 4)


def thinned(count: int, most: int = 1000) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Return the indices of the points of a curve to draw: both ends and enough in between."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.intp))
