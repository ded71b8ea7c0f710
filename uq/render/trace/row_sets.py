"""Rows of a result behind a number: runs of rows, block by block of the design."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.result.elements import flags
from uq.result.result import Result
from uq.text.numbers import counted


class Run(NamedTuple):
    """Rows at equal distances, in one block of the design."""

    block: str
    first: int
    last: int
    step: int
    rows: int

    @property
    def words(self) -> str:
        """The numbers of its rows."""
        if self.rows == 1:
            return f"{self.first}"
        by = f" by {self.step}" if self.step > 1 else ""
        return f"{self.first} to {self.last}{by}"


def runs_of(rows: Result) -> list[Run]:
    """Return the numbers of rows as runs, block by block."""
    numbers, blocks = rows.dataset["row"].values, rows.dataset["block"].values
    return [
        Run(label, *run)
        for code, label in flags(rows.dataset["block"])
        for run in _runs(np.sort(numbers[blocks == code]))
    ]


def _runs(numbers: NDArray[np.int64]) -> list[tuple[int, int, int, int]]:
    """Cut ascending numbers where their usual distance changes."""
    if len(numbers) == 0:
        return []
    steps = np.diff(numbers)
    usual = int(np.median(steps)) if len(steps) else 1
    parts = np.split(numbers, np.flatnonzero(steps != usual) + 1)
    return [(int(run[0]), int(run[-1]), usual, len(run)) for run in parts]


def in_words(runs: list[Run], most: int = 4) -> str:
    """Return runs in words: ``blocks A and B: 0 to 630 by 5, 4 to 634 by 5``."""
    blocks = list(dict.fromkeys(run.block for run in runs))
    shown = ", ".join(run.words for run in runs[:most])
    if len(runs) > most:
        shown += f" and {counted(len(runs) - most, 'more run')}"
    if blocks == ["sample"] or not blocks:
        return shown
    named = ", ".join(blocks[:most]) + (f" and {len(blocks) - most} more" if blocks[most:] else "")
    return f"block{'s' * (len(blocks) > 1)} {named}: {shown}"
