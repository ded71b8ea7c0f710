"""Dask workers, local or on a cluster, and the chunks of rows that they compute.

The chunks of a killed worker are computed by another. A chunk that kills local workers `TRIES`
times, or cluster workers more often than dask's ``allowed-failures``, is bisected until the
crashing row is found, which is marked as crashed.
"""

import gc
import logging
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from itertools import islice
from typing import Any
from uuid import uuid4

from distributed import Client, Future, KilledWorker, as_completed
from distributed.utils import silence_logging_cmgr

from uq.contract import Status
from uq.errors import InputError, RunError, one_line
from uq.execution.dask_task import evaluate_in_job, evaluate_rows
from uq.execution.isolation import TRIES, spec_of
from uq.result.workload import Workload
from uq.study.evaluate import Chunk, RowFailure, lost_rows
from uq.study.provenance import versions
from uq.study.row_sampling import Rows

_COUNT_SECONDS = 1.0
_WAIT_SECONDS = 0.2

_Sent = tuple[int, Rows, int]
"""Number of the first row, the rows, and how often they have been sent."""

Returned = tuple[int, Rows, Chunk, float]
"""Number of the first row, the rows, their outputs, and their cost [s], 0 if unknown."""


class Workers:
    """Connected or expected workers, with their current and pending chunks.

    Parameters
    ----------
    client : distributed.Client
    workload : Workload
        With the model and settings of all rows.
    row_limit : float or None
        Time limit of a row [s].
    watch : callable
        Called regularly with the number of threads, and whether a chunk has arrived since the last
        call; raises a `RunError` when no workers are to be expected.
    run : str
        Whose processes compute, as in `uq.execution.dask_task.evaluate_rows`; "" on an existing
        cluster.
    keep_up : callable, optional
        Of workers that are jobs, each for one chunk: called regularly with the number of chunks
        that have not returned, and submits jobs for them.
    death : str
        What a row says whose workers died too often.

    Attributes
    ----------
    given_up : int
        Rows whose workers died too often.
    """

    def __init__(
        self,
        client: Client,
        workload: Workload,
        row_limit: float | None = None,
        watch: Callable[[int, bool], None] = lambda *_: None,
        run: str = "",
        keep_up: Callable[[int], object] | None = None,
        death: str = "killed every worker that computed it",
    ) -> None:
        self.given_up = 0
        self._keep_up, self._death = keep_up, death
        self._client = client
        self._workload = workload
        self._spec = spec_of(workload)
        self._row_limit = row_limit
        self._watch = watch
        self._run = run
        self._threads, self._counted = 0, 0.0
        self._under_way: dict[Future, _Sent] = {}
        self._unsent: list[_Sent] = []  # the scheduler was out of reach
        self._arrivals = as_completed(loop=client.loop, with_results=True, raise_errors=False)

    def __len__(self) -> int:
        """Return the number of chunks that have not returned."""
        return len(self._under_way) + len(self._unsent)

    @property
    def dashboard(self) -> str:
        """Address of the dashboard of an existing cluster, or ""."""
        if self._run or self._keep_up:  # nothing is behind the address that dask reports
            return ""
        try:
            return str(self._client.dashboard_link or "")
        except (KeyError, OSError):  # no dashboard, or the scheduler has just gone
            return ""

    @property
    def threads(self) -> int:
        """Tasks that can run at the same time: none until a worker connects.

        They are counted at most once a second, once there are any: the scheduler lists all workers.
        """
        if not self._is_connected():
            return 0
        if not self._threads or time.monotonic() > self._counted + _COUNT_SECONDS:
            try:
                self._threads = sum(self._client.nthreads().values())
            except OSError:  # the scheduler has just gone
                return 0
            self._counted = time.monotonic()
        return self._threads

    def _is_connected(self) -> bool:
        return bool(self._client.status == "running")

    def begun(self, threads: int) -> list[int]:
        """Return the sizes of the chunks that `threads` threads have started; others are queued."""
        return [len(rows.x) for _, rows, _ in islice(self._under_way.values(), threads)]

    def send(self, start: int, rows: Rows, tries: int = 1) -> None:
        """Submit rows for computation."""
        how = self._spec, versions(), self._row_limit
        data = rows.x, rows.seed, start, self._run
        if self._keep_up:
            from dask._task_spec import Task

            # A producer of data waits for a worker that is free, never behind other rows.
            key = f"{evaluate_in_job.__name__}-{uuid4()}"
            task = Task(key, evaluate_in_job, *how, *data, _data_producer=True)
            future = self._client.get({key: task}, key, sync=False)
        else:
            future = self._client.submit(evaluate_rows, *how, *data, pure=False)
        self._under_way[future] = start, rows, tries
        self._arrivals.add(future)

    def returned(self) -> list[Returned]:
        """Return completed chunks, after a short wait if there are none.

        Raises
        ------
        InputError
            When the workers or the model cannot be used.
        RunError
            When rows cannot be computed.
        """
        condition = self._arrivals.thread_condition
        with condition:
            if not self._arrivals.has_ready():
                condition.wait(_WAIT_SECONDS)
        back: list[Returned] = []
        for future, result in self._arrivals.next_batch(block=False):
            sent = self._under_way.pop(future)
            if future.status == "finished":
                back.append((*sent[:2], *result))
            elif future.status == "error":
                back += self._failed(sent, result[1])
            else:
                self._unsent.append(sent)
        self._watch(self.threads, bool(back))
        if self._keep_up:
            self._keep_up(len(self))
        if self._unsent and self._is_connected():
            again, self._unsent = self._unsent, []
            for sent in again:
                self.send(*sent)
        return back

    def _failed(self, sent: _Sent, error: Any) -> list[Returned]:
        """Send rows again that did not return, in halves if they killed their workers."""
        start, rows, tries = sent
        count = len(rows.x)
        if isinstance(error, InputError):
            raise error
        if isinstance(error, KilledWorker):
            if count == 1:
                fault = RowFailure(Status.CRASHED, self._death)
                self.given_up += 1
                lost = lost_rows(self._workload.model, self._workload.settings, 1, fault, start)
                return [(start, rows, lost, 0.0)]
            half = count // 2
            self.send(start, rows.part(0, half))
            self.send(start + half, rows.part(half, count))
        elif tries < TRIES:
            self.send(start, rows, tries + 1)
        else:
            reason = one_line(error.__cause__ or error)
            raise RunError(
                f"no worker could compute rows {start} to {start + count - 1}: "
                f"{type(error).__name__}: {reason}"
            )
        return []


@contextmanager
def quiet() -> Iterator[None]:
    """Keep the log of dask off the terminal: workers that come and go do not matter to the user."""
    log = logging.getLogger("asyncio")
    level = log.level
    log.setLevel(logging.CRITICAL)
    try:
        with ExitStack() as stack:
            for logger in ("distributed", "distributed.client", "distributed.gc"):
                stack.enter_context(silence_logging_cmgr(logging.CRITICAL, logger))
            yield
    finally:
        gc.collect()  # after an interruption: objects never awaited complain when collected
        log.setLevel(level)
