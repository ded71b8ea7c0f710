"""The rows of a run: counted wherever they are kept, or kept in memory as they arrive."""

from collections import Counter
from math import prod
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Status
from uq.execution.chunk_file import Block, pack, row_type, unpack
from uq.result.preview import Preview
from uq.result.workload import Workload
from uq.study.columns import columns_of, failed_rows
from uq.study.definition import Study
from uq.study.evaluate import Chunk
from uq.study.row_sampling import Rows

Failures = dict[str, tuple[int, str]]
"""Status label -> number of the first row with that status, and its message."""


class MemoryStore:
    """The rows of one run, counted and kept in memory as they arrive.

    Parameters
    ----------
    workload : Workload

    Attributes
    ----------
    total : int
        Rows of the whole run.
    done : int
        Rows that are there.
    failed : int
        Failed rows among them.
    reused : int
        Rows computed earlier, present from the start.
    failures : Failures
    status : dict of str to int
        Status label -> rows.
    preview : Preview
        Of the rows that arrived in this process.
    row_type : numpy.dtype
        See `uq.execution.chunk_file.row_type`.
    """

    def __init__(self, workload: Workload) -> None:
        self.workload = workload
        self.total = workload.total
        self.done = self.failed = self.reused = 0
        self.failures: Failures = {}
        self.status: Counter[str] = Counter()
        self.preview = Preview(workload)
        self.row_type = row_type(workload)
        self._pending: list[tuple[int, NDArray[Any]]] = []

    @property
    def missing(self) -> list[Block]:
        """Blocks of missing rows, before the first rows arrive."""
        return [(0, self.total)]

    @property
    def shapes_all_wrong(self) -> str | None:
        """What is wrong with the shape of every row so far, if every row has a wrong shape."""
        label = Status.BAD_SHAPE.label
        return self.failures[label][1] if 0 < self.status[label] == self.done else None

    @property
    def examples(self) -> dict[str, str]:
        """Status label -> message of the first row with that status."""
        return {label: f"row {row}: {text}" for label, (row, text) in self.failures.items()}

    def add(self, start: int, rows: Rows, chunk: Chunk) -> None:
        """Count and keep the rows from `start` on.

        Parameters
        ----------
        start : int
        rows : Rows
        chunk : Chunk
        """
        data = pack(self.row_type, rows, chunk.columns, chunk.status)
        self._pending.append((start, data))
        self.count(*self.counts(data), chunk.failures)

    def keep_up(self) -> None:
        """Do nothing: these rows are written nowhere."""

    def counts(self, data: NDArray[Any]) -> tuple[int, int, dict[str, int]]:
        """Return the number of packed rows, of the failed ones, and of each status."""
        required = (
            (output, data["columns"][name])
            for name, output in self.workload.model.outputs.items()
            if not output.may_be_undefined
        )
        status = data["status"]
        return len(data), int(np.count_nonzero(failed_rows(status, required))), by_status(status)

    def count(self, rows: int, failed: int, status: dict[str, int], failures: Failures) -> None:
        """Count some rows."""
        self.done += rows
        self.failed += failed
        self.status.update(status)
        self.failures = joined_failures(self.failures, failures)

    def chunk(self) -> Chunk:
        """Return outputs and status of the rows of a complete run."""
        return Chunk(*self._unpacked()[1:], self.failures)

    def dataset(self) -> xr.Dataset:
        """Return the result of a complete run."""
        assert self.workload.finish is not None
        return self.workload.finish(*self._unpacked(), self.examples)

    def _unpacked(self) -> tuple[Rows, dict[str, NDArray[Any]], NDArray[np.int8]]:
        """Return all rows in order; they are then kept no longer."""
        rows = np.empty(self.total, self.row_type)
        while self._pending:
            start, data = self._pending.pop()
            rows[start : start + len(data)] = data
        return unpack(rows)


def by_status(status: NDArray[np.int8]) -> dict[str, int]:
    """Return the number of rows of each status."""
    codes, counts = np.unique(status, return_counts=True)
    return {Status(code).label: int(n) for code, n in zip(codes, counts, strict=True)}


def joined_failures(first: Failures, second: Failures) -> Failures:
    """Return the first failure of each status in either."""
    return first | {
        label: min(failure, first.get(label, failure)) for label, failure in second.items()
    }


def row_bytes(workload: Workload | Study) -> int:
    """Return roughly how many bytes a row takes, inputs and outputs."""
    columns = columns_of(workload.model, workload.settings).values()
    outputs = sum(column.dtype.itemsize * prod(column.shape) for column in columns)
    return 8 * len(workload.model.parameter_names) + 32 + outputs
