"""A figure of a paper, drawn from our data, and how a page shows it."""

from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

from matplotlib.axes import Axes
from matplotlib.figure import Figure

from uq.render.figures.figure import WIDTH, styled
from uq.render.figures.panel import roomy
from uq.render.figures.words import typeset

DOCS = Path(__file__).parents[1]
FOLDER = "papers"


class Shown(NamedTuple):
    """One figure or table.

    Attributes
    ----------
    title : str
    name : str
        Of the file, without its ending.
    drawn : Figure or str
        A table in Markdown, if it is a text.
    parameters : str
        How it was made.
    comparison : str
        What the paper has, and how far this agrees with it.
    """

    title: str
    name: str
    drawn: Figure | str
    parameters: str
    comparison: str


@styled
def sheet(rows: int, columns: int, height: float) -> tuple[Figure, list[Axes]]:
    """Return a figure of so many panels, each a column wide and `height` [inch] high."""
    figure = Figure(figsize=(WIDTH * columns, height * rows), layout="constrained")
    panels = list(figure.subplots(rows, columns, squeeze=False).ravel())
    for axes in panels:
        roomy(axes)
    return figure, panels


@styled
def name_panels(panels: Iterable[Axes], names: Iterable[str]) -> None:
    """Write above each panel what it shows."""
    for letter, axes, name in zip("abcdefgh", panels, names, strict=False):
        axes.set_title(f"({letter}) {typeset(name)}", loc="left")


def table(head: Iterable[str], rows: Iterable[Iterable[str]]) -> str:
    """Return a table in Markdown."""
    head = list(head)
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join(f"| {' | '.join(cells)} |" for cells in lines)
