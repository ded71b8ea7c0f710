"""Processes that compute rows, as many as are asked at the same time."""

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from uq.execution.child import Action, ModelSpec
from uq.execution.isolation import Isolated

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
        """Start processes before there are rows for them, until there are so many.

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
        """End those that nobody uses."""
        with self._lock:
            idle, self._idle = self._idle, []
        for process in idle:
            process.close()

    def close(self) -> None:
        """End all, whatever they are doing; those who use one see a `RunError`."""
        with self._lock:
            self._closed = True
            every = [*self._idle, *self._busy]
            self._idle = []
        for process in every:
            process.close()
