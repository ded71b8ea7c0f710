"""Chunks sent to dask workers: what returns, and what is sent again.

The chunks of a killed worker are computed by another. A chunk that kills own workers `TRIES` times,
or those of a cluster more often than dask's ``allowed-failures``, is halved until the guilty row is
found, which is marked as crashed.
"""

from itertools import islice
from typing import TYPE_CHECKING, Any

from uq.contract import Status
from uq.errors import InputError, RunError, one_line
from uq.execution.dask_task import evaluate_rows
from uq.execution.isolation import TRIES, spec_of
from uq.result.workload import Workload
from uq.study.evaluate import Chunk, RowFailure, lost_rows
from uq.study.provenance import versions
from uq.study.row_sampling import Rows

if TYPE_CHECKING:
    from distributed import Future

    from uq.execution.workers import Workers

_WAIT_SECONDS = 0.2

_Sent = tuple[int, Rows, int]
"""Number of the first row, the rows, and how often they have been sent."""

Returned = tuple[int, Rows, Chunk, float]
"""Number of the first row, the rows, their outputs, and what they cost [s], 0 if unknown."""


class SentChunks:
    """Chunks that workers have, or are about to get.

    Parameters
    ----------
    workload : Workload
    crew : Workers
    row_limit : float or None
        Time limit of a row [s].
    """

    def __init__(self, workload: Workload, crew: "Workers", row_limit: float | None = None) -> None:
        from distributed import as_completed

        self._workload = workload
        self._spec = spec_of(workload)
        self._crew = crew
        self._row_limit = row_limit
        self._under_way: dict[Future, _Sent] = {}
        self._unsent: list[_Sent] = []  # the scheduler was out of reach
        self._arrivals = as_completed(loop=crew.client.loop, with_results=True, raise_errors=False)

    def __len__(self) -> int:
        return len(self._under_way) + len(self._unsent)

    def begun(self, threads: int) -> int:
        """Return how many rows so many threads have begun; the others wait for their turn."""
        return sum(len(rows.x) for _, rows, _ in islice(self._under_way.values(), threads))

    def send(self, start: int, rows: Rows, tries: int = 1) -> None:
        """Have some rows computed."""
        how = self._spec, versions(), self._row_limit
        data = rows.x, rows.seed, start, self._crew.run
        future = self._crew.client.submit(evaluate_rows, *how, *data, pure=False)
        self._under_way[future] = start, rows, tries
        self._arrivals.add(future)

    def returned(self) -> list[Returned]:
        """Return what is back, after a short wait if there is nothing.

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
        self._crew.watch(progress=bool(back))
        if self._unsent and self._crew.connected:
            again, self._unsent = self._unsent, []
            for sent in again:
                self.send(*sent)
        return back

    def _failed(self, sent: _Sent, error: Any) -> list[Returned]:
        """Send rows again that did not return, in halves if they killed their workers."""
        from distributed import KilledWorker

        start, rows, tries = sent
        count = len(rows.x)
        if isinstance(error, InputError):
            raise error
        if isinstance(error, KilledWorker):
            if count == 1:
                fault = RowFailure(Status.CRASHED, "killed every worker that computed it")
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
