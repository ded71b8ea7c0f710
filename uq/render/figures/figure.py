"""Figures: their style, their layout and their files."""

import os
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.ticker import FixedLocator

from uq.files.interrupts import undone
from uq.files.whole_files import file_behind

WIDTH = 84 / 25.4
"""Width of one column of a journal [inch]."""
PAGE = 174 / 25.4
"""Width of both columns [inch]."""

# Okabe and Ito, "Color universal design" (2008), without yellow and black.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
"""Colours of regimes and attractors; figures of a result use no other colour except `LIMIT`."""

INK = "black"
"""Colour of estimates and laws; a page replaces it by the colour of its text."""
ROWS = "#A0A6AD"
"""Colour of rows, individual or counted."""
LIMIT = "#C2185B"
"""Colour of limits: thresholds of a study, stops of a machine."""
SHADES = (INK, "#9A9A9A", "#707070", "#BBBBBB")
"""Shades of the elements of an output, combined with `LINES`."""
BARS = ("#6B7580", "#B4BBC2", "#8E979F", "#D0D5DA")
"""Shades of the kinds of indices."""
LINES = ("-", "--", "-.", ":")

_STYLE: Any = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.formatter.limits": (-4, 5),
    "axes.formatter.useoffset": False,  # beside an axis, it would look like a title
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "svg.hashsalt": "vibrolife",
    "pdf.fonttype": 42,  # keep text searchable and editable
}
styled = mpl.rc_context(_STYLE)
"""Decorator for every function that draws or writes a figure."""

_MANY = 4000

MARK = 2.5
"""Size of single marks on curves [points]."""

_SIZES = {"cloud": (1000, 4.5, 3.0), "diagram": (2000, 2.0, 1.2), "section": (59, 3.0, 1.0)}
"""Point sizes [points]: maximum count of large points, large size, small size."""


def point_size(kind: str, count: int) -> float:
    """Return the point size for a scatter plot, bifurcation diagram or Poincaré section."""
    most, large, small = _SIZES[kind]
    return large if count <= most else small


def are_many(points: int) -> bool:
    """Return whether to rasterise this many points to keep the file small."""
    return points > _MANY


def thinned(count: int, most: int = 1000) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Return the indices of the points of a thinned curve, including both ends."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.intp))


DOTS_PER_INCH = 200
_DOTS_PER_INCH_SHOWN = 144


class Drawing(Figure):
    """A figure that notebooks display without pyplot."""

    def _repr_png_(self) -> bytes:
        png = BytesIO()
        self.savefig(png, format="png", dpi=_DOTS_PER_INCH_SHOWN)
        return png.getvalue()


@styled
def lay_out(figure: Figure) -> None:
    """Lay out a figure once for all its file formats."""
    figure.set_dpi(DOTS_PER_INCH)
    FigureCanvasAgg(figure)
    if engine := figure.get_layout_engine():
        before = _ticks(figure)
        engine.execute(figure)
        changed = _ticks(figure) != before  # the new size may require longer tick labels
        _keep_ticks(figure)
        if changed:
            engine.execute(figure)
        figure.set_layout_engine("none")  # otherwise each file format would repeat it


def _scales(figure: Figure) -> Iterator[Axis]:
    """Yield both axes of each panel and of each secondary scale."""
    for panel in figure.axes:
        for axes in (panel, *panel.child_axes):
            yield from (axes.xaxis, axes.yaxis)


def _ticks(figure: Figure) -> list[list[float]]:
    """Return the positions of all ticks."""
    return [list(axis.get_majorticklocs()) for axis in _scales(figure)]


def _keep_ticks(figure: Figure) -> None:
    """Fix the tick positions, because other ticks at the next size would change the layout."""
    for axis in _scales(figure):
        axis.set_major_locator(FixedLocator(list(axis.get_majorticklocs())))


@contextmanager
def _fonts_without_layout() -> Iterator[None]:
    """Embed fonts without their tables of ligatures and kerning.

    matplotlib places each letter itself; subsetting these tables takes most of the time of a PDF.
    """
    from fontTools.subset import Options

    before = Options._drop_tables_default
    Options._drop_tables_default = [*before, "GDEF", "GPOS", "GSUB", "kern"]
    try:
        yield
    finally:
        Options._drop_tables_default = before


@styled
def write(figure: Figure, path: Path) -> list[Path]:
    """Write a figure as PNG, SVG and PDF, with reproducible bytes, and return their paths.

    Parameters
    ----------
    figure : Figure
    path : Path
        Path without a suffix.

    Returns
    -------
    list of Path

    Raises
    ------
    InputError
        When one of these paths exists and is not a file.
    """
    png, svg, pdf = files = [path.with_name(f"{path.name}.{end}") for end in ("png", "svg", "pdf")]
    for file in files:
        file_behind(file)
    lay_out(figure)
    with replaced(png) as part:
        FigureCanvasAgg(figure).print_png(part, metadata={"Software": None})
    with replaced(svg) as part:
        FigureCanvasSVG(figure).print_svg(part, metadata={"Date": None, "Creator": None})
    no_metadata = dict.fromkeys(("CreationDate", "Creator", "Producer"))
    with _fonts_without_layout(), replaced(pdf) as part:
        FigureCanvasPdf(figure).print_pdf(part, metadata=no_metadata)
    return files


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Yield a temporary path, which replaces `path` once the figure is completely written."""
    file = file_behind(path)
    part = file.with_name(f".{file.stem}.{os.getpid()}{path.suffix}")  # matplotlib needs the suffix
    with undone(lambda: part.unlink(missing_ok=True)):
        yield part
        os.replace(part, file)
