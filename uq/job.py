"""The rows of one run on their way: taken in order, computed here or on workers, kept.

Rows are cut into chunks of whole design groups, one kernel call each. How they are cut and who
computes them changes no bit of the result.
"""

import time
from collections import deque
from collections.abc import Callable
from dataclasses import asdict
from math import ceil
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, NamedTuple

from uq.errors import InputError, RunError
from uq.evaluate import Chunk, KernelError, evaluate
from uq.interrupts import in_background
from uq.sampling import Rows
from uq.store import DiskStore, MemoryStore, row_bytes
from uq.task import evaluate_rows
from uq.work import Work

if TYPE_CHECKING:
    from distributed import Future

    from uq.cluster import Workers

CHUNK_SECONDS = 0.5
"""Work in a chunk, unless the caller says how many rows."""

_BLOCK_SECONDS = 2.0  # longest chunk for the sake of a whole block of the kernel
_FIRST_ROWS = 16
_IN_FLIGHT = 4  # chunks at least, also while workers start
_GROWTH = 4  # of the chunks of the pilot
_CHUNK_BYTES = 4_000_000  # dask warns of tasks that carry more than 10 MB
_ENOUGH_ROWS = 32  # to blame the model and not the rows
_POLL_SECONDS = 0.2


class Progress(NamedTuple):
    """How far a run is.

    Attributes
    ----------
    done, total, failed : int
        Rows.
    found : int
        Rows among those done that were there from the start.
    """

    done: int
    total: int
    failed: int
    found: int = 0


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
    store : MemoryStore or DiskStore
        Where they are kept; what it lacks is computed.

    Attributes
    ----------
    store : MemoryStore or DiskStore
        The rows that have arrived.
    """

    def __init__(
        self,
        work: Work,
        chunk_rows: int | None,
        report: Report,
        store: MemoryStore | DiskStore,
    ) -> None:
        self.work = work
        self.report = report
        self.store = store
        self._wish = chunk_rows
        self._todo = deque(store.missing)
        self._untaken = store.total - store.done
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
        `share` of all rows that are to be computed is done here.
        """
        size = self._whole(self._wish or _FIRST_ROWS)
        least_left = (1 - share) * self._untaken
        self._here(size)
        spent = 0.0
        while spent < CHUNK_SECONDS and self._untaken > least_left:
            size = min(_GROWTH * size, self._chunk_rows())
            spent += self._here(size)

    def finish_here(self) -> None:
        """Run the other rows in this process."""
        while not self.complete:
            self._here(self._chunk_rows())

    def finish_on(self, crew: "Workers") -> None:
        """Run the other rows on workers, and here until the first of them is there."""
        arrived: SimpleQueue[Future] = SimpleQueue()
        flying: dict[Future, tuple[int, Rows]] = {}
        while not self.complete:
            # No more chunks in flight than keep the workers busy.
            while self._untaken and len(flying) < max(_IN_FLIGHT, 2 * crew.threads):
                # Towards the end smaller ones, so that all workers finish together.
                share = ceil(self._untaken / max(1, crew.threads))
                start, some = self._take(min(self._chunk_rows(), self._whole(share)))
                future = crew.client.submit(
                    evaluate_rows,
                    self.work.model_reference,
                    self.work.model.version,
                    asdict(self.work.settings),
                    some.x,
                    some.seed,
                    start,
                    pure=False,
                )
                flying[future] = start, some
                future.add_done_callback(arrived.put)
            if not crew.threads and self._untaken:
                self._here(self._chunk_rows())
            try:
                future = arrived.get(timeout=_POLL_SECONDS)
            except Empty:
                self.store.keep_up()
                crew.watch()
                continue
            start, some = flying.pop(future)
            chunk, seconds = _result(future, start, len(some.x))
            self._row_seconds = seconds / len(some.x)
            self._keep(start, some, chunk)

    def _here(self, size: int) -> float:
        """Run the next rows in this process; return the seconds it took."""
        if not self._untaken:
            return 0.0
        start, some = self._take(size)
        began = time.perf_counter()
        model, settings = self.work.model, self.work.settings
        chunk = in_background(lambda: evaluate(model, settings, some.x, some.seed, start))
        seconds = time.perf_counter() - began
        self._row_seconds = seconds / len(some.x)
        self._keep(start, some, chunk)
        return seconds

    def _take(self, size: int) -> tuple[int, Rows]:
        start, end = self._todo.popleft()
        stop = min(start + size, end)
        if stop < end:
            self._todo.appendleft((stop, end))
        self._untaken -= stop - start
        return start, self.work.block(start, stop)

    def _keep(self, start: int, some: Rows, chunk: Chunk) -> None:
        self.store.add(start, some, chunk)
        wrong = self.store.shapes_all_wrong
        if wrong and self.store.done >= min(_ENOUGH_ROWS, self.store.total):
            raise KernelError(f"model '{self.work.model.name}': every row is wrong: {wrong}")
        self.store.keep_up()
        self.tell()

    def tell(self) -> None:
        """Report how far the run is."""
        store = self.store
        self.report(Progress(store.done, store.total, store.failed, store.found))

    def _chunk_rows(self) -> int:
        if self._wish:
            return self._whole(self._wish)
        most = _CHUNK_BYTES // row_bytes(self.work)
        if not self._row_seconds:
            return self._whole(most)
        block = min(self.work.model.block, ceil(_BLOCK_SECONDS / self._row_seconds))
        blocks = CHUNK_SECONDS / (self._row_seconds * block)
        return self._whole(min(most, block * max(1, round(blocks))))

    def _whole(self, size: float) -> int:
        """Round up to whole groups of the design."""
        return self.work.group * ceil(size / self.work.group)


def _result(future: "Future", start: int, count: int) -> tuple[Chunk, float]:
    from distributed import KilledWorker

    rows = f"rows {start} to {start + count - 1}"
    try:
        result: tuple[Chunk, float] = future.result()
    except (InputError, RunError):
        raise
    except KilledWorker:
        raise RunError(f"{rows} killed the worker processes that computed them") from None
    except Exception as error:
        reason = " ".join(str(error.__cause__ or error).split())
        raise RunError(f"a worker could not compute {rows}: {reason}") from error
    return result
