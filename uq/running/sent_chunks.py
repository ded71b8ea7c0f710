"""Chunks sent to dask workers: what comes back, and what is sent again.

The chunks of a killed worker are computed by another. A chunk that kills its worker three times is
halved until the guilty row is found, which is marked as crashed.
"""

from typing import TYPE_CHECKING, Any, NamedTuple

from uq.contract import Status
from uq.errors import InputError, RunError
from uq.provenance import versions
from uq.rows.evaluate import Chunk, Fault, lost_rows
from uq.rows.sampling import Rows
from uq.rows.workload import Workload
from uq.running.dask_task import evaluate_rows
from uq.running.isolation import spec_of

if TYPE_CHECKING:
    from distributed import Future

    from uq.running.workers import Workers

_TRIES = 3
_WAIT_SECONDS = 0.2


class _Sent(NamedTuple):
    start: int
    rows: Rows
    tries: int = 1


class Returned(NamedTuple):
    """Rows that are back.

    Attributes
    ----------
    start : int
        Number of the first of them.
    rows : Rows
    chunk : Chunk
        What became of them.
    seconds : float
        What computing them took, 0 if unknown.
    """

    start: int
    rows: Rows
    chunk: Chunk
    seconds: float


class SentChunks:
    """Chunks that workers have, or are about to have.

    Parameters
    ----------
    workload : Workload
    crew : Workers
    row_limit : float or None
        Longest time for one row [s].
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

    def send(self, start: int, rows: Rows) -> None:
        """Have some rows computed."""
        self._send(_Sent(start, rows))

    def returned(self) -> list[Returned]:
        """Return what is back, after a short wait if there is nothing.

        Raises
        ------
        InputError
            When the workers or the model are not usable.
        RunError
            When there is no hope of getting rows back.
        """
        condition = self._arrivals.thread_condition
        with condition:
            if not self._arrivals.has_ready():
                condition.wait(_WAIT_SECONDS)
        back = []
        for future, result in self._arrivals.next_batch(block=False):
            sent = self._under_way.pop(future)
            if future.status == "finished":
                chunk, seconds = result
                back.append(Returned(sent.start, sent.rows, chunk, seconds))
            elif future.status == "error":
                back += self._failed(sent, result[1])
            else:
                self._unsent.append(sent)
        self._crew.watch(progress=bool(back))
        if self._unsent and self._crew.connected:
            again, self._unsent = self._unsent, []
            for sent in again:
                self._send(sent)
        return back

    def _send(self, sent: _Sent) -> None:
        future = self._crew.client.submit(
            evaluate_rows,
            self._spec,
            versions(),
            self._row_limit,
            sent.rows.x,
            sent.rows.seed,
            sent.start,
            pure=False,
        )
        self._under_way[future] = sent
        self._arrivals.add(future)

    def _failed(self, sent: _Sent, error: Any) -> list[Returned]:
        """Send rows again that did not come back, in halves if they killed their workers."""
        from distributed import KilledWorker

        start, rows, tries = sent
        count = len(rows.x)
        if isinstance(error, InputError):
            raise error
        if isinstance(error, KilledWorker):
            if count == 1:
                fault = Fault(Status.CRASHED, "killed every worker that computed it")
                lost = lost_rows(self._workload.model, self._workload.settings, 1, fault, start)
                return [Returned(start, rows, lost, 0.0)]
            half = count // 2
            self.send(start, rows.part(0, half))
            self.send(start + half, rows.part(half, count))
        elif tries < _TRIES:
            self._send(sent._replace(tries=tries + 1))
        else:
            reason = " ".join(str(error.__cause__ or error).split())
            raise RunError(
                f"no worker could compute rows {start} to {start + count - 1}: "
                f"{type(error).__name__}: {reason}"
            )
        return []
