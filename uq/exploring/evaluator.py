"""Rows that somebody asks for batch after batch, computed as a run computes them.

For methods that look at what has come back before they ask for more.
"""

from typing import TYPE_CHECKING, Self

import numpy as np
from numpy.typing import NDArray

from uq.rows.evaluate import Chunk
from uq.rows.sampling import Rows
from uq.rows.workload import Workload
from uq.running.dispatch import Dispatcher
from uq.running.executor import Executor
from uq.running.options import DEFAULTS, RunOptions
from uq.store import MemoryStore

if TYPE_CHECKING:
    from uq.study.definition import Study

_NONE = Rows(np.empty((0, 0)), *(np.empty(0, kind) for kind in ("u8", "i4", "i8", "i2")))


class Evaluator:
    """The model of a study, and who computes its rows; a context manager.

    Parameters
    ----------
    study : Study
    output : str
        The output that is wanted: computed alone, where the model can do so.
    options : RunOptions

    Attributes
    ----------
    rows : int
        Rows computed so far.
    """

    def __init__(self, study: "Study", output: str, options: RunOptions = DEFAULTS) -> None:
        cheap = output in study.model.cheap
        self.rows = 0
        self._options = options
        self._workload = Workload(
            model=study.model.alone(output) if cheap else study.model,
            model_reference=study.model_reference,
            settings=study.settings,
            total=0,
            group=1,
            block=_NONE.part,
            output=output if cheap else "",
        )
        self._executor = Executor(self._workload, options)

    def __enter__(self) -> Self:
        self._executor.__enter__()
        return self

    def __exit__(self, *exception: object) -> None:
        self._executor.__exit__(*exception)

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
            The same bits whoever computes it; its failures are numbered through all batches.
        """
        zeros = np.zeros(len(x), np.int64)
        rows = Rows(x, seed, zeros.astype(np.int32), zeros, zeros.astype(np.int16))
        workload = self._workload._replace(total=len(x), block=rows.part)
        store = MemoryStore(workload)
        dispatcher = Dispatcher(workload, self._options, store, self._executor.evaluate)
        self._executor.finish(dispatcher)
        columns, status, failures = store.chunk()
        numbered = {label: (self.rows + row, text) for label, (row, text) in failures.items()}
        self.rows += len(x)
        return Chunk(columns, status, numbered)
