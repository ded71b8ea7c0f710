"""Labels beside the lines that they name, and the note on an assumed scale."""

import textwrap
from dataclasses import dataclass
from functools import partial

import numpy as np
from matplotlib.axes import Axes
from matplotlib.transforms import ScaledTranslation

from uq.assess.answer.quantities import assumed_scales
from uq.assess.answer.wording import called_together
from uq.render.figures.figure import LIMIT, Drawing
from uq.render.figures.panel import figure_of
from uq.result.elements import Element, Floats
from uq.result.result import Result

_SIZE = 7.0  # font size [points]
_LETTER = 0.55 * _SIZE  # typical width of a letter [points]
_LINE = 9.0  # distance of two lines of labels [points]
_PANEL = 0.72  # width of a panel relative to its figure
_WRAPPED = 42  # characters of a line of a note
_APART = 0.03  # least distance of curves that can be told apart, relative to the panel
_ENOUGH = 0.25  # room for a label of a curve, relative to the panel
_TITLE = 6.0  # distance of a title above the frame [points]


@dataclass(frozen=True)
class LineLabel:
    """The label of a vertical line.

    Attributes
    ----------
    at : float
        Position of the line, in data coordinates.
    text, colour : str
    """

    at: float
    text: str
    colour: str


def label_lines(axes: Axes, labels: list[LineLabel]) -> None:
    """Label vertical lines above the frame, each where it hides no other label.

    Parameters
    ----------
    axes : Axes
        Axes with final limits and, if any, its title.
    labels : list of LineLabel
        Those of lines outside the frame are left out.
    """
    figure = figure_of(axes)
    width = 72 * figure.get_figwidth() * (_PANEL if isinstance(figure, Drawing) else 0.4)
    to_axes = axes.transData + axes.transAxes.inverted()
    taken: list[list[tuple[float, float]]] = []
    for label in sorted(labels, key=lambda each: each.at):
        x = to_axes.transform((label.at, axes.get_ylim()[0]))[0]
        if not -0.001 <= x <= 1.001:
            continue
        half = min(len(label.text) * _LETTER / width / 2, 0.5)
        middle = float(np.clip(x, half - 0.05, 1.05 - half)) if half < 0.5 else 0.5
        ends = (middle - half - 0.01, middle + half + 0.01)
        level = next(
            (i for i, row in enumerate(taken) if all(_apart(ends, other) for other in row)),
            len(taken),
        )
        if level == len(taken):
            taken.append([])
        taken[level].append(ends)
        up = ScaledTranslation(0, (2 + _LINE * level) / 72, figure.dpi_scale_trans)
        axes.text(
            middle,
            1.0,
            label.text,
            transform=axes.transAxes + up,
            ha="center",
            va="bottom",
            size=_SIZE,
            color=label.colour,
        )
    _taller(axes, _LINE * len(taken))
    if taken and (title := axes.get_title(loc="left")):
        axes.set_title(title, loc="left", pad=_TITLE + _LINE * len(taken))


def _apart(ends: tuple[float, float], other: tuple[float, float]) -> bool:
    return ends[1] <= other[0] or other[1] <= ends[0]


def label_two_curves(
    axes: Axes,
    curves: list[tuple[Floats, Floats]],
    texts: list[str],
    colours: list[str],
    lines: list[float],
) -> bool:
    """Label two rising curves on their outer sides, and return whether both labels fit.

    Each label is at the height at which it is farthest from vertical lines on its side.

    Parameters
    ----------
    axes : Axes
    curves : list of tuple of ndarray
        Abscissae and ordinates from 0 to 1.
    texts, colours : list of str
    lines : list of float
        Abscissae of vertical lines.
    """
    if len(curves) != 2 or max(map(len, texts)) > 16 or not all(len(x) > 1 for x, _ in curves):
        return False
    if any(y.max() < 0.84 for _, y in curves):  # the labels are at heights up to this
        return False
    middles = [float(np.interp(0.5, y, x)) for x, y in curves]
    to_axes = axes.transData + axes.transAxes.inverted()
    low, high = (to_axes.transform((x, 0))[0] for x in sorted(middles))
    if high - low < _APART:
        return False
    first = int(np.argmin(middles))
    places = {first: ((0.72, 0.6, 0.84), "right", -4), 1 - first: ((0.28, 0.4, 0.08), "left", 4)}
    for i, (heights, side, shift) in places.items():
        x, y = curves[i]
        points = [(float(np.interp(height, y, x)), height) for height in heights]
        axes.annotate(
            texts[i],
            max(points, key=partial(_room, axes, shift, lines)),
            xytext=(shift, 0),
            textcoords="offset points",
            ha=side,
            va="center",
            size=_SIZE,
            color=colours[i],
            bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.5},
        )
    return True


def _room(axes: Axes, towards: int, lines: list[float], point: tuple[float, float]) -> float:
    """Return the distance to the next vertical line on one side, relative to the panel.

    Distances at which a label fits count as equal.
    """
    to_axes = axes.transData + axes.transAxes.inverted()
    at, *others = (to_axes.transform((x, 0))[0] for x in (point[0], *lines))
    return min([_ENOUGH, *(abs(x - at) for x in others if (x - at) * towards > 0)])


def note_assumed_scale(axes: Axes, result: Result, element: Element) -> None:
    """State below a figure of a life that its scale is assumed, if it is."""
    names = assumed_scales(result, element)
    if not names:
        return
    text = textwrap.fill(f"not a prediction: {called_together(names)} assumed", _WRAPPED)
    axes.annotate(
        text,
        (0.5, 0),
        xycoords=axes.xaxis.label,
        xytext=(0, -2),
        textcoords="offset points",
        ha="center",
        va="top",
        size=_SIZE,
        color=LIMIT,
    )
    _taller(axes, _LINE * (1 + text.count("\n")))


def _taller(axes: Axes, points: float) -> None:
    """Make room in a new figure."""
    figure = figure_of(axes)
    if isinstance(figure, Drawing):
        figure.set_figheight(figure.get_figheight() + points / 72)
