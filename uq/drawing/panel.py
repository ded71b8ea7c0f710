"""One panel of a figure: made or given, its words, its legend."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from uq.drawing.figure import legend, new_figure

_MANY = 4000
_SHORT = 30  # characters that fit beside each other


def panel_of(axes: Axes | None, height: float) -> Axes:
    """Return the panel given, or that of a new figure one column wide and `height` [inch] high."""
    if axes is not None:
        return axes
    _, (axes,) = new_figure(height)
    return axes


def finish(axes: Axes) -> Figure:
    """Explain the curves of a panel below it, where nothing is covered; return its figure.

    Parameters
    ----------
    axes : Axes

    Returns
    -------
    Figure
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    texts = axes.get_legend_handles_labels()[1]
    count = len(texts)
    if len(figure.axes) == 1 and count:
        figure.set_figheight(figure.get_figheight() + 0.15 * count)
        legend(axes)
    elif count:
        columns = count if len("".join(texts)) < _SHORT else 1
        below_label = axes.transAxes + ScaledTranslation(0, -0.5, figure.dpi_scale_trans)
        place = {"bbox_to_anchor": (0, 0), "bbox_transform": below_label}
        axes.legend(loc="upper left", borderaxespad=0, ncols=columns, **place)
    return figure


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
