"""Rows that are kept in memory, for what is not to be written as it arrives."""

from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from uq.rows import results
from uq.rows.columns import blank_rows, columns_of
from uq.rows.evaluate import Chunk
from uq.rows.sampling import Rows, rows
from uq.rows.workload import Workload, workload_of
from uq.store.tally import Tally, ended

if TYPE_CHECKING:
    from uq.study.definition import Study


class MemoryStore(Tally):
    """The rows of one run, as they arrive.

    Parameters
    ----------
    workload : Workload
    """

    def __init__(self, workload: Workload) -> None:
        super().__init__(workload)
        total, d = self.total, len(workload.model.parameter_names)
        self._rows = Rows(
            x=np.empty((total, d)),
            seed=np.empty(total, dtype=np.uint64),
            replicate=np.empty(total, dtype=np.int32),
            group=np.empty(total, dtype=np.int64),
            block=np.empty(total, dtype=np.int16),
        )
        self._columns = blank_rows(columns_of(workload.model, workload.settings), total)
        self._status = np.zeros(total, dtype=np.int8)

    @property
    def missing(self) -> list[tuple[int, int]]:
        """Blocks of rows that are not there at the start."""
        return [(0, self.total)]

    def add(self, start: int, rows: Rows, chunk: Chunk) -> None:
        """Keep the rows from `start` on.

        Parameters
        ----------
        start : int
        rows : Rows
        chunk : Chunk
        """
        stop = start + len(chunk.status)
        for field, part in rows._asdict().items():
            getattr(self._rows, field)[start:stop] = part
        for name, whole in self._columns.items():
            whole[start:stop] = chunk.columns[name]
        self._status[start:stop] = chunk.status
        self.count(stop - start, self.failed_in(chunk), ended(chunk.status), chunk.failures)

    @property
    def reach(self) -> int:
        """Number behind the last row that is there at the start."""
        return 0

    def first(self, study: "Study") -> xr.Dataset:
        """Return the result of a study of fewer samples, whose rows have all arrived."""
        n = rows(study)
        columns = {name: whole[:n] for name, whole in self._columns.items()}
        parts = self._rows.part(0, n), columns, self._status[:n]
        return results.build(study, *parts, self.examples)

    def cut(self, study: "Study") -> None:
        """End with the rows of a study of fewer samples, which are all that have arrived."""
        self.workload = workload_of(study)
        n = self.total = self.workload.total
        self._rows, self._status = self._rows.part(0, n), self._status[:n]
        self._columns = {name: whole[:n] for name, whole in self._columns.items()}

    def keep_up(self) -> None:
        """Nothing: what is here is kept nowhere else."""

    def chunk(self) -> Chunk:
        """Return what became of the rows of a run that have all arrived."""
        return Chunk(self._columns, self._status, self.failures)

    def dataset(self) -> xr.Dataset:
        """Return the result of a run whose rows have all arrived."""
        assert self.workload.finish is not None
        return self.workload.finish(self._rows, self._columns, self._status, self.examples)
