"""The rows of one run on their way: taken in order, computed here or on workers, kept.

Rows are cut into chunks of whole design groups, one kernel call each. How they are cut and who
computes them changes no bit of the result.
"""

import time
from collections.abc import Callable
from math import ceil
from typing import TYPE_CHECKING, NamedTuple

from uq.evaluate import Chunk, KernelError
from uq.flight import Flight
from uq.isolation import Evaluate, task_of
from uq.sampling import Rows
from uq.store import Store, row_bytes
from uq.work import Work

if TYPE_CHECKING:
    from uq.cluster import Workers

CHUNK_SECONDS = 0.5
"""Work in a chunk, unless the caller says how many rows."""

_BLOCK_SECONDS = 2.0  # longest chunk for the sake of a whole block of the kernel
_FIRST_ROWS = 16
_IN_FLIGHT = 4  # chunks at least, also while workers start
_GROWTH = 4  # of the chunks of the pilot
_LIMIT_SHARE = 0.25  # of the time limit of a row, for a whole chunk
_CHUNK_BYTES = 4_000_000  # dask warns of tasks that carry more than 10 MB
_ENOUGH_ROWS = 32  # to blame the model and not the rows
_POLL_SECONDS = 0.2


class Progress(NamedTuple):
    """How far a run is.

    Attributes
    ----------
    done, total, failed : int
        Rows.
    """

    done: int
    total: int
    failed: int


Report = Callable[[Progress], object]


class Job:
    """Work under way; rows are taken in order.

    Parameters
    ----------
    work : Work
    chunk_rows : int or None
        Rows per chunk, if the caller has a wish.
    report : callable
        Called with a `Progress` whenever rows have arrived.
    evaluate : callable
        Computes rows on this computer.
    row_limit : float or None
        Longest time for one row [s].

    Attributes
    ----------
    store : Store
        The rows that have arrived.
    """

    def __init__(
        self,
        work: Work,
        chunk_rows: int | None,
        report: Report,
        evaluate: Evaluate,
        row_limit: float | None = None,
    ) -> None:
        self.work = work
        self.report = report
        self.store = Store(work)
        self._wish = chunk_rows
        self._evaluate = evaluate
        self._row_limit = row_limit
        self._next = 0
        self._row_seconds = 0.0

    @property
    def complete(self) -> bool:
        """Whether all rows have arrived."""
        return self.store.done == self.store.total

    @property
    def seconds_left(self) -> float:
        """Work that is left, by the cost of the latest rows computed here."""
        return self._row_seconds * (self.store.total - self.store.done)

    @property
    def groups(self) -> int:
        """Tasks into which the rows can be cut at most."""
        return self.store.total // self.work.group

    def pilot(self, share: float) -> None:
        """Run the first rows here, more and more of them, until a chunk takes a while.

        The first call may compile, so only later ones tell the cost of a row. No more than about
        `share` of all rows is done here.
        """
        size = self._whole(self._wish or _FIRST_ROWS)
        self._here(size)
        spent = 0.0
        while spent < CHUNK_SECONDS and self.store.done < share * self.store.total:
            size = min(_GROWTH * size, self._chunk_rows())
            spent += self._here(size)

    def finish_here(self) -> None:
        """Run the other rows without workers."""
        while not self.complete:
            self._here(self._chunk_rows())

    def finish_on(self, crew: "Workers") -> None:
        """Run the other rows on workers, and here while none of our own is there."""
        flight = Flight(self.work, task_of(self.work), crew, self._row_limit)
        while not self.complete:
            threads = crew.threads
            # No more chunks in flight than keep the workers busy.
            while self._next < self.store.total and len(flight) < max(_IN_FLIGHT, 2 * threads):
                # Towards the end smaller ones, so that all workers finish together.
                share = ceil((self.store.total - self._next) / max(1, threads))
                flight.send(*self._take(min(self._chunk_rows(), self._whole(share))))
            if crew.local and not threads and self._next < self.store.total:
                self._here(self._chunk_rows())
            for start, some, chunk, seconds in flight.landed():
                self._row_seconds = seconds / len(some.x)
                self._keep(start, some, chunk)

    def _here(self, size: int) -> float:
        """Run the next rows on this computer; return the seconds it took."""
        if self.complete:
            return 0.0
        start, some = self._take(size)
        began = time.perf_counter()
        chunk = self._evaluate(some.x, some.seed, start)
        seconds = time.perf_counter() - began
        self._row_seconds = seconds / len(some.x)
        self._keep(start, some, chunk)
        return seconds

    def _take(self, size: int) -> tuple[int, Rows]:
        start, stop = self._next, min(self._next + size, self.store.total)
        self._next = stop
        return start, self.work.block(start, stop)

    def _keep(self, start: int, some: Rows, chunk: Chunk) -> None:
        self.store.add(start, some, chunk)
        wrong = self.store.shapes_all_wrong
        if wrong and self.store.done >= min(_ENOUGH_ROWS, self.store.total):
            raise KernelError(f"model '{self.work.model.name}': every row is wrong: {wrong}")
        self.report(Progress(self.store.done, self.store.total, self.store.failed))

    def _chunk_rows(self) -> int:
        most = _CHUNK_BYTES // row_bytes(self.work)
        if self._row_limit and self._row_seconds:  # sound chunks are not to be stopped
            most = max(1, min(most, int(_LIMIT_SHARE * self._row_limit / self._row_seconds)))
        if self._wish:
            return self._whole(min(self._wish, most) if self._row_limit else self._wish)
        if not self._row_seconds:
            return self._whole(most)
        block = min(self.work.model.block, ceil(_BLOCK_SECONDS / self._row_seconds))
        blocks = CHUNK_SECONDS / (self._row_seconds * block)
        return self._whole(min(most, block * max(1, round(blocks))))

    def _whole(self, size: float) -> int:
        """Round up to whole groups of the design."""
        return self.work.group * ceil(size / self.work.group)
