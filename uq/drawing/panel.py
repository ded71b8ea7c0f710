"""Panels of a new figure or within given axes, with their titles and legend."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray

from uq.drawing.figure import Drawing
from uq.drawing.style import WIDTH
from uq.drawing.ticks import roomy
from uq.errors import InputError

_ENTRY = 0.15  # height of a line of the legend [inch]
_SHORT = 30  # characters of labels that fit side by side


def grid(
    axes: Axes | None, height: float, rows: int = 1, columns: int = 1, **shared: Any
) -> NDArray[Any]:
    """Return panels, of a new figure one column wide or in place of given axes.

    Parameters
    ----------
    axes : matplotlib.axes.Axes or None
        Several panels divide its area.
    height : float
        Of a new figure [inch].
    rows, columns : int
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
        figure = Drawing(figsize=(WIDTH, height), layout="constrained")
        return figure.subplots(rows, columns, squeeze=False, **shared)
    if rows == columns == 1:
        return np.array([[axes]])
    place = axes.get_subplotspec()
    if place is None:
        raise InputError("a figure of several panels needs axes of a grid, as of plt.subplots()")
    axes.set_axis_off()
    return place.subgridspec(rows, columns).subplots(squeeze=False, **shared)


def column(axes: Axes | None, height: float, rows: int = 1, entries: int = 0) -> list[Axes]:
    """Return panels, top to bottom, that share the horizontal axis; see `grid`.

    Parameters
    ----------
    axes : matplotlib.axes.Axes or None
    height : float
        Of a new figure without its legend [inch].
    rows : int
    entries : int
        Lines of the legend below.
    """
    panels = grid(axes, height + _ENTRY * entries, rows, sharex=True)[:, 0]
    if axes is None:
        roomy(panels[0])
    return list(panels)


def figure_of(axes: Axes) -> Figure:
    """Return the figure that axes belong to."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    return figure


def legend(axes: Axes) -> Figure:
    """Draw the legend, if there is one: below a `Drawing`, or below the given axes.

    Parameters
    ----------
    axes : Axes
        One panel of the figure.

    Returns
    -------
    Figure
    """
    handles, labels = axes.get_legend_handles_labels()
    figure = figure_of(axes)
    if labels and isinstance(figure, Drawing):
        shown = figure.legend(handles, labels, loc="outside lower left", markerscale=1.5)
        for handle in shown.legend_handles:
            if isinstance(handle, Line2D) and handle.get_linestyle() == "None":
                handle.set(markersize=6, alpha=1)  # small, transparent points hide their colour
    elif labels:
        columns = len(labels) if len("".join(labels)) < _SHORT else 1
        below_label = axes.transAxes + ScaledTranslation(0, -0.5, figure.dpi_scale_trans)
        place = {"bbox_to_anchor": (0, 0), "bbox_transform": below_label}
        axes.legend(loc="upper left", borderaxespad=0, ncols=columns, **place)
    return figure


def finish(axes: Axes) -> Figure:
    """Draw the legend of a panel, make room for it in a `Drawing`, and return the figure."""
    figure = figure_of(axes)
    if isinstance(figure, Drawing):
        entries = len(axes.get_legend_handles_labels()[1])
        figure.set_figheight(figure.get_figheight() + _ENTRY * entries)
    return legend(axes)


def heading(axes: Axes, text: str) -> None:
    """Write the subject of a figure above a `Drawing`, or else above the panel."""
    if isinstance(figure := figure_of(axes), Drawing):
        figure.suptitle(text, x=0.01, ha="left", fontsize=8)
    else:
        axes.set_title(f"{text}\n{axes.get_title(loc='left')}".strip(), loc="left")


def above(axes: Axes, text: str) -> None:
    """Write the label of the vertical axis above it, where a low panel has room for it."""
    axes.set_ylabel(text, rotation=0, ha="left", va="bottom")
    axes.yaxis.set_label_coords(0.0, 1.03)
    # The layout ignores the height of this label; a title of as many empty lines reserves it.
    axes.set_title(" " + "\n " * text.count("\n"), loc="left")
