"""Where the rows of a run are kept, and the one file they become.

A run that is to be written keeps its rows on disk as they arrive, beside the result to be, in the
folder ``OUT.nc.rows``:

- chunk files: the rows of one or more blocks, as the bytes of one structured array. They are
  written once, under a temporary name, flushed to the disk and renamed.
- ``journal``: one line per chunk file, with its SHA-256 and with what computed it, and one per
  run. Lines are only ever appended. What it does not name does not exist.
- ``lock``: host and process that write.

When all rows are there they are merged into the result, which takes its name in one step; then the
folder is removed.
"""

from uq.store.disk import DiskStore
from uq.store.files import check_target, write, write_result
from uq.store.folder import folder_of
from uq.store.memory import MemoryStore
from uq.store.opening import drop_leftovers, keep, size_kept
from uq.store.tally import Tally, row_bytes

__all__ = [
    "DiskStore",
    "MemoryStore",
    "Tally",
    "check_target",
    "drop_leftovers",
    "folder_of",
    "keep",
    "row_bytes",
    "size_kept",
    "write",
    "write_result",
]
