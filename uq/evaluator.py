"""Rows that somebody asks for batch after batch, computed as a run computes them.

For methods that look at what has come back before they ask for more.
"""

import time
from collections.abc import Iterator
from contextlib import ExitStack
from dataclasses import asdict
from math import ceil
from queue import Empty, SimpleQueue
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from uq.contract import Model
from uq.errors import InputError, RunError
from uq.evaluate import Chunk, evaluate
from uq.interrupts import in_background
from uq.task import evaluate_rows

if TYPE_CHECKING:
    from uq.cluster import Workers

IN_PROCESS_SECONDS = 4.0
"""Work done in this process before workers are worth starting."""

_FIRST_ROWS = 16
_GROWTH = 4  # of what is computed here at a time
_POLL_SECONDS = 0.2
_MOST_ROWS = 10_000  # of one task


class Evaluator:
    """A model, and who computes its rows; a context manager.

    Parameters
    ----------
    model : Model
    reference : str
        What `uq.registry.find_model` finds the model by; "" for one that only this process has.
    settings : object
        An instance of ``model.settings``.
    workers, scheduler
        As in `uq.run`.

    Attributes
    ----------
    rows : int
        Rows computed so far.
    """

    def __init__(
        self,
        model: Model,
        reference: str,
        settings: Any,
        workers: int | None = None,
        scheduler: str | None = None,
    ) -> None:
        if workers is not None and scheduler is not None:
            raise InputError("workers and scheduler exclude each other")
        if workers is not None and workers < 0:
            raise InputError(f"workers must not be negative: {workers}")
        self.rows = 0
        self._model, self._reference, self._settings = model, reference, settings
        self._workers, self._scheduler = workers if reference else 0, scheduler
        self._crew: Workers | None = None
        self._stack = ExitStack()
        self._seconds = 0.0
        self._size = _FIRST_ROWS

    def __enter__(self) -> Self:
        if self._scheduler is not None:
            from uq import cluster

            self._crew = self._stack.enter_context(cluster.remote(self._scheduler))
        return self

    def __exit__(self, *exception: object) -> None:
        self._stack.close()

    def __call__(self, x: NDArray[np.float64], seed: NDArray[np.uint64]) -> Chunk:
        """Run the model on some rows.

        Parameters
        ----------
        x : ndarray, shape (n, d)
            Parameters in declared order.
        seed : ndarray of uint64, shape (n,)

        Returns
        -------
        Chunk
            The same bits whoever computes it.
        """
        chunks: list[Chunk] = []
        done = 0
        while done < len(x) and not self._crew_by_now():
            rows = slice(done, done + self._size)
            chunks.append(self._here(x[rows], seed[rows]))
            done += len(chunks[-1].status)
        if done < len(x):
            chunks += self._there(x[done:], seed[done:])
        return _joined(chunks)

    def _here(self, x: NDArray[np.float64], seed: NDArray[np.uint64]) -> Chunk:
        began = time.perf_counter()
        start = self.rows
        chunk = in_background(lambda: evaluate(self._model, self._settings, x, seed, start))
        if start:  # the first rows may compile
            self._seconds += time.perf_counter() - began
        self.rows += len(x)
        self._size = min(_MOST_ROWS, _GROWTH * self._size)
        return chunk

    def _there(self, x: NDArray[np.float64], seed: NDArray[np.uint64]) -> Iterator[Chunk]:
        from distributed import KilledWorker

        assert self._crew is not None
        tasks = max(1, self._crew.threads, ceil(len(x) / _MOST_ROWS))
        futures = [
            self._crew.client.submit(
                evaluate_rows,
                self._reference,
                self._model.version,
                asdict(self._settings),
                x[rows],
                seed[rows],
                self.rows + int(rows[0]),
                pure=False,
            )
            for rows in np.array_split(np.arange(len(x)), min(tasks, len(x)))
        ]
        self.rows += len(x)
        arrived: SimpleQueue[object] = SimpleQueue()
        for future in futures:
            future.add_done_callback(arrived.put)
        done = 0
        while done < len(futures):
            try:
                arrived.get(timeout=_POLL_SECONDS)
                done += 1
            except Empty:
                self._crew.watch()
        for future in futures:
            try:
                yield future.result()[0]
            except KilledWorker:
                raise RunError("some rows killed the worker processes that computed them") from None

    def _crew_by_now(self) -> "Workers | None":
        """Return the workers, once there are to be any."""
        long = self._workers is None and self._seconds > IN_PROCESS_SECONDS
        if self._crew is None and self.rows and (self._workers or long):
            from uq import cluster

            count = self._workers or cluster.CORES
            self._crew = self._stack.enter_context(cluster.local(count))
        return self._crew


def _joined(chunks: list[Chunk]) -> Chunk:
    failures: dict[str, tuple[int, str]] = {}
    for chunk in reversed(chunks):
        failures |= chunk.failures
    return Chunk(
        {name: np.concatenate([c.columns[name] for c in chunks]) for name in chunks[0].columns},
        np.concatenate([chunk.status for chunk in chunks]),
        failures,
    )
