"""Who computes rows: this process, others on this computer, or the workers of a cluster."""

from contextlib import ExitStack
from functools import partial
from typing import Self

import numpy as np
from numpy.typing import NDArray

from uq.compilation import compilation
from uq.contract import Floats
from uq.interrupts import in_background
from uq.rows.evaluate import Chunk, evaluate
from uq.rows.workload import Workload
from uq.running.cores import cores
from uq.running.crew import Crew
from uq.running.dispatch import Dispatcher
from uq.running.isolation import Action, Evaluate, isolated
from uq.running.local_processes import SHORT_SECONDS, local_processes
from uq.running.options import RunOptions


def in_one_process(workers: int | None, seconds: float) -> bool:
    """Return whether one process computes work that takes it so long [s]."""
    return workers == 0 or (workers is None and seconds < SHORT_SECONDS)


def processes(workload: Workload, workers: int | None) -> int:
    """Return how many processes compute at the same time, if the work is worth starting them."""
    groups = workload.total // workload.group or np.inf  # 0: not known yet
    return int(min(1 if workers == 0 else workers or cores(), groups))


class Executor:
    """Computes the rows of one dispatcher after another; a context manager.

    The processes stay for the next dispatcher.

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
        self._here: Evaluate | None = None
        self._crew: Crew | None = None
        self._stack = ExitStack()

    def __enter__(self) -> Self:
        workload, workers, limit = self._workload, self._options.workers, self._options.row_limit
        if workers == 0:
            self._stack.enter_context(compilation(self._compiling))
            self._here = partial(_in_process, workload)
        elif self._options.scheduler is not None:
            process = isolated(workload, limit, self._compiling)
            self._here = self._stack.enter_context(process)
        else:
            most = processes(workload, workers)
            crew = local_processes(workload, most if workers else 1, most, limit, self._compiling)
            self._crew = self._stack.enter_context(crew)
        return self

    def __exit__(self, *exception: object) -> None:
        self._stack.close()

    def finish(self, dispatcher: Dispatcher) -> None:
        """Have all rows of a dispatcher computed."""
        if self._options.scheduler is not None and self._crew is None:
            self._crew = self._cluster(self._options.scheduler)  # before anything is computed
        if self._here is not None and self._crew is not None:
            dispatcher.begin_here(self._here, share=1 / 8)
        if self._crew is not None:
            dispatcher.finish_on(self._crew)
        elif self._here is not None:
            dispatcher.finish_here(self._here)

    def _cluster(self, address: str) -> Crew:
        from uq.running.remote_cluster import remote_workers
        from uq.running.sent_chunks import SentChunks

        workers = self._stack.enter_context(remote_workers(address))
        return SentChunks(self._workload, workers, self._options.row_limit)


def _in_process(workload: Workload, x: Floats, seed: NDArray[np.uint64], start: int) -> Chunk:
    """Compute rows in this process, which nothing protects from them."""
    return in_background(lambda: evaluate(workload.model, workload.settings, x, seed, start))
