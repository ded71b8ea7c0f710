"""Who computes rows: this computer, and dask workers if the work is worth starting them."""

from contextlib import ExitStack
from functools import cached_property
from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.execution.child import ModelSpec
from uq.execution.children import Children
from uq.execution.dispatch import Dispatcher
from uq.execution.isolation import Action, spec_of
from uq.execution.options import RunOptions
from uq.files.interrupts import in_background, undone
from uq.machines.compilation import compilation
from uq.machines.row_by_row import RowByRow
from uq.result.workload import Workload
from uq.study.evaluate import Chunk, evaluate

if TYPE_CHECKING:
    from uq.execution.workers import Workers

SHORT_SECONDS = 4.0
"""Shorter work is not worth starting workers."""

_SHARE_HERE = 1 / 64  # of the rows, to learn what they cost before workers take chunks of them


def in_one_process(workers: int | None, seconds: float) -> bool:
    """Return whether one process computes work that takes it so long [s], without workers."""
    return workers == 0 or (workers is None and seconds < SHORT_SECONDS)


def processes(workload: Workload, workers: int | None) -> int:
    """Return how many processes compute at the same time, if the work is worth starting workers."""
    from dask.system import CPU_COUNT  # within affinity and container limits

    return min(1 if workers == 0 else workers or CPU_COUNT, workload.total // workload.group)


def first_rows_alone(workload: Workload, workers: int | None) -> bool:
    """Return whether one process computes the first rows, before workers share the others.

    It learns what they cost, and compiles the model, which one from outside does not need.
    """
    return not workers or not isinstance(workload.model.batch, RowByRow)


class Executor:
    """Computes the rows of one dispatcher after another; a context manager.

    Workers start when they are first needed, and stay for the next dispatcher.

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
        self._children = Children()
        self._crew: Workers | None = None
        self._stack = ExitStack()
        self._seconds = 0.0

    def __enter__(self) -> Self:
        if self._options.workers == 0:
            self._stack.enter_context(compilation(self._compiling))
        else:
            self._stack.enter_context(undone(self._children.close))
            self._begin(1)
        return self

    def __exit__(self, *exception: object) -> None:
        self._stack.close()
        if isinstance(self._workload.model.batch, RowByRow):
            self._workload.model.batch.leave()  # after the processes that were stopped

    def evaluate(self, x: Floats, seed: NDArray[np.uint64], start: int) -> Chunk:
        """Compute rows on this computer, in a separate process unless the user wants none."""
        if self._options.workers == 0:
            model, settings = self._workload.model, self._workload.settings
            return in_background(lambda: evaluate(model, settings, x, seed, start))
        with self._children.reserved(self._spec, self._options.row_limit) as child:
            return child.evaluate(x, seed, start)

    def finish(self, dispatcher: Dispatcher) -> None:
        """Have all rows of a dispatcher computed."""
        workers = self._options.workers
        if self._options.scheduler is not None:
            crew = self._started(dispatcher)  # before anything is computed
            dispatcher.begin_here(_SHARE_HERE)
            dispatcher.finish_on(crew)
            return
        begun = not workers and self._crew is None
        if begun:
            dispatcher.begin_here(share=1)
        # Counting earlier dispatchers, is the work worth starting workers?
        seconds = self._seconds + dispatcher.row_seconds * dispatcher.left
        if self._crew is None and in_one_process(workers, seconds):
            dispatcher.finish_here()
        elif dispatcher.left:
            crew = self._started(dispatcher)
            if not begun and first_rows_alone(self._workload, workers):
                dispatcher.begin_here(_SHARE_HERE)
            dispatcher.finish_on(crew)
        self._seconds += dispatcher.row_seconds * dispatcher.rows

    def _started(self, dispatcher: Dispatcher) -> "Workers":
        if self._crew is None:
            how = self._workload, self._options.row_limit
            if self._options.scheduler is not None:
                from uq.execution.remote_cluster import remote_workers

                crew = remote_workers(self._options.scheduler, *how)
            else:
                count = processes(dispatcher.workload, self._options.workers)
                self._begin(count)  # they import while dask does
                from uq.execution.local_cluster import local_workers

                crew = local_workers(count, self._children, *how)
            self._crew = self._stack.enter_context(crew)
        return self._crew

    @cached_property
    def _spec(self) -> ModelSpec:
        return spec_of(self._workload)

    def _begin(self, count: int) -> None:
        self._children.begin(count, self._spec, self._options.row_limit, self._compiling)
