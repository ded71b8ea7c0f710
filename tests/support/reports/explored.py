"""The part of a report that answers back: its numbers, and what a user does to it."""

import json
from pathlib import Path

import numpy as np

import uq.render.html
from uq.assess.answer.answer import conclude
from uq.assess.findings import Findings
from uq.render.html.embedded_rows import rows_inside
from uq.render.html.page import templates
from uq.result.result import Result

CELLS = """[...document.querySelectorAll("PLACE table.counted tr[data-key]")].map(line => [
  line.dataset.key,
  ...[...line.cells].slice(1).map(cell => [cell.querySelector("data")?.value ?? "NaN",
  cell.dataset.low ?? "NaN", cell.dataset.high ?? "NaN"])])"""
STYLE = (Path(uq.render.html.__file__).parent / "page.css").read_text()
PAGE = f"""<!DOCTYPE html><html lang=en><meta charset=utf-8>
<meta name=viewport content="width=device-width"><style>{STYLE}</style>"""


def explorer(ds):
    """Return a page with nothing else of a result."""
    findings = Findings(Result(ds))
    rows = rows_inside(findings, "a result.nc", conclude(findings).quantities)
    return PAGE + templates().get_template("explorer.html").render(rows_inside=rows)


def cells(browser, place="#explorer"):
    """Return the numbers of the table: key -> one (value, low, high) for each column."""
    browser.painted()
    numbers = browser.value(CELLS.replace("PLACE", place))
    return {key: [np.array(row, dtype=float) for row in row] for key, *row in numbers}


def ranges(browser):
    """Return the ends of each range."""
    ends = "one => [one.dataset.low, one.dataset.high]"
    ends_of_ranges = browser.value(
        f"[...document.querySelectorAll('.range:not([hidden])')].map({ends})"
    )
    return [tuple(map(float, pair)) for pair in ends_of_ranges]


def drag_handle(browser, name, end, steps):
    """Move a handle as its element does when it is dragged."""
    selector = f".range[data-name={json.dumps(name)}]"
    browser.value(
        f"(() => {{ const range = document.querySelector({json.dumps(selector)});"
        f" const handle = range.querySelectorAll('input')[{end}];"
        f" handle.value = {steps}; handle.dispatchEvent(new Event('input')) }})()"
    )
    browser.painted()


def place_of_a_point(browser):
    """Return a place of the page where a point is drawn, in the colour of rows."""
    return browser.value(
        "(() => { const c = document.querySelector('.scatter canvas');"
        " c.scrollIntoView({behavior: 'instant'});"
        " const box = c.getBoundingClientRect();"
        " const p = c.getContext('2d').getImageData(100, 20, c.width - 140, c.height - 60);"
        " for (let i = 0; i < p.data.length; i += 4) if (p.data[i] === 160 && p.data[i + 1] === 166"
        " && p.data[i + 2] === 173) return [box.left + 100.5 + (i / 4) % p.width,"
        " box.top + 20.5 + Math.floor(i / 4 / p.width)] })()"
    )


def open_by_keyboard(browser, key="Enter"):
    """Open the card of the row in the middle."""
    browser.value("document.querySelector('.scatter canvas').focus()")
    browser.press("ArrowRight", key)
    browser.painted()
