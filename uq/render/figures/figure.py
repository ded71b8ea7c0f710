"""Figures: their style, their layout and their files."""

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
import numpy as np
from matplotlib.axis import Axis
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.text import Text
from matplotlib.ticker import FixedLocator

from uq.errors import InputError
from uq.files.interrupts import undone
from uq.files.whole_files import file_behind
from uq.text.quantities import misfit, read_quantity

WIDTH = 84 / 25.4
"""Width of one column of a journal [inch]."""
PAGE = 174 / 25.4
"""Width of both columns [inch]."""

_asked_width: ContextVar[float | None] = ContextVar("width", default=None)


@contextmanager
def drawn_at(width: float | None) -> Iterator[None]:
    """Draw new figures at a width [inch]; None leaves each figure its own."""
    token = _asked_width.set(width)
    try:
        yield
    finally:
        _asked_width.reset(token)


def width_or(usual: float) -> float:
    """Return the width of a new figure [inch]: the one asked for, or the usual one."""
    return _asked_width.get() or usual


_NARROWEST, _WIDEST = 0.05, 0.5  # [m]


def width_in_metres(text: str) -> float:
    """Return the width of a figure [m] from a length with its unit: ``84mm``.

    Raises
    ------
    InputError
        When it is no length, or no width at which a figure can be read.
    """
    with suppress(ValueError):
        width = float(read_quantity(text))
        if not misfit(text, "width", "m") and _NARROWEST <= width <= _WIDEST:
            return width
    raise InputError(
        f"--width '{text}': must be a length from 50 to 500 mm with its unit, such as 84mm"
    )


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
BARS = ("#4A7BA6", "#A9C3DA", "#7F8C99", "#CFD6DC")
"""Colours of the kinds of indices, and of histograms."""
BAND = "#2F7FBF"
"""Colour of the confidence bands of a single curve."""
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
        with ticks_placed_once():
            engine.execute(figure)
        changed = _ticks(figure) != before  # the new size may require longer tick labels
        _keep_ticks(figure)
        if changed:
            with ticks_placed_once():
                engine.execute(figure)
        figure.set_layout_engine("none")  # otherwise each file format would repeat it


@contextmanager
def ticks_placed_once() -> Iterator[None]:
    """Place ticks once for each size of their axes, and measure each text once.

    matplotlib does so whenever a box is asked for, five times for each axis in each pass of a
    layout, most of its time.
    """
    place: Any = Axis._update_ticks  # type: ignore[attr-defined]
    measure: Any = Text._get_layout  # type: ignore[attr-defined]
    placed: dict[tuple[Any, ...], list[Any]] = {}
    measured: dict[tuple[Any, ...], Any] = {}

    def once(axis: Any) -> list[Any]:
        key = axis, *axis.get_view_interval(), *axis.axes.bbox.bounds
        if key not in placed:
            placed[key] = place(axis)
        return placed[key]

    def layout(text: Any, renderer: Any) -> Any:
        if text.get_wrap():  # its lines depend on its place
            return measure(text, renderer)
        font = text.get_fontproperties()
        key = (
            *(type(renderer), text.get_figure(root=True).dpi, text.get_text(), hash(font)),
            *(text.get_rotation(), text.get_rotation_mode(), text.get_ha(), text.get_va()),
            *(text._multialignment, text._linespacing, text.get_usetex(), text.get_parse_math()),
        )
        if key not in measured:
            measured[key] = measure(text, renderer)
        return measured[key]

    Axis._update_ticks = once  # type: ignore[attr-defined]
    Text._get_layout = layout  # type: ignore[attr-defined]
    try:
        yield
    finally:
        Axis._update_ticks = place  # type: ignore[attr-defined]
        Text._get_layout = measure  # type: ignore[attr-defined]


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


FORMATS = ("png", "svg", "pdf")
"""File formats of figures."""


@styled
def write(figure: Figure, path: Path, formats: Sequence[str] = FORMATS) -> list[Path]:
    """Write a figure in some formats, with reproducible bytes, and return the paths.

    Parameters
    ----------
    figure : Figure
    path : Path
        Path without a suffix.
    formats : sequence of str
        Of `FORMATS`.

    Returns
    -------
    list of Path

    Raises
    ------
    InputError
        When one of these paths exists and is not a file.
    """
    files = [path.with_name(f"{path.name}.{end}") for end in formats]
    for file in files:
        file_behind(file)
    lay_out(figure)
    for file, form in zip(files, formats, strict=True):
        with replaced(file) as part, ticks_placed_once():
            _WRITE[form](figure, part)
    return files


def _write_png(figure: Figure, path: Path) -> None:
    FigureCanvasAgg(figure).print_png(path, metadata={"Software": None})


def _write_svg(figure: Figure, path: Path) -> None:
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    FigureCanvasSVG(figure).print_svg(path, metadata={"Date": None, "Creator": None})


def _write_pdf(figure: Figure, path: Path) -> None:
    from matplotlib.backends.backend_pdf import FigureCanvasPdf

    no_metadata = dict.fromkeys(("CreationDate", "Creator", "Producer"))
    with _fonts_without_layout():
        FigureCanvasPdf(figure).print_pdf(path, metadata=no_metadata)


_WRITE = {"png": _write_png, "svg": _write_svg, "pdf": _write_pdf}


@contextmanager
def replaced(path: Path) -> Iterator[Path]:
    """Yield a temporary path, which replaces `path` once the figure is completely written."""
    file = file_behind(path)
    part = file.with_name(f".{file.stem}.{os.getpid()}{path.suffix}")  # matplotlib needs the suffix
    with undone(lambda: part.unlink(missing_ok=True)):
        yield part
        os.replace(part, file)
