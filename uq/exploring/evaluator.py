"""Rows requested batch after batch, computed as in a run.

For methods that look at the rows so far before they ask for more.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from uq.rows.evaluate import Chunk
from uq.rows.sampling import Rows
from uq.rows.workload import Workload
from uq.running.dispatch import Dispatcher
from uq.running.executor import Executor
from uq.running.options import RunOptions
from uq.store import MemoryStore
from uq.study.definition import Study

Evaluator = Callable[[NDArray[np.float64], NDArray[np.uint64]], Chunk]
"""``evaluator(x, seed)`` -> outputs of rows x (n, d), in declared order, with seeds (n,): the same
bits wherever they are computed."""

_NONE = Rows(np.empty((0, 0)), *(np.empty(0, kind) for kind in ("u8", "i4", "i8", "i2")))


@contextmanager
def evaluator_of(study: Study, output: str, options: RunOptions) -> Iterator[Evaluator]:
    """Yield a function that runs the model of a study.

    Parameters
    ----------
    study : Study
    output : str
        The output that is wanted: computed alone if the model can do so.
    options : RunOptions
    """
    cheap = output in study.model.cheap
    work = Workload(
        model=study.model.alone(output) if cheap else study.model,
        model_reference=study.model_reference,
        settings=study.settings,
        total=0,
        group=1,
        block=_NONE.part,
        output=output if cheap else "",
    )
    with Executor(work, options) as executor:

        def evaluator(x: NDArray[np.float64], seed: NDArray[np.uint64]) -> Chunk:
            zeros = np.zeros(len(x), np.int64)
            rows = Rows(x, seed, zeros.astype(np.int32), zeros, zeros.astype(np.int16))
            batch = work._replace(total=len(x), block=rows.part)
            store = MemoryStore(batch)
            executor.finish(Dispatcher(batch, options, store, executor.evaluate))
            return store.chunk()

        yield evaluator
