"""Figures of a page: embedded SVG, or an image if the SVG would be too large."""

import base64
import re
from collections.abc import Container, Iterator, Sequence
from io import BytesIO, StringIO
from typing import NamedTuple
from xml.etree import ElementTree

import matplotlib as mpl
from markupsafe import Markup
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.backends.backend_svg import FigureCanvasSVG
from matplotlib.figure import Figure

from uq.assess.findings import Findings
from uq.plots import FIGURES
from uq.render.figures.catalogue import drawables
from uq.render.figures.figure import lay_out
from uq.render.figures.style import WIDTH, styled
from uq.render.html.indices import output_of
from uq.render.html.paths import shortened
from uq.text.literals import plain
from uq.text.symbols import readable

HEAVIEST_SVG = 300_000
"""Longer drawings, without the images in them, are embedded as images [characters]."""

_IMAGE = re.compile(r"data:image[^\"]*")
_DOTS_PER_INCH = 144  # of an image

_INK = {"#000000": "currentColor", "fill: #ffffff": "fill: none"}


def _in_ink(style: str) -> str:
    """Return a style with the colour of the page's text for black, and no white ground."""
    for colour, shown in _INK.items():
        style = style.replace(colour, shown)
    return style


_ATTRIBUTES = {"d": shortened, "style": _in_ink}
"""Name -> what an attribute becomes."""

_NO_METADATA = dict.fromkeys(("Date", "Creator", "Format", "Type"))


class Picture(NamedTuple):
    """A figure as HTML, what it shows, whether it spans both columns, and its subject."""

    html: Markup
    caption: str
    is_image: bool
    is_wide: bool = False
    subject: str = ""

    @property
    def output(self) -> str:
        """The output that it is about."""
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
            drawn = picture(drawable.draw(), readable(drawable.caption), drawable.file)
            yield drawn._replace(subject=drawable.subject.name)


def about(drawn: Sequence[Picture], name: str) -> list[Picture]:
    """Return the figures of an output, and of its targets and events."""
    return [figure for figure in drawn if name in (figure.subject, figure.output)]


@styled
def picture(figure: Figure, caption: str, name: str = "") -> Picture:
    """Return a figure as part of a page.

    Parameters
    ----------
    figure : Figure
    caption : str
        Its text alternative.
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
    with mpl.rc_context({"svg.fonttype": "none", "svg.hashsalt": name or caption}):
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
