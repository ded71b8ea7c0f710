"""Chunk files: rows as the bytes of one structured array."""

import hashlib
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uq.files.whole_files import flush
from uq.result.workload import Workload
from uq.study.columns import columns_of
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
    """Return the parts that `pack` put together."""
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
    """Sort pieces, each its first row number and its rows; return their blocks and their rows."""
    ordered = sorted(pieces, key=lambda piece: piece[0])
    numbers = [np.arange(start, start + len(data)) for start, data in ordered]
    return blocks_of(np.concatenate(numbers)), [data for _, data in ordered]
