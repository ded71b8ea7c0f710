"""A figure: its style, its layout and its files."""

import re
from io import BytesIO
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_pdf import FigureCanvasPdf
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from uq.places import file_behind

WIDTH = 3.4
"""One column of a journal [inch]."""

DOTS_PER_INCH = 200
_DOTS_PER_INCH_SHOWN = 144

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
"""The decorator of every function that draws or writes a figure."""


class Drawing(Figure):
    """A figure that notebooks display without pyplot."""

    def _repr_png_(self) -> bytes:
        png = BytesIO()
        self.savefig(png, format="png", dpi=_DOTS_PER_INCH_SHOWN)
        return png.getvalue()


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
