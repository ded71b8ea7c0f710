"""The style of figures: their width and fonts, colours, lines and points."""

from typing import Any

import matplotlib as mpl
import numpy as np

WIDTH = 84 / 25.4
"""One column of a journal [inch]."""
PAGE = 174 / 25.4
"""Both columns [inch]."""

# Okabe and Ito, "Color universal design" (2008), without yellow and black.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#56B4E9", "#E69F00")
"""Of regimes and attractors in figures of a result, which use no colour otherwise but `LIMIT`."""

INK = "black"
"""Of estimates and laws; a page shows it in the colour of its text."""
ROWS = "#A0A6AD"
"""Of rows, one by one or counted."""
LIMIT = "#C2185B"
"""Of limits: the thresholds of a study, the stops of a machine."""
SHADES = (INK, "#9A9A9A", "#707070", "#BBBBBB")
"""Of the elements of an output, together with `LINES`."""
BARS = ("#6B7580", "#B4BBC2", "#8E979F", "#D0D5DA")
"""Of the kinds of indices."""
LINES = ("-", "--", "-.", ":")

_STYLE: Any = {
    "font.size": 8,
    "axes.titlesize": 8,
    "axes.formatter.limits": (-4, 5),
    "axes.formatter.useoffset": False,  # beside an axis, it is taken for a title
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.fontsize": 7,
    "legend.frameon": False,
    "lines.linewidth": 1.2,
    "svg.hashsalt": "vibrolife",
    "pdf.fonttype": 42,  # text that can be searched and edited
}
styled = mpl.rc_context(_STYLE)
"""The decorator of every function that draws or writes a figure."""

_MANY = 4000

MARK = 2.5
"""Size of single marks on curves [points]."""

_SIZES = {"cloud": (1000, 4.5, 3.0), "diagram": (2000, 2.0, 1.2), "section": (59, 3.0, 1.0)}
"""Of the points of a figure [points]: up to how many they are large; large; small."""


def point_size(kind: str, count: int) -> float:
    """Return the size of the points of a cloud, bifurcation diagram or section."""
    most, large, small = _SIZES[kind]
    return large if count <= most else small


def are_many(points: int) -> bool:
    """Whether so many points should be drawn as pixels to keep the file small."""
    return points > _MANY


def thinned(count: int, most: int = 1000) -> np.ndarray[Any, np.dtype[np.intp]]:
    """Return the indices of the points of a curve to draw: both ends and enough in between."""
    return np.unique(np.linspace(0, count - 1, min(count, most)).astype(np.intp))
