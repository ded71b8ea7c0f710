"""Rows as the bytes of one structured array: what a chunk file holds."""

import hashlib
import os
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.rows.columns import Column
from uq.rows.sampling import Rows
from uq.store.files import flush

Block = tuple[int, int]
"""Numbers of the first row and of the one behind the last."""


class Piece(NamedTuple):
    """Adjacent rows, with inputs and outputs.

    Attributes
    ----------
    start : int
    data : ndarray
        Of the type that `row_type` returns.
    """

    start: int
    data: NDArray[Any]

    @property
    def stop(self) -> int:
        """Number of the row behind the last."""
        return self.start + len(self.data)


def row_type(parameters: int, columns: Mapping[str, Column]) -> np.dtype[Any]:
    """Return the type of one row: its place in the design, its inputs, what became of it."""
    rows = [
        ("x", np.float64, (parameters,)),
        ("seed", np.uint64),
        ("replicate", np.int32),
        ("group", np.int64),
        ("block", np.int16),
    ]
    outputs = [(name, column.dtype, column.shape) for name, column in columns.items()]
    return np.dtype([("rows", rows), ("columns", outputs), ("status", np.int8)])


def pack(
    kind: np.dtype[Any],
    rows: Rows,
    columns: Mapping[str, NDArray[Any]],
    status: NDArray[np.int8],
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
    names = data.dtype["columns"].names or ()
    columns = {name: np.ascontiguousarray(data["columns"][name]) for name in names}
    return rows, columns, np.ascontiguousarray(data["status"])


def save(path: Path, data: NDArray[Any]) -> str:
    """Write a chunk file, whole or not at all, and return its SHA-256.

    Raises
    ------
    OSError
        Then nothing is left behind.
    """
    content = data.tobytes()
    temporary = path.with_suffix(".part")
    try:
        temporary.write_bytes(content)
        flush(temporary)
        os.replace(temporary, path)
        flush(path.parent)
    except OSError:
        temporary.unlink(missing_ok=True)
        raise
    return hashlib.sha256(content).hexdigest()


def load(path: Path, kind: np.dtype[Any], rows: int, sha256: str) -> NDArray[Any] | None:
    """Read a chunk file; None if it is not there, or not what was written."""
    try:
        if path.stat().st_size != rows * kind.itemsize:
            return None
        content = path.read_bytes()
    except OSError:
        return None
    if hashlib.sha256(content).hexdigest() != sha256:
        return None
    return np.frombuffer(content, kind)


def joined(pieces: Sequence[Piece]) -> tuple[list[Block], NDArray[Any]]:
    """Put pieces into the order of their rows; return the blocks they make, and their rows."""
    ordered = sorted(pieces, key=lambda piece: piece.start)
    blocks: list[Block] = []
    for piece in ordered:
        if blocks and blocks[-1][1] == piece.start:
            blocks[-1] = blocks[-1][0], piece.stop
        else:
            blocks.append((piece.start, piece.stop))
    return blocks, np.concatenate([piece.data for piece in ordered])
