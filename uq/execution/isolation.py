"""Rows computed in separate processes, in case they crash or hang.

Such rows are computed again in parts, down to single rows. Rows that crash or time out get a status
and a message; the others get the same values as in any other process.
"""

import signal
import subprocess
import threading
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import asdict
from math import ceil
from multiprocessing.connection import Connection
from typing import TYPE_CHECKING, Any, cast

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Status
from uq.errors import RunError
from uq.execution import child
from uq.execution.child import Action, ModelSpec
from uq.execution.environment import started
from uq.files.interrupts import undone
from uq.machines.row_by_row import RowByRow
from uq.machines.row_resources import end_with_descendants
from uq.study.evaluate import Chunk, RowFailure, joined, lost_rows
from uq.study.installed_models import code_of

if TYPE_CHECKING:
    from uq.result.workload import Workload


TRIES = 3
"""Crashes before rows are marked as crashed: a process may also be killed externally."""

_PARTS = 8  # of rows that crashed: more are too small for kernels, fewer crash more often
_STARTS = 3
_DYING_SECONDS = 5.0
_STUCK_SECONDS = 5.0  # beyond its limit, after which a row is stopped that should stop itself

Evaluate = Callable[[Floats, NDArray[np.uint64], int], Chunk]
"""``evaluate(x, seed, start)`` -> chunk, as `uq.study.evaluate.evaluate` for one model."""


def spec_of(workload: "Workload") -> child.ModelSpec:
    """Return the specification of the model that a process needs for a workload."""
    settings = tuple(asdict(workload.settings).items())
    code = code_of(workload.model_reference)
    return child.ModelSpec(
        workload.model_reference, workload.model.version, settings, workload.output, code
    )


class Isolated:
    """A process that computes rows, and is replaced when it dies.

    Parameters
    ----------
    spec : uq.execution.child.ModelSpec
    limit : float or None
        Time limit of a row [s]; compilation does not count.
    compiling : callable
        Called when the process starts to compile.
    prints : int
        File descriptor for what the model prints.
    waiting : callable
        Called several times a second while rows are computed.
    """

    def __init__(
        self,
        spec: child.ModelSpec,
        limit: float | None = None,
        compiling: Action = lambda: None,
        prints: int = subprocess.DEVNULL,
        waiting: Action = lambda: None,
    ) -> None:
        self.spec = spec
        self.limit = limit
        self._compiling = compiling
        self._prints = prints
        self._waiting = waiting
        self._process: subprocess.Popen[bytes] | None = None
        self._connection: Connection | None = None
        self._loaded = self._stops_rows = self._loads_first = False
        self._closed = threading.Event()

    @contextmanager
    def running(self) -> Iterator[Evaluate]:
        """Start the process, yield `evaluate`, and end the process."""
        with undone(self.close):
            self.begin()
            yield self.evaluate

    def evaluate(self, x: Floats, seed: NDArray[np.uint64], start: int = 0) -> Chunk:
        """Run some rows; parameters and exceptions as in `uq.study.evaluate.evaluate`.

        Raises
        ------
        RunError
            When the process cannot start, or was closed from another thread.
        """
        chunk = self.ask(x, seed, start)
        if not isinstance(chunk, RowFailure):
            return cast(Chunk, chunk)
        if len(x) == 1:
            return self._single(x, seed, start)
        # Waiting for the time limit costs more than computing rows one by one.
        size = ceil(len(x) / _PARTS) if chunk.status is Status.CRASHED else 1
        parts = range(0, len(x), size)
        part = self.evaluate if size > 1 else self._single
        return joined([part(x[i : i + size], seed[i : i + size], start + i) for i in parts])

    def _single(self, x: Floats, seed: NDArray[np.uint64], start: int) -> Chunk:
        """Run one row alone, to determine whether it crashes the process."""
        for _ in range(TRIES - 1):  # the run of its chunk was the first try
            outcome = self.ask(x, seed, start)
            if not isinstance(outcome, RowFailure):
                return cast(Chunk, outcome)
            if outcome.status is not Status.CRASHED:
                break
        fault = cast(RowFailure, outcome)
        model, settings = self.spec.load()
        if isinstance(model.batch, RowByRow):
            kept = model.batch.kept(x[0].tolist(), int(seed[0]))
            fault = fault._replace(message=fault.message + kept)
        return lost_rows(model, settings, 1, fault, start)

    def close(self) -> None:
        """Terminate the process, even if it is busy."""
        self._closed.set()
        self._end(at_once=True)

    def ask(self, x: Sequence[float] | Floats, *others: Any) -> Any | RowFailure:
        """Return the answer of the process for rows, or the failure that ended it."""
        try:
            connection = self.start()
            connection.send((x, *others))
            answer = self._answer(connection, self._patience(len(x)))
        except (EOFError, OSError):
            return RowFailure(Status.CRASHED, f"killed its process ({self._end()})")
        self._loads_first = False
        if answer is None:
            self._end(at_once=True)
            return RowFailure(Status.TIMED_OUT, f"did not end within {self.limit:g} s")
        kind, value = answer
        if kind == child.REFUSED:
            raise value
        return value

    def _patience(self, rows: int) -> float | None:
        """Return the time limit of rows computed together [s]."""
        if self.limit is None:
            return None
        if self._stops_rows:
            return rows * self.limit + _STUCK_SECONDS
        return self.limit + (child.FIRST_SECONDS if self._loads_first else 0.0)

    def _answer(self, connection: Connection, limit: float | None) -> tuple[str, Any] | None:
        """Return the answer of the process, or None at the time limit."""
        return child.answer_of(connection, limit, self._compiling, self._waiting)

    def begin(self) -> None:
        """Start the process, unless done, without waiting for it; `start` sees whether it lives."""
        with suppress(OSError):
            self._begun()

    def _begun(self) -> Connection:
        if self._connection:
            return self._connection
        self._process, self._connection = started("uq.execution.child", self._prints)
        with suppress(OSError):  # of a process that died: `start` sees it
            self._connection.send((self.spec, self.limit))
        return self._connection

    def start(self) -> Connection:
        """Start the process and load the model, unless done; for rows, again if it is killed.

        Raises
        ------
        InputError
            When it has no such model, or a different one.
        RunError
            When it cannot start, or was closed.
        """
        if self._connection and self._loaded:
            return self._connection
        # What kills a process that loads a model for the first time would kill the next one, too.
        for _ in range(1 if self.spec.probed else _STARTS):
            if self._closed.is_set():
                raise RunError("the process for the rows was ended")
            try:
                connection = self._begun()
                kind, value = connection.recv()
            except (EOFError, OSError):
                reason = self._end()
                continue
            if kind == child.REFUSED:
                self._end()
                raise value
            self._loaded, (self._stops_rows, self._loads_first) = True, value
            return connection
        raise RunError(f"a process for the rows could not start: {reason}")

    def _end(self, at_once: bool = False) -> str:
        """End the process, unless it is already dying; return how it ended."""
        process, connection = self._process, self._connection
        self._process = self._connection = None
        self._loaded = False
        if connection:
            connection.close()
        if not process:
            return "ended"
        try:
            process.wait(0.0 if at_once else _DYING_SECONDS)
        except subprocess.TimeoutExpired:
            end_with_descendants(process.pid)
        process.communicate()  # closes its standard input, and waits
        code = process.returncode
        return signal.strsignal(-code) or "signal" if code < 0 else f"exit code {code}"


