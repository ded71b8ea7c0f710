"""An append-only journal: one record per line, each with its own checksum.

A line cut by a crash, or damaged since, is ignored; the others count.
"""

import json
import os
import zlib
from pathlib import Path
from typing import Any

Record = dict[str, Any]


class Journal:
    """A journal open for writing.

    Parameters
    ----------
    path : Path
        Created if it does not exist.
    """

    def __init__(self, path: Path) -> None:
        self._file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        self._end = os.fstat(self._file).st_size
        # A cut last line must not swallow the next one.
        self._cut = self._end > 0 and os.pread(self._file, 1, self._end - 1) != b"\n"

    def append(self, record: Record) -> None:
        """Append a record, which is on the disk when this returns.

        Interrupted at any point, it may be called again with the same record.

        Raises
        ------
        OSError
            The journal is unchanged then.
        """
        line = (b"\n" if self._cut else b"") + _line(record)
        try:
            os.ftruncate(self._file, self._end)
            written = 0
            while written < len(line):
                written += os.pwrite(self._file, line[written:], self._end + written)
            os.fsync(self._file)
        except OSError:
            os.ftruncate(self._file, self._end)
            raise
        self._end += len(line)
        self._cut = False

    def close(self) -> None:
        """Close the file."""
        os.close(self._file)


def read(path: Path) -> list[Record]:
    """Return the valid records of a journal, also during writing; empty without a file."""
    try:
        lines = path.read_bytes().split(b"\n")
    except FileNotFoundError:
        return []
    return [record for line in lines if (record := _record(line)) is not None]


def _line(record: Record) -> bytes:
    text = json.dumps(record, ensure_ascii=True, separators=(",", ":")).encode()
    return b"%08x %s\n" % (zlib.crc32(text), text)


def _record(line: bytes) -> Record | None:
    check, _, text = line.partition(b" ")
    if check != b"%08x" % zlib.crc32(text):
        return None
    try:
        record = json.loads(text)
    except (ValueError, RecursionError):
        return None
    return record if isinstance(record, dict) else None
