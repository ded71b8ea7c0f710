"""Text, numbers and tables on a terminal, and JSON."""

import json
import sys
from collections.abc import Iterable, Sequence
from math import isfinite
from textwrap import wrap
from typing import TYPE_CHECKING, Any

from rich.cells import cell_len
from rich.console import Console
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from uq.stats.estimate import Estimate, interval_text, value_text
from uq.text.literals import plain
from uq.text.numbers import duration as duration
from uq.text.numbers import number as number

if TYPE_CHECKING:
    from rich.console import JustifyMethod

    from uq.result.result import Result

CELLS = ("", "value", "95 % interval")
"""Header of a table of estimates."""


class _Terminal(Console):
    """A console that prints control characters as escapes."""

    def print(self, *objects: Any, **options: Any) -> None:
        super().print(
            *(plain(thing) if isinstance(thing, str) else thing for thing in objects), **options
        )


# Names such as work_rate[site=left] are not rich's markup.
console = _Terminal(markup=False, highlight=False, emoji=False)


def print_json(value: Any) -> None:
    """Print JSON, with null for a number that is not finite.

    Characters that standard output cannot encode are escaped, so that readers get them back.
    """
    text = plain(json.dumps(_finite(value), indent=2, allow_nan=False, ensure_ascii=False))
    try:
        text.encode(sys.stdout.encoding or "utf-8")
    except UnicodeEncodeError:
        text = json.dumps(_finite(value), indent=2, allow_nan=False)
    print(text)


def _finite(value: Any) -> Any:
    match value:
        case dict():
            return {key: _finite(item) for key, item in value.items()}
        case list() | tuple():
            return [_finite(item) for item in value]
        case float() if not isfinite(value):
            return None
    return value


def heading(text: str, more: str = "") -> None:
    """Print a bold heading, followed by an explanation: below it where the line is too short."""
    text, more = plain(text), plain(more)
    fits = cell_len(text.lstrip("\n")) + 2 + cell_len(more) <= console.width
    console.print(Text.assemble((text, "bold"), f"  {more}" if more and fits else ""))
    if more and not fits:
        paragraph(more, indent=2)


def title(result: "Result", more: str = "") -> None:
    """Print the title of a result, with its source and an explanation."""
    attrs = result.dataset.attrs
    heading(str(attrs["title"]), ", ".join(filter(None, (str(attrs["source"]), more))))


def cells(estimate: Estimate, per: float = 1.0) -> tuple[str, str]:
    """Return value and interval of an estimate, in a unit of size `per`."""
    return value_text(estimate, per=per), interval_text(estimate, per)


def paragraph(text: str, indent: int = 4) -> None:
    """Print text that stays indented where it wraps; a long path is not broken."""
    width = max(console.width - indent, 1)
    for line in plain(text).split("\n"):
        lines = wrap(line, width, break_long_words=False, break_on_hyphens=False) or [""]
        console.print(*(" " * indent + piece for piece in lines), sep="\n", soft_wrap=True)


def note(text: str) -> None:
    """Print a sentence about all that was printed before, after a blank line."""
    console.print()
    paragraph(text, indent=0)


def grid(rows: Iterable[Sequence[str]], header: Sequence[str] = (), indent: int = 2) -> None:
    """Print aligned columns without rules; an empty column is left out.

    Parameters
    ----------
    rows : iterable of sequence of str
        All of one length.
    header : sequence of str
    indent : int
    """
    columns = list(zip(*rows, strict=True))
    titles = header or [""] * len(columns)
    table = Table(box=None, show_header=bool(header), pad_edge=False, padding=(0, 2, 0, 0))
    kept = [i for i, column in enumerate(columns) if any(column)]
    room = console.width - indent - sum(2 + _longest_word(columns[i]) for i in kept[1:])
    natural = sum(2 + max(map(cell_len, (titles[i], *columns[i]))) for i in kept)
    for i in kept:
        numeric = all(map(_looks_numeric, columns[i]))
        justify: JustifyMethod = "right" if numeric else "left"
        widest = max(map(cell_len, columns[i]))
        names = i == kept[0] and len(kept) > 1 and widest <= room - 2
        tight = numeric and cell_len(titles[i]) > widest and indent + natural > console.width
        title = titles[i].replace(" ", "\n") if tight else titles[i]
        table.add_column(title, justify=justify, overflow="fold", no_wrap=numeric or names)
    for row in zip(*(columns[i] for i in kept), strict=True):
        table.add_row(*(Text(plain(cell)) for cell in row))
    console.print(Padding(table, (0, 0, 0, indent), expand=False))


def _longest_word(cells: Sequence[str]) -> int:
    """Return the width that a column needs to break between words only."""
    return max((cell_len(word) for cell in cells for word in cell.split()), default=0)


def _looks_numeric(cell: str) -> bool:
    try:
        float(cell.rstrip(" %"))
    except ValueError:
        return cell in ("", "-")
    return True
