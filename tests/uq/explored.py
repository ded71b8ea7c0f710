"""The part of a report that answers back, and its numbers."""

from pathlib import Path

import numpy as np

import uq.report
from uq.analysis.findings import Findings
from uq.report.embedded import rows_inside
from uq.report.layout import templates

CELLS = """[...document.querySelectorAll("PLACE table.found tr[data-key]")].map(line => [
  line.dataset.key,
  ...[...line.cells].slice(1).map(cell => [cell.querySelector("data")?.value ?? "NaN",
  cell.dataset.low ?? "NaN", cell.dataset.high ?? "NaN"])])"""
STYLE = (Path(uq.report.__file__).parent / "page.css").read_text()
PAGE = f"""<!DOCTYPE html><html lang=en><meta charset=utf-8>
<meta name=viewport content="width=device-width"><style>{STYLE}</style>"""


def explorer(ds):
    """Return a page with nothing else of a result."""
    rows = rows_inside(Findings(ds), "a result.nc")
    return PAGE + templates().get_template("explorer.html").render(rows_inside=rows)


def cells(browser, place="#explorer"):
    """Return the numbers of the table: key -> one (value, low, high) for each column."""
    browser.painted()
    numbers = browser.value(CELLS.replace("PLACE", place))
    return {key: [np.array(one, dtype=float) for one in found] for key, *found in numbers}
