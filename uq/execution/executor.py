"""Rows of one run: taken in order in chunks, computed here or on workers, and kept."""

import time
from collections import deque
from contextlib import ExitStack
from functools import cached_property
from math import ceil
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.execution.child import ModelSpec
from uq.execution.isolation import Action, Children, Evaluate, spec_of
from uq.execution.options import DEFAULTS, Progress, RunOptions
from uq.execution.tally import MemoryStore, row_bytes
from uq.files.interrupts import in_background, undone
from uq.machines.compilation import compilation
from uq.machines.row_by_row import RowByRow
from uq.result.workload import Workload
from uq.study.evaluate import Chunk, KernelError, evaluate
from uq.study.row_sampling import Rows

if TYPE_CHECKING:
    from uq.execution.workers import Workers
    from uq.machines.queue_table import QueueTable


CHUNK_SECONDS = 0.5
"""Work in a chunk, unless the number of rows is given or there are many workers."""

# A chunk costs scheduler and driver some 5 ms each, so those of many workers must be longer.
_CHUNKS_PER_SECOND = 50

# Longest chunk that is a whole block of the kernel: half a block may take as long.
_BLOCK_SECONDS = 5.0
GROWTH = 4
"""Growth factor of successive chunks until they reach the target size."""

_FIRST_ROWS = 16
_SENT_CHUNKS = 4  # at least, also while workers start
_SENT_PER_THREAD = 2  # one under way, the next at hand
_LONG_SECONDS = 1.0  # of a chunk, which is reported before it has come back
_SENT_BYTES = 2_000_000_000  # inputs of all chunks sent: the scheduler keeps them, too
_LAST_SHARE = 1 / 8  # of a chunk: smaller chunks at the end would waste work
_LIMIT_SHARE = 0.25  # of the time limit of a row, for a whole chunk
_CHUNK_BYTES = 4_000_000  # dask warns of tasks that carry more than 10 MB
_ENOUGH_ROWS = 32  # to blame the model rather than the rows


def first_chunk(workload: Workload, options: RunOptions = DEFAULTS) -> int:
    """Return the rows of the first chunk, before the cost of a row is known."""
    few = min(_FIRST_ROWS, workload.model.block)  # a row alone may take minutes
    return _whole_groups(workload, options.chunk_rows or few)


