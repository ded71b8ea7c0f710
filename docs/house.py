"""The picture of the house, drawn from its layers and from what the source imports.

``python docs/house.py`` writes docs/pictures/house.svg; a test refuses one that is out of date.
"""

import ast
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from textwrap import wrap

from layers import (
    HOUSE,
    LAYERS,
    MACHINES,
    READERS,
    RUNNERS,
    edges,
    imports_between_packages,
    reading_order,
)

PICTURE = HOUSE / "docs/pictures/house.svg"

WIDTH, UQ, LEFT, LANE, GAP = 820, 490, 205, 18, 8
PITCH, TALL = 60, 46  # of a layer [px]
STOREY, LOW = 33, 27  # of a storey [px]
MARGIN = 12
WIDE = 6.5  # of a letter of the small print, whatever the font [px]

STYLE = """
text { font-family: system-ui, "Segoe UI", "Helvetica Neue", Arial, sans-serif; text-anchor: middle;
  fill: #1b1f24; font-size: 10.5px }
.name { font-size: 13px; font-weight: 600 }
.card { fill: #f4f5f7 } .box { fill: #ffffff; stroke: #b9c0c9 }
.reader { fill: #e3eefb } .runner { fill: #fdeed6 } .machine { fill: #e2f2e2 }
.words { text-anchor: start; font-size: 11.5px }
.arrow { stroke: #6b7480; stroke-width: 1.3; marker-end: url(#head) } #head path { fill: #6b7480 }
@media (prefers-color-scheme: dark) {
  text { fill: #e6e9ed } .card { fill: #1b1f25 } .box { fill: #2b313a; stroke: #515b67 }
  .reader { fill: #1d3857 } .runner { fill: #4c3814 } .machine { fill: #1f4226 }
  .arrow { stroke: #98a2ad } #head path { fill: #98a2ad }
}
"""


LEGEND = (
    ("reader", "reads results; imports no runner"),
    ("runner", "runs models"),
    ("machine", "a machine, storey upon storey"),
)
"""Kind of box -> what it means."""


@dataclass(frozen=True)
class Box:
    """A rectangle [px] with a name, and a line or two of small print."""

    left: float
    right: float
    top: float
    height: float
    name: str
    print: tuple[str, ...] = ()
    kind: str = ""

    @property
    def bottom(self) -> float:
        """Its lower edge."""
        return self.top + self.height

    def svg(self) -> Iterator[str]:
        """Yield the rectangle and its text."""
        yield (
            f'<rect class="box {self.kind}" x="{self.left:g}" y="{self.top:g}" rx="4"'
            f' width="{self.right - self.left:g}" height="{self.height:g}"/>'
        )
        names = [("name", 15.0, self.name)] if self.name else []
        lines = [*names, *(("print", 12.0, line) for line in self.print)]
        base = self.top + (self.height - sum(size for _, size, _ in lines)) / 2
        for kind, size, line in lines:
            base += size
            middle = (self.left + self.right) / 2
            yield f'<text class="{kind}" x="{middle:g}" y="{base - 3:g}">{line}</text>'


def picture() -> str:
    """Return the picture as SVG."""
    packages, machines = dict(_packages()), dict(_machines())
    height = PITCH * len(LAYERS) + 2 * MARGIN - (PITCH - TALL)
    body = [
        f'<rect class="card" width="{WIDTH}" height="{height}" rx="8"/>',
        *(_arrow(packages, upper, lower) for upper, lower in _reduced()),
        *(_arrow(machines, machine, "numerics") for machine in _sharing()),
        *(line for box in (*packages.values(), *machines.values()) for line in box.svg()),
        *_legend(),
    ]
    head = '<path d="M0,0 L8,4 L0,8 z"/>'
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {WIDTH} {height}"'
            f' width="{WIDTH}" height="{height}">',
            f"<style>{STYLE}</style>",
            '<defs><marker id="head" markerWidth="8" markerHeight="8" refX="7" refY="4"'
            f' orient="auto" markerUnits="userSpaceOnUse">{head}</marker></defs>',
            *body,
            "</svg>\n",
        ]
    )


def _packages() -> Iterator[tuple[str, Box]]:
    """Yield the boxes of the packages of ``uq``: readers to the left, runners to the right."""
    for number, names in enumerate(LAYERS):
        top = MARGIN + PITCH * (len(LAYERS) - 1 - number)
        readers = [name for name in names if name in READERS]
        runners = [name for name in names if name in RUNNERS]
        others = [name for name in names if name not in (*READERS, *RUNNERS)]
        end = UQ if number else WIDTH - 2 * MARGIN  # what machines import, too
        spans = {
            **_shared(readers, 0, LEFT),
            **_shared(others, LEFT + GAP / 2 if readers else 0, end),
            **_shared(runners, LEFT + LANE, UQ),
        }
        for name, (left, right) in spans.items():
            kind = "reader" if name in readers else "runner" if name in runners else ""
            about = wrap(_about(f"uq/{name}"), int((right - left) / WIDE))
            box = Box(MARGIN + left, MARGIN + right, top, TALL, name, tuple(about), kind)
            yield name, box


