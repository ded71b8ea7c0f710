"""Rows of a run: packed into arrays and chunk files, counted, and kept in memory."""

import hashlib
import os
from collections import Counter
from collections.abc import Mapping, Sequence
from math import prod
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Status
from uq.files.whole_files import flush
from uq.result.workload import Preview, Workload
from uq.study.definition import Study
from uq.study.evaluate import Chunk, columns_of, examples_of, failed_rows
from uq.study.row_sampling import Rows

Block = tuple[int, int]
"""Number of the first row, and of the row after the last."""


def row_type(workload: Workload) -> np.dtype[Any]:
    """Return the type of one row: its place in the design, its inputs, outputs and status."""
    columns = columns_of(workload.model, workload.settings)
    rows = [
        ("x", np.float64, (len(workload.model.parameter_names),)),
        ("seed", np.uint64),
        ("replicate", np.int32),
        ("group", np.int64),
        ("block", np.int16),
    ]
    outputs = [(name, column.dtype, column.shape) for name, column in columns.items()]
    return np.dtype([("rows", rows), ("columns", outputs), ("status", np.int8)])


def pack(
    kind: np.dtype[Any], rows: Rows, columns: Mapping[str, NDArray[Any]], status: NDArray[np.int8]
) -> NDArray[Any]:
    """Return rows as one structured array."""
    data = np.empty(len(status), kind)
    for field, part in rows._asdict().items():
        data["rows"][field] = part
    for name in kind["columns"].names or ():
        data["columns"][name] = columns[name]
    data["status"] = status
    return data


def unpack(data: NDArray[Any]) -> tuple[Rows, dict[str, NDArray[Any]], NDArray[np.int8]]:
    """Split a structured array from `pack` into rows, columns and status."""
    rows = Rows(*(np.ascontiguousarray(data["rows"][field]) for field in Rows._fields))
    columns = {
        name: np.ascontiguousarray(data["columns"][name])
        for name in data.dtype["columns"].names or ()
    }
    return rows, columns, np.ascontiguousarray(data["status"])


def save(path: Path, *pieces: NDArray[Any]) -> str:
    """Write a chunk file, completely or not at all, and return its SHA-256.

    Parameters
    ----------
    path : Path
    *pieces : ndarray
        Rows, one piece after the other; they are not copied.

    Raises
    ------
    OSError
        Nothing is left behind then.
    """
    checksum = hashlib.sha256()
    temporary = path.with_suffix(".part")
    try:
        with temporary.open("wb") as file:
            for piece in pieces:
                content = piece.view(np.uint8).data
                checksum.update(content)
                file.write(content)
        flush(temporary)
        os.replace(temporary, path)
        flush(path.parent)
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
    return checksum.hexdigest()


def load(path: Path, kind: np.dtype[Any], rows: int, sha256: str) -> NDArray[Any] | None:
    """Read a chunk file; None if it is missing or not as written."""
    try:
        if path.stat().st_size != rows * kind.itemsize:
            return None
        content = path.read_bytes()
    except OSError:
        return None
    sound = hashlib.sha256(content).hexdigest() == sha256
    return np.frombuffer(content, kind) if sound else None


def blocks_of(numbers: NDArray[np.int64]) -> list[Block]:
    """Return ascending row numbers as blocks of adjacent rows."""
    ends = np.flatnonzero(np.diff(numbers) > 1)
    firsts = numbers[np.concatenate([[0], ends + 1])]
    lasts = numbers[np.concatenate([ends, [-1]])]
    return [(int(a), int(b) + 1) for a, b in zip(firsts, lasts, strict=True)]


def in_order(
    pieces: Sequence[tuple[int, NDArray[Any]]],
) -> tuple[list[Block], list[NDArray[Any]]]:
    """Sort pieces by first row number; return their blocks and their rows."""
    ordered = sorted(pieces, key=lambda piece: piece[0])
    numbers = [np.arange(start, start + len(data)) for start, data in ordered]
    return blocks_of(np.concatenate(numbers)), [data for _, data in ordered]


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
        Rows that have arrived.
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
        See `uq.execution.tally.row_type`.
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
        """Message on the wrong shape, if every row so far has a wrong shape."""
        label = Status.BAD_SHAPE.label
        return self.failures[label][1] if 0 < self.status[label] == self.done else None

    @property
    def examples(self) -> dict[str, str]:
        """Status label -> message of the first row with that status."""
        return examples_of(self.failures)

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
        """Add rows to the counts."""
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
    """Return the approximate size of a row, inputs and outputs [bytes]."""
    columns = columns_of(workload.model, workload.settings).values()
    outputs = sum(column.dtype.itemsize * prod(column.shape) for column in columns)
    return 8 * len(workload.model.parameter_names) + 32 + outputs
