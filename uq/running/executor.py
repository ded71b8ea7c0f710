"""Who computes rows: this computer, and dask workers where the work is worth starting them."""

from collections.abc import Callable
from contextlib import ExitStack
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from uq.compilation import compilation
from uq.errors import InputError
from uq.interrupts import in_background
from uq.rows.evaluate import Chunk, evaluate
from uq.rows.workload import Work
from uq.running.dispatch import Job
from uq.running.isolation import Evaluate, isolated

if TYPE_CHECKING:
    from uq.running.cluster import Workers

SHORT_SECONDS = 4.0
"""Work that is shorter than this is not worth starting workers."""


class Computing:
    """Whoever computes one job after another; a context manager.

    Workers start when a job first needs them, and stay for the next.

    Parameters
    ----------
    work : Work
        The jobs are about its model and settings.
    workers, scheduler, row_limit
        As in `uq.run`.
    compiling : callable
        Called when the model begins to be compiled.

    Attributes
    ----------
    evaluate : Evaluate
        Computes rows on this computer, in a process of their own unless the user wants none.

    Raises
    ------
    InputError
        When these exclude each other.
    """

    evaluate: Evaluate

    def __init__(
        self,
        work: Work,
        workers: int | None = None,
        scheduler: str | None = None,
        row_limit: float | None = None,
        compiling: Callable[[], object] = lambda: None,
    ) -> None:
        if workers is not None and scheduler is not None:
            raise InputError("workers and scheduler exclude each other")
        if workers is not None and workers < 0:
            raise InputError(f"workers must not be negative: {workers}")
        if row_limit is not None and not row_limit > 0:
            raise InputError(f"the time limit of a row must be positive: {row_limit:g} s")
        if row_limit is not None and workers == 0:
            raise InputError(
                "a time limit for rows needs another process that can be stopped: "
                "workers = 0 has none (leave it out, or take 1)"
            )
        self._work, self._row_limit = work, row_limit
        self._workers, self._scheduler = workers, scheduler
        self._compiling = compiling
        self._crew: Workers | None = None
        self._stack = ExitStack()
        self._seconds = 0.0

    def __enter__(self) -> Self:
        if self._workers == 0:
            self._stack.enter_context(compilation(self._compiling))
            self.evaluate = _in_process(self._work)
        else:
            process = isolated(self._work, self._row_limit, self._compiling)
            self.evaluate = self._stack.enter_context(process)
        return self

    def __exit__(self, *exception: object) -> None:
        self._stack.close()

    def finish(self, job: Job) -> None:
        """Have all rows of a job computed."""
        if self._scheduler is not None:
            crew = self._started(job)  # before anything is computed
            job.pilot(share=1 / 8)
            job.finish_on(crew)
            return
        if not self._workers and self._crew is None:
            job.pilot(share=1)
        if self._workers == 0 or (self._workers is None and self._short(job)):
            job.finish_here()
        elif not job.complete:
            known = self._workers is None and self._crew is None
            crew = self._started(job)
            if not known:
                job.pilot(share=1 / 8)  # while they start
            job.finish_on(crew)
        self._seconds += job.seconds

    def _short(self, job: Job) -> bool:
        """Return whether a job, with those before it, is not worth starting workers."""
        return self._crew is None and self._seconds + job.seconds_left < SHORT_SECONDS

    def _started(self, job: Job) -> "Workers":
        from uq.running import cluster

        if self._crew is None:
            if self._scheduler is not None:
                crew = cluster.remote(self._scheduler)
            else:
                crew = cluster.local(min(self._workers or cluster.CORES, job.groups))
            self._crew = self._stack.enter_context(crew)
        return self._crew


def _in_process(work: Work) -> Evaluate:
    """Return what computes rows in this process: nothing protects it from them."""

    def call(x: NDArray[np.float64], seed: NDArray[np.uint64], start: int) -> Chunk:
        return in_background(lambda: evaluate(work.model, work.settings, x, seed, start))

    return call
