"""Panels of a new figure or within given axes: their ticks, titles and legend."""

import re
from itertools import pairwise
from math import ceil
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.axis import Axis
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.ticker import LogFormatter
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray

from uq.errors import InputError
from uq.render.figures.figure import WIDTH, Drawing, width_or
from uq.result.elements import Floats
from uq.text.numbers import minus

_ENTRY = 0.15  # height of a line of the legend [inch]
_BELOW = 0.5  # distance of the legend below given axes with a label of one line [inch]
_HALF = 19  # characters of a label that fits half of a `Drawing` of one column
_LONG = 3.0  # length of a legend line with a marker [font size]
_SHORT = 30  # characters of labels that fit side by side

_CHARACTERS = 6
"""Length of a tick label, which determines how many ticks fit along an axis."""


def grid(
    axes: Axes | None,
    height: float,
    rows: int = 1,
    columns: int = 1,
    width: float = WIDTH,
    **shared: Any,
) -> NDArray[Any]:
    """Return a grid of panels, in a new figure or in place of given axes.

    Parameters
    ----------
    axes : matplotlib.axes.Axes or None
        Several panels divide its area.
    height : float
        Height of a new figure, without the legend that `finish` draws [inch].
    rows, columns : int
    width : float
        Usual width of a new figure [inch].
    **shared
        The axes that panels share, as in `matplotlib.figure.Figure.subplots`.

    Returns
    -------
    ndarray of Axes, shape (rows, columns)

    Raises
    ------
    InputError
        When several panels are asked for and the axes are not part of a grid.
    """
    if axes is None:
        figure = Drawing(figsize=(width_or(width), height), layout="constrained")
        return figure.subplots(rows, columns, squeeze=False, **shared)
    if rows == columns == 1:
        return np.array([[axes]])
    place = axes.get_subplotspec()
    if place is None:
        raise InputError("a figure of several panels needs axes of a grid, as of plt.subplots()")
    axes.set_axis_off()
    return place.subgridspec(rows, columns).subplots(squeeze=False, **shared)


def column(axes: Axes | None, height: float, rows: int = 1) -> list[Axes]:
    """Return panels with a shared horizontal axis, top to bottom; see `grid`."""
    panels = grid(axes, height, rows, sharex=True)[:, 0]
    if axes is None:
        roomy(panels[0])
    return list(panels)


def roomy(axes: Axes, ticks: int = 6) -> None:
    """Thin out the ticks of a horizontal linear axis until their labels do not overlap."""
    whole_numbers(axes.xaxis)
    for count in range(ticks, 0, -1):
        axes.locator_params(axis="x", nbins=count)
        low, high = sorted(axes.get_xlim())
        shown = [tick for tick in axes.get_xticks() if low <= tick <= high]
        widths = [len(text) for text in axes.xaxis.get_major_formatter().format_ticks(shown)]
        gaps = np.diff(shown) / (high - low) * _CHARACTERS * ticks
        if all(gap >= (a + b) / 2 + 1 for gap, (a, b) in zip(gaps, pairwise(widths), strict=True)):
            return
    axes.set_xticks([shown[0], shown[-1]])  # round steps leave at least three ticks


def whole_numbers(axis: Axis) -> None:
    """Write tick labels in full, because a common factor would overlap the axis label."""
    axis.set_major_formatter(lambda value, _: _short(value, ".6g"))


def _short(value: float, form: str) -> str:
    return minus(re.sub(r"e\+?(-?)0*", r"e\1", f"{value:{form}}"))


class _PlainLog(LogFormatter):
    """Formatter with plain numbers instead of TeX, at the ticks that matplotlib would label.

    Of a decade it labels 1, 2 and 5 at most if the axis is longer: others would overlap.
    """

    def __call__(self, x: float, pos: int | None = None) -> str:
        assert self.axis is not None
        low, high = self.axis.get_view_interval()
        digit, alike = f"{x:e}"[0], x
        if high > 10 * low > 0:
            if digit not in "125":
                return ""
            alike = 0.4 * x if digit == "5" else x  # matplotlib labels 2, 3, 4 and 6
        return _short(x, "g" if 1e-3 <= x < 1e5 else ".0e") if super().__call__(alike, pos) else ""


def logarithmic(axes: Axes, vertical: bool = False) -> None:
    """Make the horizontal (or vertical) axis logarithmic, with plain numbers as tick labels."""
    axis, scale = (axes.yaxis, axes.set_yscale) if vertical else (axes.xaxis, axes.set_xscale)
    scale("log")
    axis.set_major_formatter(_PlainLog())
    axis.set_minor_formatter(_PlainLog())


