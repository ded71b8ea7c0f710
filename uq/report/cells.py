"""Tables of a report, in plain data that the template lays out."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from uq import wording


class Cell(NamedTuple):
    """One cell.

    Attributes
    ----------
    text : str
    more : str
        In small print below: an interval, a meaning.
    key : float or None
        The number to sort by; a cell without one is text.
    """

    text: str
    more: str = ""
    key: float | None = None


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


def count(rows: int) -> Cell:
    """Return the cell of a number of rows; nothing for none."""
    return Cell(f"{rows}" if rows else "", key=float(rows))


def estimate(entry: Mapping[str, Any], per: float = 1.0, key: str = "value") -> Cell:
    """Return the cell of an estimate, its interval below.

    Parameters
    ----------
    entry : dict
        ``value``, ``low``, ``high``, as in what `uq.analysis.statistics.summarise` returns.
    per : float
        Length of the unit that the cell is in.
    key : str
        Instead of ``value``.

    Returns
    -------
    Cell
    """
    text = wording.known(entry, key, per)
    ends = wording.interval(entry, per).replace(" to ", " to\u00a0")  # breaks in two, not three
    if worst := wording.failed_interval(entry, per) if key == "value" else "":
        ends += f"{'; ' * bool(ends)}with failed rows {worst}"
    last = float("inf") if text in ("never", "beyond the horizon") else None
    return Cell(text, ends, last if entry[key] is None else entry[key])


def without_empty_columns(table: Table) -> Table:
    """Return a table less the columns, after the first, in which nothing is said."""
    kept = [
        i
        for i in range(len(table.header))
        if i == 0 or any(row[i].text not in ("", "-") for row in table.rows)
    ]
    rows = [tuple(row[i] for i in kept) for row in table.rows]
    return table._replace(header=tuple(table.header[i] for i in kept), rows=rows)
