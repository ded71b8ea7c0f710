"""An append-only journal: one record per line, each with a checksum of its own.

A line that was cut by a crash, or damaged since, does not count; the others do.
"""

import json
import os
import zlib
from pathlib import Path
from typing import Any

Record = dict[str, Any]


class Journal:
    """A journal that is open for writing.

    Parameters
    ----------
    path : Path
        Made if it does not exist.

    Attributes
    ----------
    records : list of dict
        What it held when it was opened.
    """

    def __init__(self, path: Path) -> None:
        self.records = read(path)
        self._file = os.open(path, os.O_RDWR | os.O_CREAT, 0o666)
        self._end = os.fstat(self._file).st_size
        # A last line that was cut must not swallow the next.
        self._cut = self._end > 0 and os.pread(self._file, 1, self._end - 1) != b"\n"

    def append(self, record: Record) -> None:
        """Add a record; it is on the disk when this returns.

        Interrupted at any point, it may be called again with the same record.

        Raises
        ------
        OSError
            Then the journal is as it was before.
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
    """Return the sound records of a journal, also of one that is being written; none of no file."""
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
