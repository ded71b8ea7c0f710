"""Processes on this computer that compute chunks side by side.

Each has a thread of this process, which starts it, hands it chunks and waits for them. Rows that
crash their process, or a process killed from outside, are the matter of `uq.running.isolation`.
"""

import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from queue import Empty, SimpleQueue

from uq.interrupts import undone
from uq.rows.sampling import Rows
from uq.rows.workload import Workload
from uq.running.crew import Returned
from uq.running.isolation import Action, Isolated, spec_of

SHORT_SECONDS = 4.0
"""Shorter work is not worth starting more than one process."""

_WAIT_SECONDS = 0.2
_GOODBYE_SECONDS = 5.0


@contextmanager
def local_processes(
    workload: Workload, count: int, most: int, limit: float | None, compiling: Action
) -> Iterator["LocalProcesses"]:
    """Start processes that compute rows of a workload, and end them.

    Parameters
    ----------
    workload : Workload
    count : int
        Processes to start at once.
    most : int
        Processes for work that is worth it.
    limit : float or None
        Time limit of a row [s].
    compiling : callable
        Called when a process starts to compile.
    """
    crew = LocalProcesses(workload, most, limit, compiling)
    with undone(crew.close):
        crew.start(count)
        yield crew


class LocalProcesses:
    """A `Crew` of processes on this computer; see `local_processes`."""

    dashboard = ""

    def __init__(
        self, workload: Workload, most: int, limit: float | None, compiling: Action
    ) -> None:
        self._spec = spec_of(workload)
        self._most, self._limit, self._compiling = most, limit, compiling
        self._crew: list[tuple[Isolated, threading.Thread]] = []
        self._sent: SimpleQueue[tuple[int, Rows] | None] = SimpleQueue()
        self._back: SimpleQueue[Returned | BaseException] = SimpleQueue()
        self._under_way = 0
        self._spent = 0.0
        self._compiled = False

    def __len__(self) -> int:
        return self._under_way

    @property
    def threads(self) -> int:
        """Processes, also those that are about to start."""
        return len(self._crew)

    @property
    def room(self) -> int:
        """One chunk at first, so that only one process compiles; then one is always at hand."""
        return len(self._crew) + 1 if self._compiled else 1

    def start(self, count: int) -> None:
        """Start processes until there are so many."""
        while len(self._crew) < count:
            process = Isolated(self._spec, self._limit, self._compiling)
            thread = threading.Thread(target=self._serve, args=(process,), daemon=True)
            self._crew.append((process, thread))
            thread.start()

    def send(self, start: int, rows: Rows) -> None:
        """Have some rows computed by the first process that is free."""
        self._under_way += 1
        self._sent.put((start, rows))

    def returned(self) -> list[Returned]:
        """Return what is back, after a short wait if there is nothing.

        Raises
        ------
        InputError
            When the model cannot be used.
        RunError
            When a process cannot start.
        """
        back: list[Returned] = []
        with suppress(Empty):
            while True:
                one = self._back.get(timeout=0.0 if back else _WAIT_SECONDS)
                if isinstance(one, BaseException):
                    raise one
                back.append(one)
                self._under_way -= 1
                self._spent += one[-1]
                self._compiled = True
        return back

    def expect(self, seconds: float) -> None:
        """Start all processes if the work done and the work to come [s] are worth it."""
        if self._spent + seconds >= SHORT_SECONDS:
            self.start(self._most)

    def close(self) -> None:
        """End the processes, whatever they are doing."""
        for _ in self._crew:
            self._sent.put(None)
        for process, _ in self._crew:
            process.stop()
        for _, thread in self._crew:
            thread.join(_GOODBYE_SECONDS)

    def _serve(self, process: Isolated) -> None:
        """Start a process and have it compute chunks, until there is None."""
        first = True
        try:
            process.start()
            while sent := self._sent.get():
                # The first chunk of all bounds the cost of a row; those of other processes, which
                # load what was compiled, say nothing of it.
                known = not first or not self._compiled
                began = time.perf_counter()
                chunk = process.evaluate(sent[1].x, sent[1].seed, sent[0])
                seconds = time.perf_counter() - began
                self._back.put((*sent, chunk, seconds if known else 0.0))
                first = False
        except BaseException as error:  # whoever waits for rows gets it
            self._back.put(error)
        finally:
            process.close()