def _shared(names: list[str], left: float, right: float) -> dict[str, tuple[float, float]]:
    """Return name -> its part of a width."""
    width = (right - left + GAP) / max(len(names), 1)
    starts = [left + i * width for i in range(len(names))]
    return {name: (a, a + width - GAP) for name, a in zip(names, starts, strict=True)}


def _about(package: str) -> str:
    """Return the beginning of what a package says it is."""
    path = HOUSE / package
    path = path / "__init__.py" if path.is_dir() else path.with_suffix(".py")
    said = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return re.split("[:;,.]", said.replace("``", ""))[0]


def _machines() -> Iterator[tuple[str, Box]]:
    """Yield the boxes of the machines, storey upon storey, and what they share.

    The name of a machine is that of its lowest box; its sign stands on top.
    """
    left, right = 2 * MARGIN + UQ, WIDTH - MARGIN
    ground = MARGIN + PITCH * (len(LAYERS) - 2)
    about = wrap(_about("models/numerics"), 52)
    yield "numerics", Box(left, right, ground, TALL, "numerics", tuple(about))
    for machine, (a, b) in _shared([*MACHINES], left, right).items():
        top = ground - (PITCH - TALL) - LOW
        for number, name in enumerate(reading_order(f"models/{machine}")):
            box = Box(a, b, top, LOW, "", (name,))
            yield f"{machine} {number}" if number else machine, box
            top -= STOREY
        yield f"{machine} sign", Box(a, b, top, LOW, machine, kind="machine")


def _reduced() -> list[tuple[str, str]]:
    """Return which package imports which, without what follows from the rest.

    Left out: the contract and text, which everything imports.
    """
    found: dict[str, set[str]] = {}
    for _, _, here, there in imports_between_packages():
        if there not in ("contract", "text"):
            found.setdefault(here, set()).add(there)

    def below(name: str) -> set[str]:
        direct = found.get(name, set())
        return direct.union(*map(below, direct))

    return [
        (here, there)
        for here in sorted(found)
        for there in sorted(found[here])
        if not any(there in below(other) for other in found[here])
    ]


def _sharing() -> Iterator[str]:
    """Yield the machines that import what machines share."""
    for machine in MACHINES:
        names = set().union(*edges(f"models/{machine}").values())
        if any(name.startswith("models.numerics") for name in names):
            yield machine


def _arrow(boxes: dict[str, Box], upper: str, lower: str) -> str:
    """Return an arrow straight down, where no box stands in its way; slanted to a box beside."""
    a, b = boxes[upper], boxes[lower]
    if b.top - a.bottom == PITCH - TALL and min(a.right, b.right) < max(a.left, b.left):
        ends = (a.left + GAP, b.right - GAP) if b.right < a.left else (a.right - GAP, b.left + GAP)
        return _line(upper, lower, ends, (a.bottom, b.top))
    between = [box for box in boxes.values() if a.bottom <= box.top and box.bottom <= b.top]
    free = _free(max(a.left, b.left), min(a.right, b.right), between)
    assert free, f"{upper} imports {lower}: no way for an arrow"
    x = sum(max(free, key=lambda ends: ends[1] - ends[0])) / 2
    return _line(upper, lower, (x, x), (a.bottom, b.top))


def _line(upper: str, lower: str, x: tuple[float, float], y: tuple[float, float]) -> str:
    ends = f'x1="{x[0]:g}" x2="{x[1]:g}" y1="{y[0]:g}" y2="{y[1] - 1:g}"'
    return f'<line class="arrow" {ends}><title>{upper} imports {lower}</title></line>'


def _free(left: float, right: float, boxes: Iterable[Box]) -> list[tuple[float, float]]:
    """Return the parts of a width in which no box stands."""
    found = [(left, right)] if left < right else []
    for box in boxes:
        found = [
            part
            for a, b in found
            for part in ((a, min(b, box.left)), (max(a, box.right), b))
            if part[0] < part[1]
        ]
    return found


def _legend() -> Iterator[str]:
    """Yield what the colours mean."""
    left = 2 * MARGIN + UQ
    for number, (kind, words) in enumerate(LEGEND):
        y = MARGIN + 20 * number
        yield f'<rect class="box {kind}" x="{left}" y="{y}" rx="2" width="12" height="12"/>'
        yield f'<text class="words" x="{left + 18}" y="{y + 10}">{words}</text>'


if __name__ == "__main__":
    PICTURE.write_text(picture(), encoding="utf-8")
