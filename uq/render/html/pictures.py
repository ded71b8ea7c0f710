"""Figures of a page: embedded SVG, or an image if the SVG would be too large."""

import base64
import re
from collections.abc import Container, Iterator, Sequence
from functools import lru_cache
from io import BytesIO, StringIO
from typing import Any, NamedTuple
from xml.etree import ElementTree

import matplotlib as mpl
from markupsafe import Markup
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from uq.assess.findings import Findings
from uq.plots import FIGURES
from uq.render.figures.catalogue import drawables
from uq.render.figures.figure import LIMIT, WIDTH, lay_out, styled, ticks_placed_once
from uq.render.html.indices import output_of
from uq.text.literals import plain
from uq.text.units import readable

STEP = 0.01
"""Rounding step of coordinates [px], far below visible differences."""

_LINES = re.compile(r"(?:\s*(?:[ML]\s+\S+\s+\S+|z))+\s*")


def shortened(path: str) -> str:
    """Return the path of an SVG element in relative steps: a staircase as ``h`` and ``v``.

    Parameters
    ----------
    path : str
        As matplotlib writes it: ``M 1.0 2.0 L 3.0 2.0``.

    Returns
    -------
    str
        The same path; a path with curves is returned as it is.
    """
    if not _LINES.fullmatch(path):
        return path
    parts, words = [], iter(path.split())
    here = start = (0, 0)
    for word in words:
        if word == "z":
            parts.append("z")
            here = start
            continue
        x, y = (round(float(next(words)) / STEP) for _ in range(2))
        if word == "M":
            start = here = x, y
            parts.append(f"M{_beside(x, y)}")
            continue
        (right, down), here = (x - here[0], y - here[1]), (x, y)
        if down == 0:
            parts.append(f"h{_text(right)}")
        elif right == 0:
            parts.append(f"v{_text(down)}")
        else:
            parts.append(f"l{_beside(right, down)}")
    return "".join(parts)


@lru_cache(2**12)  # most steps of a curve are short
def _text(steps: int) -> str:
    """Return a number of steps in px: ``.17``, ``-.17``, ``12``."""
    return re.sub(r"^(-?)0(?=\.)", r"\1", f"{steps * STEP:.2f}".rstrip("0").rstrip(".")) or "0"


def _beside(x: int, y: int) -> str:
    first, second = _text(x), _text(y)
    return first + ("" if second.startswith("-") else " ") + second


HEAVIEST_SVG = 300_000
"""Maximum length of an SVG, not counting its images [characters]; others become images."""

_IMAGE = re.compile(r"data:image[^\"]*")
_DOTS_PER_INCH = 144  # resolution of an image

_INK = {
    "#000000": "currentColor",
    "fill: #ffffff": "fill: none",
    LIMIT.lower(): "var(--limit)",
}


def _in_ink(style: str) -> str:
    """Return a style with the page's colours of text and limits, and no white background."""
    for colour, shown in _INK.items():
        style = style.replace(colour, shown)
    return style


_ATTRIBUTES = {"d": shortened, "style": _in_ink}
"""Attribute name -> conversion of its value."""

_NO_METADATA = dict.fromkeys(("Date", "Creator", "Format", "Type"))


class Picture(NamedTuple):
    """Figure as HTML, with its caption, column span and subject."""

    html: Markup
    caption: str
    is_image: bool
    is_wide: bool = False
    subject: str = ""

    @property
    def output(self) -> str:
        """Output shown in the figure."""
        return output_of(self.subject)


def pictures(findings: Findings, section: str, without: Container[str] = ()) -> Iterator[Picture]:
    """Yield the figures of one section of the report.

    Parameters
    ----------
    findings : Findings
    section : str
        As in `uq.render.figures.catalogue.Entry`.
    without : container of str
        Outputs whose figures are left out.
    """
    for drawable in drawables(FIGURES, findings, section):
        if drawable.subject.name not in without:
            figure = drawable.draw()
            assert isinstance(figure, Figure)  # a page takes its tables from elsewhere
            drawn = picture(figure, readable(drawable.caption), drawable.file)
            yield drawn._replace(subject=drawable.subject.name)


def about(drawn: Sequence[Picture], name: str) -> list[Picture]:
    """Return the figures of an output, including its targets and events."""
    return [figure for figure in drawn if name in (figure.subject, figure.output)]


@styled
def picture(figure: Figure, caption: str, name: str = "") -> Picture:
    """Return a figure as part of a page.

    Parameters
    ----------
    figure : Figure
    caption : str
        Text alternative of the figure.
    name : str, optional
        Unique within a page; by default the caption.

    Returns
    -------
    Picture
        SVG with text as text, in the colour of the page's text; PNG if the SVG would be longer than
        `HEAVIEST_SVG`.
    """
    drawn, png = StringIO(), BytesIO()
    lay_out(figure)
    wide = figure.get_figwidth() > WIDTH
    # Identifiers must be unique within a page.
    settings: Any = {"svg.fonttype": "none", "svg.hashsalt": name or caption}
    with mpl.rc_context(settings), ticks_placed_once():
        FigureCanvasSVG(figure).print_svg(drawn, metadata=_NO_METADATA)
    svg = _embedded(drawn.getvalue(), caption)
    if len(_IMAGE.sub("", svg)) <= HEAVIEST_SVG:
        return Picture(svg, caption, False, wide)
    figure.set_dpi(_DOTS_PER_INCH)
    FigureCanvasAgg(figure).print_png(png, metadata={"Software": None})
    data = base64.b64encode(png.getvalue()).decode()
    image = Markup('<img alt="{}" src="data:image/png;base64,{}">').format(caption, data)
    return Picture(image, caption, True, wide)


def _embedded(svg: str, caption: str) -> Markup:
    """Return an SVG document as an HTML element without name spaces and global styles."""
    root = ElementTree.fromstring(plain(svg))
    used = set(re.findall(r'(?:href="|url\()#([^")]+)', svg))
    for element in root.iter():
        element.tag = element.tag.rpartition("}")[2]
        for name in list(element.attrib):
            value = element.attrib.pop(name)
            if name != "id" or value in used:
                element.set(name.rpartition("}")[2], _ATTRIBUTES.get(name, str)(value))
    for definitions in root.findall("defs"):
        for style in definitions.findall("style"):
            definitions.remove(style)
    for name in ("version", "width", "height"):
        root.attrib.pop(name, None)
    root.set("role", "img")
    root.set("aria-label", plain(caption))
    return Markup(ElementTree.tostring(root, encoding="unicode"))