def good_chunk(
    workload: Workload, options: RunOptions = DEFAULTS, row_seconds: float = 0.0, threads: int = 1
) -> int:
    """Return the chunk size in rows, a multiple of the groups of the design.

    Parameters
    ----------
    workload : Workload
    options : RunOptions, optional
    row_seconds : float
        Cost of a row [s], 0 if unknown.
    threads : int, optional
        Number of chunks computed concurrently.
    """
    limit, wish = options.row_limit, options.chunk_rows
    inputs = 8 * len(workload.model.parameter_names)
    sent = _SENT_BYTES // (_SENT_PER_THREAD * threads * inputs)
    most = max(1, min(_CHUNK_BYTES // row_bytes(workload), sent))
    if limit and row_seconds:  # chunks of sound rows must not be stopped
        most = max(1, min(most, int(_LIMIT_SHARE * limit / row_seconds)))
    if wish:
        most = min(wish, most) if limit else wish
    elif row_seconds:
        block = min(workload.model.block, ceil(_BLOCK_SECONDS / row_seconds))
        seconds = max(CHUNK_SECONDS, threads / _CHUNKS_PER_SECOND)
        most = min(most, block * max(1, round(seconds / (row_seconds * block))))
    return _whole_groups(workload, most)


def _whole_groups(workload: Workload, rows: int) -> int:
    """Round a number of rows up to whole groups of the design."""
    return workload.group * ceil(rows / workload.group)


class Dispatcher:
    """Dispatch the rows of a workload in order, and collect them.

    Parameters
    ----------
    workload : Workload
    options : RunOptions
    store : MemoryStore
        Keeps the rows; missing rows are computed.
    evaluate : callable
        Computes rows on this computer.
    stop : int, optional
        Number after the last row that is wanted; by default all are.

    Attributes
    ----------
    store : MemoryStore
        The rows that have arrived.
    rows, left : int
        Rows to be computed, and those of them that have not arrived.
    row_seconds : float
        Cost of a row [s], by the latest rows; 0 if unknown.
    """

    def __init__(
        self,
        workload: Workload,
        options: RunOptions,
        store: MemoryStore,
        evaluate: Evaluate,
        stop: int | None = None,
    ) -> None:
        self.workload = workload
        self.store = store
        self._options = options
        self._evaluate = evaluate
        stop = store.total if stop is None else stop
        self._todo = deque((a, min(b, stop)) for a, b in store.missing if a < stop)
        self.rows = sum(b - a for a, b in self._todo)
        self._untaken = self.left = self.rows
        self.row_seconds = 0.0
        self._dashboard = ""
        self._under_way = 0

    def begin_here(self, share: float) -> None:
        """Run the first rows here, in growing chunks, until a chunk takes long enough.

        The first call may compile, so only later ones show the cost of a row. At most about `share`
        of all rows to be computed run here.
        """
        size = first_chunk(self.workload, self._options)
        least_left = (1 - share) * self._untaken
        self._here(size)
        spent = 0.0
        while spent < CHUNK_SECONDS and self._untaken > least_left:
            size = min(GROWTH * size, self._good_chunk())
            spent += self._here(size)

    def finish_here(self) -> None:
        """Run the remaining rows without workers."""
        while self.left:
            self._here(self._good_chunk())

    def finish_on(self, crew: "Workers", jobs: int = 0, size: int = 0) -> None:
        """Run the remaining rows on workers, or in a number of jobs with chunks of a size."""
        self._dashboard = crew.dashboard
        while self.left:
            threads = crew.threads
            sharing = max(1, threads, jobs)
            # Only as many chunks are sent as keep the workers busy.
            while self._untaken and len(crew) < max(_SENT_CHUNKS, _SENT_PER_THREAD * sharing):
                crew.send(*self._take(size or self._shared(sharing)))
            before, self._under_way = self._under_way, self._at_once(crew.begun(threads))
            if self._under_way and not before:
                self.report_progress()  # the first row may take minutes
            for start, rows, chunk, seconds in crew.returned():
                if seconds:  # unknown for a row that was given up
                    self.row_seconds = seconds / len(rows.x)
                self._keep(start, rows, chunk)
            self.store.keep_up()

    def _here(self, size: int) -> float:
        """Run the next rows on this computer; return the time it took [s]."""
        if not self._untaken:
            return 0.0
        start, rows = self._take(size)
        self._under_way = self._at_once([len(rows.x)])
        if not self.row_seconds or self.row_seconds * len(rows.x) > _LONG_SECONDS:
            self.report_progress()
        began = time.perf_counter()
        chunk = self._evaluate(rows.x, rows.seed, start)
        seconds = time.perf_counter() - began
        self._under_way = 0
        self.row_seconds = seconds / len(rows.x)
        self._keep(start, rows, chunk)
        return seconds

    def _at_once(self, chunks: list[int]) -> int:
        """Return the rows computed at this moment in chunks of these sizes."""
        alone = isinstance(self.workload.model.batch, RowByRow)  # one after the other
        return len(chunks) if alone else sum(chunks)

    def _take(self, size: int) -> tuple[int, Rows]:
        start, end = self._todo.popleft()
        stop = min(start + size, end)
        if stop < end:
            self._todo.appendleft((stop, end))
        self._untaken -= stop - start
        return start, self.workload.block(start, stop)

    def _keep(self, start: int, rows: Rows, chunk: Chunk) -> None:
        self.store.preview.add(chunk)
        self.store.add(start, rows, chunk)
        self.left -= len(rows.x)
        self.report_progress()  # at once: an interrupt reports how many rows are kept
        wrong = self.store.shapes_all_wrong
        if wrong and self.store.done >= min(_ENOUGH_ROWS, self.store.total):
            raise KernelError(f"model '{self.workload.model.name}': every row is wrong: {wrong}")
        self.store.keep_up()

    def report_progress(self) -> None:
        """Report the progress of the run."""
        store = self.store
        seen = store.preview.median, store.preview.shares
        counts = store.done, store.total, store.failed, store.reused, dict(store.status)
        self._options.progress(
            Progress(*counts, *seen, self._dashboard, under_way=min(self._under_way, self.left))
        )

    def _shared(self, threads: int) -> int:
        """Return the rows of the next chunk, so that all threads finish together."""
        size = first_chunk(self.workload, self._options)
        if self.row_seconds:
            size = self._good_chunk(threads)
        least = int(_LAST_SHARE * size)
        share = max(ceil(self._untaken / threads), least)
        if self._untaken - share < least:  # too few for another chunk
            share = self._untaken
        return min(size, _whole_groups(self.workload, share))

    def _good_chunk(self, threads: int = 1) -> int:
        return good_chunk(self.workload, self._options, self.row_seconds, threads)


SHORT_SECONDS = 4.0
"""Shorter work is not worth starting workers."""

_SHARE_HERE = 1 / 64  # of the rows, to measure their cost before workers start


def in_one_process(workers: int | None, seconds: float) -> bool:
    """Return whether work of a given duration [s] is done in one process without workers."""
    return workers == 0 or (workers is None and seconds < SHORT_SECONDS)


def processes(workload: Workload, workers: int | None) -> int:
    """Return the number of concurrent processes, if starting workers pays off."""
    from dask.system import CPU_COUNT  # within affinity and container limits

    return min(1 if workers == 0 else workers or CPU_COUNT, workload.total // workload.group)


def first_rows_alone(workload: Workload, workers: int | None) -> bool:
    """Return whether one process computes the first rows, before workers share the others.

    That process measures the cost of a row and compiles the model. External models need neither.
    """
    return not workers or not isinstance(workload.model.batch, RowByRow)


class Executor:
    """Computes the rows of one dispatcher after another; a context manager.

    Workers start when they are first needed, and stay for the next dispatcher.

    Parameters
    ----------
    workload : Workload
        With the model and settings of all dispatchers.
    options : RunOptions
    compiling : callable
        Called when compilation of the model starts.

    Raises
    ------
    InputError
        When options exclude each other.
    """

    def __init__(
        self, workload: Workload, options: RunOptions, compiling: Action = lambda: None
    ) -> None:
        options.check()
        self._workload, self._options = workload, options
        self._compiling = compiling
        self._children = Children()
        self._crew: Workers | None = None
        self._stack = ExitStack()
        self._seconds = 0.0

    def __enter__(self) -> Self:
        if self._options.workers == 0:
            self._stack.enter_context(compilation(self._compiling))
        else:
            self._stack.enter_context(undone(self._children.close))
            if not self._queue:
                self._begin(1)
        return self

    def __exit__(self, *exception: object) -> None:
        self._stack.close()
        if isinstance(self._workload.model.batch, RowByRow):
            self._workload.model.batch.leave()  # after the processes that were stopped

    def evaluate(self, x: Floats, seed: NDArray[np.uint64], start: int) -> Chunk:
        """Compute rows on this computer, in a separate process unless the user wants none."""
        if self._options.workers == 0:
            model, settings = self._workload.model, self._workload.settings
            return in_background(lambda: evaluate(model, settings, x, seed, start))
        with self._children.reserved(self._spec, self._options.row_limit) as child:
            return child.evaluate(x, seed, start)

    def finish(self, dispatcher: Dispatcher) -> None:
        """Have all rows of a dispatcher computed."""
        workers = self._options.workers
        if self._options.scheduler is not None:
            crew = self._started(dispatcher)  # before anything is computed
            dispatcher.begin_here(_SHARE_HERE)
            dispatcher.finish_on(crew)
            return
        if queue := self._queue:  # no row here: others use the computer that submits, too
            if dispatcher.left:
                crew = self._started(dispatcher)
                dispatcher.finish_on(crew, workers or queue.jobs, queue.rows_per_job)
            return
        begun = not workers and self._crew is None
        if begun:
            dispatcher.begin_here(share=1)
        # Counting earlier dispatchers, is the work worth starting workers?
        seconds = self._seconds + dispatcher.row_seconds * dispatcher.left
        if self._crew is None and in_one_process(workers, seconds):
            dispatcher.finish_here()
        elif dispatcher.left:
            crew = self._started(dispatcher)
            if not begun and first_rows_alone(self._workload, workers):
                dispatcher.begin_here(_SHARE_HERE)
            dispatcher.finish_on(crew)
        self._seconds += dispatcher.row_seconds * dispatcher.rows

    def _started(self, dispatcher: Dispatcher) -> "Workers":
        if self._crew is None:
            how = self._workload, self._options.row_limit
            if self._options.scheduler is not None:
                from uq.execution.clusters import remote_workers

                crew = remote_workers(self._options.scheduler, *how)
            elif self._queue:
                from uq.execution.queues import queued_workers

                jobs = self._options.workers or self._queue.jobs
                crew = queued_workers(self._queue, jobs, *how, self._options.say)
            else:
                count = processes(dispatcher.workload, self._options.workers)
                self._begin(count)  # they import while dask does
                from uq.execution.clusters import local_workers

                crew = local_workers(count, self._children, *how)
            self._crew = self._stack.enter_context(crew)
        return self._crew

    @property
    def _queue(self) -> "QueueTable | None":
        """The jobs that the model asks for, unless the user asks for other workers."""
        batch, options = self._workload.model.batch, self._options
        elsewhere = options.scheduler is not None or options.workers == 0
        return None if elsewhere or not isinstance(batch, RowByRow) else batch.queue

    @cached_property
    def _spec(self) -> ModelSpec:
        return spec_of(self._workload)

    def _begin(self, count: int) -> None:
        self._children.begin(count, self._spec, self._options.row_limit, self._compiling)
