"""A sheet to draw a machine on: springs, walls, arrows, dimensions and a list of symbols."""

import re
from collections.abc import Iterable, Sequence
from io import StringIO

import matplotlib as mpl
import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure
from matplotlib.patches import Circle, FancyArrowPatch, FancyBboxPatch, Polygon

Point = Sequence[float]

INK, PALE, BODY, MOVES, WEARS = "#1b1f24", "#7a8490", "#d5dbe2", "#1f6fb4", "#c4501b"
CARD = "#f4f5f7"
_DARK = {
    INK: "#e6e9ed",
    PALE: "#98a2ad",
    BODY: "#3a434e",
    MOVES: "#6cb2ee",
    WEARS: "#f08a4b",
    CARD: "#1b1f25",
}
"""Colour on a light page -> on a dark one."""

_STYLE = {
    "font.family": "STIXGeneral",
    "mathtext.fontset": "stix",
    "font.size": 11,
    "svg.fonttype": "path",
    "svg.hashsalt": "vibrolife",
}
styled = mpl.rc_context(_STYLE)

WIDTH = 530
LIST = 306  # where symbols are listed
STEP = 17  # between them
NARROW = 296
"""Width of a card for phones [points]: the machine ends there, and the symbols stand below it."""


class Sheet:
    """A card of `WIDTH` times `height` points; places are in points from its lower left corner."""

    @styled
    def __init__(self, height: float) -> None:
        self._figure = Figure(figsize=(WIDTH / 72, height / 72), facecolor="none")
        self._axes: Axes = self._figure.add_axes((0, 0, 1, 1), xlim=(0, WIDTH), ylim=(0, height))
        self._axes.axis("off")
        self.height, self._listed = height, 0
        card = FancyBboxPatch(
            (0, 0), WIDTH, height, boxstyle="round,pad=0,rounding_size=6", fc=CARD, ec="none"
        )
        self._axes.add_patch(card)

    @styled
    def svg(self) -> str:
        """Return the sheet as SVG that follows the colours of the page."""
        text = StringIO()
        FigureCanvasSVG(self._figure).print_svg(text, metadata={"Date": None, "Creator": None})
        dark = "\n".join(
            f'[style*="{kind}: {light}"] {{ {kind}: {colour} !important }}'
            for light, colour in _DARK.items()
            for kind in ("fill", "stroke")
        )
        style = f"<style>@media (prefers-color-scheme: dark) {{\n{dark}\n}}</style>\n <defs>"
        whole = re.sub(r"<defs>", style, text.getvalue(), count=1)
        return re.sub(r" *\n(?=[LQCz])", " ", whole)  # one line for each path

    def narrow(self) -> str:
        """Return the same for phones: the drawing twice, cut to the machine and to the list."""
        head, whole, figure = self.svg().partition('<g id="figure_1">')
        below = STEP * (self._listed + 1)
        above = (self.height - below) / 2
        size = f'width="{NARROW}" height'
        end = figure.rindex("</svg>")
        tall = self.height + below
        root = f'width="{NARROW}pt" height="{tall}pt" viewBox="0 0 {NARROW} {tall}"'
        card = f'<rect {size}="{tall}" rx="6" style="fill: {CARD}"/>'
        machine = f'<svg {size}="{self.height}">\n {whole}{figure[:end]}</svg>\n'
        cut = f'viewBox="{LIST - 12} {above} {NARROW} {below}"'
        listed = (
            f'<svg y="{self.height}" {size}="{below}" {cut}><use xlink:href="#figure_1"/></svg>'
        )
        head = re.sub(r'width="\S+" height="\S+" viewBox="[^"]+"', root, head, count=1)
        return f"{head}{card}\n{machine}{listed}\n</svg>\n"

    def line(
        self, *points: Point, colour: str = INK, width: float = 1.1, dashes: str = "-"
    ) -> None:
        """Draw a line through points."""
        xs, ys = zip(*points, strict=True)
        self._axes.plot(xs, ys, color=colour, lw=width, ls=dashes, solid_capstyle="round")

    def area(self, *points: Point, fill: str = BODY, edge: str = INK, width: float = 1.1) -> None:
        """Fill a polygon."""
        self._axes.add_patch(Polygon(points, fc=fill, ec=edge, lw=width, joinstyle="round"))

    def box(self, left: float, low: float, right: float, high: float, fill: str = BODY) -> None:
        """Fill a rectangle."""
        self.area((left, low), (right, low), (right, high), (left, high), fill=fill)

    def disc(self, centre: Point, radius: float, fill: str = CARD, edge: str = INK) -> None:
        """Fill a circle."""
        self._axes.add_patch(Circle((centre[0], centre[1]), radius, fc=fill, ec=edge, lw=1.1))

    def arc(
        self,
        centre: Point,
        radius: float,
        start: float,
        end: float,
        *,
        colour: str = INK,
        arrow: bool = False,
    ) -> None:
        """Draw an arc between two angles [degrees], with an arrow at its end if asked for."""
        turn = np.radians(np.linspace(start, end, 41))
        x, y = centre
        points = list(zip(x + radius * np.cos(turn), y + radius * np.sin(turn), strict=True))
        self.line(*points, colour=colour, width=0.9)
        if arrow:
            self.arrow(points[-2], points[-1], colour=colour)

    def arrow(
        self,
        start: Point,
        end: Point,
        *,
        colour: str = MOVES,
        both: bool = False,
        width: float = 1.2,
    ) -> None:
        """Draw an arrow."""
        style = "<|-|>" if both else "-|>"
        patch = FancyArrowPatch(
            tuple(start),
            tuple(end),
            arrowstyle=f"{style},head_length=4,head_width=1.8",
            lw=width,
            color=colour,
            shrinkA=0,
            shrinkB=0,
        )
        self._axes.add_patch(patch)

    def dimension(self, start: Point, end: Point, symbol: str, at: Point) -> None:
        """Draw a length with an arrow at both ends, and its symbol."""
        self.arrow(start, end, colour=PALE, both=True, width=0.7)
        self.text(at, symbol)

    def spring(self, start: Point, end: Point, *, turns: int = 5, wide: float = 5.0) -> None:
        """Draw a spring between two points."""
        along = np.array([0, 0.15, *(0.15 + 0.7 * (np.arange(2 * turns) + 0.5) / (2 * turns))])
        along = np.append(along, [0.85, 1.0])
        aside = np.zeros_like(along)
        aside[2:-2] = wide * (-1.0) ** np.arange(2 * turns)
        a, b = np.asarray(start, float), np.asarray(end, float)
        across = np.array([a[1] - b[1], b[0] - a[0]]) / np.hypot(*(b - a))
        self.line(*(a + np.outer(along, b - a) + np.outer(aside, across)))

    def wall(self, start: Point, end: Point, behind: Point) -> None:
        """Draw the edge of what does not move, hatched on one side (a direction)."""
        a, b, back = (np.asarray(one, float) for one in (start, end, behind))
        self.line(a, b, width=1.4)
        count = max(int(np.hypot(*(b - a)) / 6), 1)
        along = (b - a) / count
        for i in range(count):
            foot = a + (i + 1) * along
            self.line(foot, foot + 5 * back - 0.8 * along, colour=PALE, width=0.8)

    @styled
    def text(
        self, at: Point, words: str, *, size: float = 11, align: str = "center", colour: str = INK
    ) -> None:
        """Write words, or a symbol between dollars, about a place."""
        self._axes.text(*at, words, ha=align, va="center", color=colour, size=size)

    def symbols(self, meanings: Iterable[tuple[str, str]]) -> None:
        """List symbols with their meanings, on the right."""
        lines = list(meanings)
        self._listed = len(lines)
        top = self.height / 2 + STEP * (len(lines) - 1) / 2
        for number, (symbol, meaning) in enumerate(lines):
            y = top - STEP * number
            self.text((LIST, y), symbol, align="left")
            self.text((LIST + 60, y), meaning, size=10, align="left")
