"""One panel of a figure: made or given, its words, its legend."""

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.transforms import ScaledTranslation

from uq.figure import legend, new_figure

_MANY = 4000


def panel_of(axes: Axes | None, height: float) -> Axes:
    """Return the panel given, or that of a new figure one column wide and `height` [inch] high."""
    if axes is not None:
        return axes
    _, (axes,) = new_figure(height)
    return axes


def finish(axes: Axes, full: bool = False) -> Figure:
    """Explain the curves of a panel; return its figure.

    Parameters
    ----------
    axes : Axes
    full : bool
        Whether a panel among others has no room for the words inside: then they go below it.

    Returns
    -------
    Figure
    """
    figure = axes.get_figure(root=True)
    assert figure is not None
    count = len(axes.get_legend_handles_labels()[1])
    if len(figure.axes) == 1 and count:
        figure.set_figheight(figure.get_figheight() + 0.15 * count)
        legend(axes)
    elif count and full:
        below_label = ScaledTranslation(0, -0.5, figure.dpi_scale_trans)
        place = axes.transAxes + below_label
        axes.legend(loc="upper left", bbox_to_anchor=(0, 0), bbox_transform=place, borderaxespad=0)
    elif count:
        axes.legend()
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
