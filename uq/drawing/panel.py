"""Panels of a figure: made, or found in axes that are given; their words and their legend."""

from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.transforms import ScaledTranslation
from numpy.typing import NDArray

from uq.drawing.figure import WIDTH, Drawing, roomy
from uq.errors import InputError

_ENTRY = 0.15  # height of a line of the legend [inch]
_MANY = 4000
_SHORT = 30  # characters that fit beside each other


def grid(
    axes: Axes | None, height: float, rows: int = 1, columns: int = 1, **shared: Any
) -> NDArray[Any]:
    """Return panels: of a new figure one column wide, or where the axes given are.

    Parameters
    ----------
    axes : matplotlib.axes.Axes or None
        Several panels divide their place.
    height : float
        Of a new figure [inch].
    rows, columns : int
    **shared
        Which axes the panels share, as in `matplotlib.figure.Figure.subplots`.

    Returns
    -------
    ndarray of Axes, shape (rows, columns)

    Raises
    ------
    InputError
        When the axes have no place that could be divided.
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
    """Return panels from top to bottom that share the horizontal axis; see `grid`.

    Parameters
    ----------
    axes : matplotlib.axes.Axes or None
    height : float
        Of a new figure without its legend [inch].
    rows : int
    entries : int
        Lines of the legend below.
    """
    panels = list(grid(axes, height + _ENTRY * entries, rows, sharex=True)[:, 0])
    if axes is None:
        roomy(panels[0])
    return panels


def figure_of(axes: Axes) -> Figure:
    """Return the figure that axes belong to."""
    figure = axes.get_figure(root=True)
    assert figure is not None
    return figure


def legend(axes: Axes) -> None:
    """Explain colours and lines, where there is anything to say: below the figure, if it is ours.

    Parameters
    ----------
    axes : Axes
        One panel of a figure, or axes that were given.
    """
    if isinstance(figure_of(axes), Drawing):
        _below_figure(axes)
    else:
        _below_panel(axes)


def finish(axes: Axes) -> Figure:
    """Explain the curves of a panel below it, where nothing is covered; return its figure."""
    figure = figure_of(axes)
    if len(figure.axes) == 1:
        entries = len(axes.get_legend_handles_labels()[1])
        figure.set_figheight(figure.get_figheight() + _ENTRY * entries)
        _below_figure(axes)
    else:
        _below_panel(axes)
    return figure


def _below_figure(axes: Axes) -> None:
    handles, labels = axes.get_legend_handles_labels()
    if not labels:
        return
    shown = figure_of(axes).legend(handles, labels, loc="outside lower left", markerscale=1.5)
    for handle in shown.legend_handles:
        if isinstance(handle, Line2D) and handle.get_linestyle() == "None":
            handle.set(markersize=6, alpha=1)  # a point as small as in the figure has no colour


def _below_panel(axes: Axes) -> None:
    labels = axes.get_legend_handles_labels()[1]
    if not labels:
        return
    columns = len(labels) if len("".join(labels)) < _SHORT else 1
    below_label = axes.transAxes + ScaledTranslation(0, -0.5, figure_of(axes).dpi_scale_trans)
    place = {"bbox_to_anchor": (0, 0), "bbox_transform": below_label}
    axes.legend(loc="upper left", borderaxespad=0, ncols=columns, **place)


def heading(axes: Axes, text: str) -> None:
    """Write above a figure what it is about, or above its panel in a figure that is not ours."""
    if isinstance(figure := figure_of(axes), Drawing):
        figure.suptitle(text, x=0.01, ha="left", fontsize=8)
    else:
        axes.set_title(f"{text}\n{axes.get_title(loc='left')}".strip(), loc="left")


def above(axes: Axes, text: str) -> None:
    """Write the label of the vertical axis above it, where low panels have room for long words."""
    axes.set_ylabel(text, rotation=0, ha="left", va="bottom")
    axes.yaxis.set_label_coords(0.0, 1.03)
    # The layout thinks of a label as thin; a title of as many empty lines keeps its place.
    axes.set_title(" " + "\n " * text.count("\n"), loc="left")


def legend_above(axes: Axes) -> None:
    """Explain the curves of a low panel above it."""
    axes.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), borderaxespad=0.0)


def are_many(points: int) -> bool:
    """Whether so many points, each drawn by itself, make a file too large: then draw pixels."""
    return points > _MANY
