"""Who computes rows: this computer, and dask workers where the work is worth starting them."""

from collections.abc import Callable
from contextlib import ExitStack
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from uq.compilation import compilation
from uq.interrupts import in_background
from uq.rows.evaluate import Chunk, evaluate
from uq.rows.workload import Workload
from uq.running.dispatch import Dispatcher
from uq.running.isolation import Evaluate, isolated
from uq.running.options import RunOptions

if TYPE_CHECKING:
    from uq.running.workers import Workers

SHORT_SECONDS = 4.0
"""Work that is shorter than this is not worth starting workers."""


class Executor:
    """Whoever computes the rows of one dispatcher after another; a context manager.

    Workers start when they are first needed, and stay for the next dispatcher.

    Parameters
    ----------
    workload : Workload
        All dispatchers are about its model and settings.
    options : RunOptions
    compiling : callable
        Called when the model begins to be compiled.

    Attributes
    ----------
    evaluate : Evaluate
        Computes rows on this computer, in a process of their own unless the user wants none.

    Raises
    ------
    InputError
        When options exclude each other.
    """

    evaluate: Evaluate

    def __init__(
        self,
        workload: Workload,
        options: RunOptions,
        compiling: Callable[[], object] = lambda: None,
    ) -> None:
        options.check()
        self._workload, self._options = workload, options
        self._compiling = compiling
        self._crew: Workers | None = None
        self._stack = ExitStack()
        self._seconds = 0.0

    def __enter__(self) -> Self:
        if self._options.workers == 0:
            self._stack.enter_context(compilation(self._compiling))
            self.evaluate = _in_process(self._workload)
        else:
            process = isolated(self._workload, self._options.row_limit, self._compiling)
            self.evaluate = self._stack.enter_context(process)
        return self

    def __exit__(self, *exception: object) -> None:
        self._stack.close()

    def finish(self, dispatcher: Dispatcher) -> None:
        """Have all rows of a dispatcher computed."""
        workers = self._options.workers
        if self._options.scheduler is not None:
            crew = self._started(dispatcher)  # before anything is computed
            dispatcher.pilot(share=1 / 8)
            dispatcher.finish_on(crew)
            return
        if not workers and self._crew is None:
            dispatcher.pilot(share=1)
        if workers == 0 or (workers is None and self._short(dispatcher)):
            dispatcher.finish_here()
        elif not dispatcher.complete:
            known = workers is None and self._crew is None
            crew = self._started(dispatcher)
            if not known:
                dispatcher.pilot(share=1 / 8)  # while they start
            dispatcher.finish_on(crew)
        self._seconds += dispatcher.seconds

    def _short(self, dispatcher: Dispatcher) -> bool:
        """Return whether these rows, with those before, are not worth starting workers."""
        return self._crew is None and self._seconds + dispatcher.seconds_left < SHORT_SECONDS

    def _started(self, dispatcher: Dispatcher) -> "Workers":
        from uq.running import local_cluster, remote_cluster

        if self._crew is None:
            if self._options.scheduler is not None:
                crew = remote_cluster.remote_workers(self._options.scheduler)
            else:
                count = self._options.workers or local_cluster.CORES
                crew = local_cluster.local_workers(min(count, dispatcher.groups))
            self._crew = self._stack.enter_context(crew)
        return self._crew


def _in_process(workload: Workload) -> Evaluate:
    """Return what computes rows in this process: nothing protects it from them."""

    def call(x: NDArray[np.float64], seed: NDArray[np.uint64], start: int) -> Chunk:
        return in_background(lambda: evaluate(workload.model, workload.settings, x, seed, start))

    return call
