"""Tables of a report, in plain data that the template lays out, with numbers as bars."""

from collections.abc import Mapping, Sequence
from itertools import chain
from math import inf, isfinite, nan
from typing import NamedTuple

from markupsafe import Markup

from uq.assess.statistic import Statistic
from uq.assess.targets import FORMS, split_name
from uq.stats.estimate import Estimate, failed_bounds_text

STYLE = Markup("""
.bar { display: block; position: relative; height: .9rem; background: rgba(127, 127, 127, .15);
  -webkit-print-color-adjust: exact; print-color-adjust: exact; }
.bar > * { position: absolute; top: 0; bottom: 0; }
.bar-fill { background: #4a7ba6; }
.bar-ends { border: solid currentColor; border-width: 0 1px; }
.bar-ends::before { content: ""; position: absolute; left: 0; right: 0;
  top: calc(50% - .5px); border-top: 1px solid currentColor; }
""")
"""Bars have the same colour as in figures, which differs from the colours of regimes."""


def bar(value: float, low: float, high: float, scale: tuple[float, float]) -> Markup:
    """Return a bar from zero to a number, with its interval.

    Parameters
    ----------
    value, low, high : float
        NaN for an unknown end; values beyond the scale are clipped to its end.
    scale : tuple of float
        Numbers at both ends of the scale, with zero between them or at one end.

    Returns
    -------
    Markup
        "" if there is no number to show.
    """
    first, last = scale
    if not isfinite(value) or last <= first:
        return Markup()

    def place(number: float) -> float:
        return 100 * min(max((number - first) / (last - first), 0.0), 1.0)

    parts = [_part("fill", *sorted((place(0.0), place(value))))]
    if low == low and high == high:
        parts.append(_part("ends", place(low), place(high)))
    return Markup('<span class="bar" aria-hidden="true">{}</span>').format(Markup("").join(parts))


def _part(name: str, left: float, right: float) -> Markup:
    return Markup('<span class="bar-{}" style="left:{:.1f}%;width:{:.1f}%"></span>').format(
        name, left, right - left
    )


SHARE = "share"
"""Scale of shares, from 0 to 1."""


class Cell(NamedTuple):
    """Cell of a table.

    Attributes
    ----------
    text : str
    more : str
        Small print below: an interval or a meaning.
    key : float or None
        Number to sort by; None for text.
    traced : str
        Key of the number for ``uq trace``; "" if it has none.
    scale : str
        Numbers of a table with equal `scale` have bars on a common scale; "" for no bar.
    ends : tuple of float
        Ends of the interval of the number; NaN if there is none.
    """

    text: str
    more: str = ""
    key: float | None = None
    traced: str = ""
    scale: str = ""
    ends: tuple[float, float] = (nan, nan)

    def bar(self, scales: Mapping[str, tuple[float, float]]) -> Markup:
        """Return the number as a bar on one of the scales of the table."""
        if self.key is None or not self.scale:
            return Markup()
        return bar(self.key, *self.ends, scales[self.scale])


class HtmlTable(NamedTuple):
    """Table; the first cell of each row is the name of the row.

    Attributes
    ----------
    caption : str
    header : tuple of str
    rows : sequence of tuple of Cell
    """

    caption: str
    header: tuple[str, ...]
    rows: Sequence[tuple[Cell, ...]]

    @property
    def scales(self) -> dict[str, tuple[float, float]]:
        """Ends of each scale, which includes zero and all numbers with their intervals."""
        scales_of_columns = {SHARE: (0.0, 1.0)}
        for entry in chain.from_iterable(self.rows):
            if entry.scale not in ("", SHARE):
                low, high = scales_of_columns.get(entry.scale, (0.0, 0.0))
                ends = [
                    end for end in (entry.key, *entry.ends) if end is not None and isfinite(end)
                ]
                scales_of_columns[entry.scale] = min(low, *ends, 0.0), max(high, *ends, 0.0)
        return scales_of_columns

    def has_numbers(self, column: int) -> bool:
        """Return whether a column contains numbers, or dashes for missing numbers."""
        return any(row[column].key is not None or row[column].text == "-" for row in self.rows)


def cell(statistic: Statistic, per: float = 1.0, scale: str = "") -> Cell:
    """Return the cell of a statistic, with its interval below.

    Parameters
    ----------
    statistic : Statistic
    per : float
        Size of the unit of the cell.
    scale : str, optional
        Scale of the bar.

    Returns
    -------
    Cell
    """
    estimate = statistic.estimate
    form = FORMS.get(split_name(statistic.of)[0])
    text = statistic.words(per) + (f", of the {form}" if form else "")
    worst = failed_bounds_text(statistic.failed, per)
    small = (
        statistic.interval(per).replace(" to ", " to\u00a0"),  # breaks in two, not three
        f"with invalid rows {worst}" if worst else "",
        statistic.more,
    )
    last = inf if estimate.value == inf and statistic.otherwise is None else None
    key = estimate.value if isfinite(estimate.value) else last
    ends = (estimate.low, estimate.high)
    return Cell(text, "; ".join(filter(None, small)), key, scale=scale, ends=ends)


def estimate_cell(
    text: str, more: str, estimate: Estimate, traced: str = "", scale: str = ""
) -> Cell:
    """Return the cell of an estimate as text; a finite estimate is its sort key."""
    key = estimate.value if isfinite(estimate.value) else None
    return Cell(text, more, key, traced, scale, (estimate.low, estimate.high))


def without_empty_columns(table: HtmlTable) -> HtmlTable:
    """Return a table without its empty columns; the first column stays."""
    first, *others = zip(table.header, *table.rows, strict=True)
    filled = (row for row in others if any(cell.text not in ("", "-") for cell in row[1:]))
    header, *rows = zip(first, *filled, strict=True)
    return table._replace(header=header, rows=rows)