_KEPT = 64  # idle processes at most


class Children:
    """Processes that compute rows, each for one call at a time, kept for the next one.

    Any thread may use and close them.
    """

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._idle: list[Isolated] = []
        self._busy: list[Isolated] = []
        self._closed = False

    def begin(
        self,
        count: int,
        spec: ModelSpec,
        limit: float | None = None,
        compiling: Action = lambda: None,
    ) -> None:
        """Start processes in advance, up to a total of `count`.

        Parameters
        ----------
        count : int
        spec, limit, compiling
            As those of `uq.execution.isolation.Isolated`.
        """
        with self._lock:
            new = [
                Isolated(spec, limit, compiling)
                for _ in range(count - len(self._idle) - len(self._busy))
            ]
            self._idle += new
        for process in new:
            process.begin()

    @contextmanager
    def reserved(self, spec: ModelSpec, limit: float | None) -> Iterator[Isolated]:
        """Yield a process reserved for this call, an idle one if there is any."""
        with self._lock:
            fitting = [
                candidate
                for candidate in self._idle
                if (candidate.spec, candidate.limit) == (spec, limit)
            ]
            process = fitting[0] if fitting else Isolated(spec, limit)
            self._idle = [other for other in self._idle if other is not process]
            self._busy.append(process)
            if self._closed:
                process.close()
        sound, surplus = False, [process]
        try:
            yield process
            sound = True
        finally:
            with self._lock:
                self._busy.remove(process)
                if sound and not self._closed:
                    self._idle.append(process)
                    surplus = [self._idle.pop(0)] if len(self._idle) > _KEPT else []
            for discarded in surplus:
                discarded.close()

    def end_idle(self) -> None:
        """Terminate the idle processes."""
        with self._lock:
            idle, self._idle = self._idle, []
        for process in idle:
            process.close()

    def close(self) -> None:
        """Terminate all processes; callers that use one get a `RunError`."""
        with self._lock:
            self._closed = True
            every = [*self._idle, *self._busy]
            self._idle = []
        for process in every:
            process.close()