def is_wide(values: Floats) -> bool:
    """Return whether positive values span a range wide enough for a logarithmic axis."""
    if len(values) == 0 or values.min() <= 0:
        return False
    low, middle, high = np.quantile(values, (0.005, 0.5, 0.995))
    return bool(high > 30 * low and middle - low < (high - low) / 4)


def arrows(axes: Axes, place: Floats, low: Floats, high: Floats, along: str, **style: Any) -> None:
    """Draw an arrow at the edge of the frame for each interval end outside it.

    Parameters
    ----------
    axes : Axes
        Axes with final limits.
    place : ndarray
        Positions of the intervals along the other axis.
    low, high : ndarray
        Interval ends; infinite ends always leave the frame, NaN means no end.
    along : {"x", "y"}
        Axis parallel to the intervals.
    **style
        Style of the arrows.
    """
    first, last = axes.get_xlim() if along == "x" else axes.get_ylim()
    for edge, outside, marker in zip(
        (first, last), (low < first, high > last), ("<>" if along == "x" else "v^"), strict=True
    ):
        if outside.any():
            points = [place[outside], np.full(outside.sum(), edge)]
            at = points[::-1] if along == "x" else points
            axes.plot(*at, marker, ms=3.5, mew=0, clip_on=False, zorder=5, **style)


def figure_of(axes: Axes) -> Figure:
    """Return the figure that contains the axes."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    return figure


def finish(axes: Axes, entries: int | None = None) -> Figure:
    """Draw the legend, if any, below a `Drawing` or the given axes, and return the figure.

    Parameters
    ----------
    axes : Axes
        One panel of the figure.
    entries : int, optional
        Number of lines added to the height of a `Drawing`; by default the legend's.

    Returns
    -------
    Figure
    """
    handles, labels = axes.get_legend_handles_labels()
    figure = figure_of(axes)
    if isinstance(figure, Drawing):
        short = max(map(len, labels), default=0) <= _HALF
        is_wide_figure = figure.get_figwidth() > 1.5 * WIDTH
        across = (1 + short) * (1 + is_wide_figure)
        lines = ceil(len(labels) / across) if entries is None else entries
        figure.set_figheight(figure.get_figheight() + _ENTRY * lines)
    if labels and isinstance(figure, Drawing):
        # A central marker would hide the dashes of a short line.
        dotted = any(
            isinstance(handle, Line2D) and handle.get_marker() == "." for handle in handles
        )
        style = {"handlelength": _LONG} if dotted else {}
        shown = figure.legend(
            handles, labels, loc="outside lower left", markerscale=1.5, ncols=across, **style
        )
        for handle in shown.legend_handles:
            if isinstance(handle, Line2D) and handle.get_linestyle() == "None":
                handle.set(markersize=6, alpha=1)  # small, transparent points hide their colour
    elif labels:
        columns = len(labels) if len("".join(labels)) < _SHORT else 1
        down = _BELOW + _ENTRY * axes.get_xlabel().count("\n")
        below_label = axes.transAxes + ScaledTranslation(0, -down, figure.dpi_scale_trans)
        place = {"bbox_to_anchor": (0, 0), "bbox_transform": below_label}
        axes.legend(loc="upper left", borderaxespad=0, ncols=columns, **place)
    return figure


def heading(axes: Axes, text: str) -> None:
    """Write the subject of a figure above a `Drawing`, otherwise above the panel."""
    if isinstance(figure := figure_of(axes), Drawing):
        figure.suptitle(text, x=0.01, ha="left", fontsize=8)
    else:
        axes.set_title(f"{text}\n{axes.get_title(loc='left')}".strip(), loc="left")


def untitled(figure: Figure) -> None:
    """Remove the titles of a figure, which a journal puts into its caption."""
    for axes in figure.axes:
        axes.set_title("", loc="left")
        axes.yaxis.label.set_visible(True)
    if isinstance(figure, Drawing):
        figure.suptitle("")


def title(axes: Axes, *lines: str, quantity: str = "") -> None:
    """Write lines of text above a panel: the quantity of its vertical axis and its subject.

    Without titles, the quantity is the label of the axis.
    """
    axes.set_title("\n".join(filter(None, lines)), loc="left")
    if quantity:
        axes.set_ylabel(quantity, visible=False)


def above(axes: Axes, text: str) -> None:
    """Write the label of the vertical axis above a low panel, where it fits."""
    axes.set_ylabel(text, rotation=0, ha="left", va="bottom")
    axes.yaxis.set_label_coords(0.0, 1.03)
    # The layout ignores the height of this label; a title of equally many empty lines reserves it.
    axes.set_title(" " + "\n " * text.count("\n"), loc="left")
