"""Rows kept in memory, for analyses that do not write them as they arrive."""

import numpy as np
import xarray as xr

from uq.rows.evaluate import Chunk
from uq.rows.sampling import Rows
from uq.rows.workload import Workload
from uq.store.chunk_file import pack, unpack
from uq.store.tally import Tally


class MemoryStore(Tally):
    """The rows of one run, as they arrive.

    Parameters
    ----------
    workload : Workload

    Attributes
    ----------
    missing : list of (int, int)
        Blocks of rows that are missing at the start: all.
    """

    def __init__(self, workload: Workload) -> None:
        super().__init__(workload)
        self.missing = [(0, self.total)]
        self._data = np.empty(self.total, self.row_type)

    def add(self, start: int, rows: Rows, chunk: Chunk) -> None:
        """Keep the rows from `start` on.

        Parameters
        ----------
        start : int
        rows : Rows
        chunk : Chunk
        """
        data = pack(self.row_type, rows, chunk.columns, chunk.status)
        self._data[start : start + len(data)] = data
        self.count(*self.counts(chunk.columns, chunk.status), chunk.failures)

    def keep_up(self) -> None:
        """Do nothing: these rows are written nowhere."""

    def chunk(self) -> Chunk:
        """Return outputs and status of the rows of a complete run."""
        return Chunk(*unpack(self._data)[1:], self.failures)

    def dataset(self) -> xr.Dataset:
        """Return the result of a complete run."""
        assert self.workload.finish is not None
        return self.workload.finish(*unpack(self._data), self.examples)
