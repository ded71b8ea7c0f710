"""Counts of the rows of a run, wherever they are kept."""

from collections import Counter
from math import prod
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from uq.contract import Status
from uq.rows.columns import columns_of, failed_rows
from uq.rows.preview import Preview
from uq.rows.workload import Workload

if TYPE_CHECKING:
    from uq.rows.evaluate import Chunk
    from uq.study.definition import Study

Failures = dict[str, tuple[int, str]]
"""Status label -> number of the first row with that status, and what happened to it."""


class Tally:
    """How many rows there are, and how they ended.

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
        Rows among them that failed.
    found : int
        Rows that were there from the start.
    failures : Failures
    status : dict of str to int
        Status label -> rows.
    preview : Preview
        Of the rows that arrived in this process.
    """

    def __init__(self, workload: Workload) -> None:
        self.workload = workload
        self.total = workload.total
        self.done = 0
        self.failed = 0
        self.found = 0
        self.failures: Failures = {}
        self.status: Counter[str] = Counter()
        self.preview = Preview(workload)
        self._bad_shapes = 0

    def count(self, rows: int, failed: int, status: dict[str, int], failures: Failures) -> None:
        """Count some rows."""
        self.done += rows
        self.failed += failed
        self.status.update(status)
        self._bad_shapes += status.get(Status.BAD_SHAPE.label, 0)
        self.failures = joined_failures(self.failures, failures)

    @property
    def shapes_all_wrong(self) -> str | None:
        """What is wrong with the shape of every row so far, if every row has a wrong shape."""
        if 0 < self._bad_shapes == self.done:
            return self.failures[Status.BAD_SHAPE.label][1]
        return None

    @property
    def examples(self) -> dict[str, str]:
        """What happened to the first row of each status, status label -> sentence."""
        return {label: f"row {row}: {text}" for label, (row, text) in self.failures.items()}

    def failed_in(self, chunk: "Chunk") -> int:
        """Return how many rows of a chunk failed."""
        required = (
            (output, chunk.columns[name])
            for name, output in self.workload.model.outputs.items()
            if not output.may_be_undefined
        )
        return int(np.count_nonzero(failed_rows(chunk.status, required)))


def ended(status: NDArray[np.int8]) -> dict[str, int]:
    """Return how many rows ended how."""
    codes, counts = np.unique(status, return_counts=True)
    return {Status(code).label: int(n) for code, n in zip(codes, counts, strict=True)}


def joined_failures(first: Failures, second: Failures) -> Failures:
    """Return the first failure of each status in either."""
    return first | {
        label: min(failure, first.get(label, failure)) for label, failure in second.items()
    }


def row_bytes(workload: "Workload | Study") -> int:
    """Return about how many bytes a row takes, inputs and outputs."""
    columns = columns_of(workload.model, workload.settings).values()
    outputs = sum(column.dtype.itemsize * prod(column.shape) for column in columns)
    return 8 * len(workload.model.parameter_names) + 32 + outputs
