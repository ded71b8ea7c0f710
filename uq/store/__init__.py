"""Where the rows of a run are kept, and the file they become.

A run with an output file keeps its rows on disk as they arrive, beside the future result, in the
folder ``OUT.nc.rows``:

- chunk files: the rows of one or more blocks, as the bytes of one structured array. Each is written
  once, under a temporary name, flushed to the disk and renamed.
- ``journal``: one line per chunk file, with its SHA-256 and what computed it, and one per run.
  Lines are only ever appended. A file that the journal does not name does not count.
- ``lock``: host and process that are writing.

When all rows are there, they are merged into the result, which takes its name in one step; then the
folder is removed.
"""

from uq.store.disk import DiskStore as DiskStore
from uq.store.files import check_target as check_target
from uq.store.files import write as write
from uq.store.files import write_result as write_result
from uq.store.folder import folder_of as folder_of
from uq.store.opening import drop_leftovers as drop_leftovers
from uq.store.opening import keep as keep
from uq.store.tally import MemoryStore as MemoryStore
from uq.store.tally import row_bytes as row_bytes
