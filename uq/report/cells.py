"""Tables of a report, in plain data that the template lays out."""

from collections.abc import Sequence
from math import inf, isfinite
from typing import NamedTuple

from uq import wording
from uq.analysis.statistics.statistic import Statistic
from uq.indices.targets import FORMS, split_name


class Cell(NamedTuple):
    """One cell.

    Attributes
    ----------
    text : str
    more : str
        In small print below: an interval, a meaning.
    key : float or None
        The number to sort by; a cell without one is text.
    traced : str
        The key of its number for ``uq trace``; "" if it has none.
    """

    text: str
    more: str = ""
    key: float | None = None
    traced: str = ""


class Table(NamedTuple):
    """A table; the first cell of each row names it.

    Attributes
    ----------
    caption : str
    header : tuple of str
    rows : sequence of tuple of Cell
    """

    caption: str
    header: tuple[str, ...]
    rows: Sequence[tuple[Cell, ...]]

    def has_numbers(self, column: int) -> bool:
        """Whether a column is one of numbers, or of dashes in their place."""
        return any(row[column].key is not None or row[column].text == "-" for row in self.rows)


def cell(one: Statistic, per: float = 1.0) -> Cell:
    """Return the cell of a statistic, its interval below.

    Parameters
    ----------
    one : Statistic
    per : float
        Length of the unit that the cell is in.

    Returns
    -------
    Cell
    """
    estimate = one.estimate
    form = FORMS.get(split_name(one.of)[0])
    text = one.words(per) + (f", of the {form}" if form else "")
    worst = wording.failed_interval(one.failed, per)
    small = (
        wording.interval(estimate, per).replace(" to ", " to\u00a0"),  # breaks in two, not three
        f"with failed rows {worst}" if worst else "",
        one.more,
    )
    last = inf if estimate.value == inf and one.otherwise is None else None
    key = estimate.value if isfinite(estimate.value) else last
    return Cell(text, "; ".join(filter(None, small)), key)


def without_empty_columns(table: Table) -> Table:
    """Return a table without its empty columns; the first column stays."""
    first, *others = zip(table.header, *table.rows, strict=True)
    filled = (one for one in others if any(cell.text not in ("", "-") for cell in one[1:]))
    header, *rows = zip(first, *filled, strict=True)
    return table._replace(header=header, rows=rows)
