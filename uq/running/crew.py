"""What computes the chunks of a run, as the run sees it."""

from typing import Protocol

from uq.rows.evaluate import Chunk
from uq.rows.sampling import Rows

Returned = tuple[int, Rows, Chunk, float]
"""Number of the first row, the rows, their outputs, and what they cost [s], 0 if unknown."""


class Crew(Protocol):
    """Processes on this computer, or the workers of a cluster."""

    @property
    def threads(self) -> int:
        """Chunks that can be computed at the same time: 0 while nothing is there."""

    @property
    def room(self) -> int:
        """Chunks that it should have, to be kept busy."""

    @property
    def dashboard(self) -> str:
        """Address of its dashboard, or ""."""

    def __len__(self) -> int:
        """Return how many chunks it has."""

    def send(self, start: int, rows: Rows) -> None:
        """Have some rows computed, whose first has the number `start`."""

    def returned(self) -> list[Returned]:
        """Return what is back, after a short wait if there is nothing."""

    def expect(self, seconds: float) -> None:
        """Prepare for so much work [s of one process]."""
