"""Where the rows of a run are kept, and the one file they become.

`Store` collects chunks in any order; `write` puts a Dataset on disk whole or not at all.
"""

import os
import shutil
import tempfile
from math import prod
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from uq.columns import blank_rows, columns_of, failed_rows
from uq.contract import Status
from uq.errors import InputError, RunError
from uq.interrupts import undone
from uq.sampling import Rows
from uq.work import Work

if TYPE_CHECKING:
    from uq.evaluate import Chunk
    from uq.study import Study


class Store:
    """The rows of one run, as they arrive.

    Parameters
    ----------
    work : Work

    Attributes
    ----------
    total : int
        Rows of the whole run.
    done : int
        Rows that have arrived.
    failed : int
        Rows among them that failed.
    """

    def __init__(self, work: Work) -> None:
        self.work = work
        self.total = total = work.total
        self.done = 0
        self.failed = 0
        d = len(work.model.parameter_names)
        self._rows = Rows(
            x=np.empty((total, d)),
            seed=np.empty(total, dtype=np.uint64),
            replicate=np.empty(total, dtype=np.int32),
            group=np.empty(total, dtype=np.int64),
            block=np.empty(total, dtype=np.int16),
        )
        self._columns = blank_rows(columns_of(work.model, work.settings), total)
        self._status = np.zeros(total, dtype=np.int8)
        self._failures: dict[str, tuple[int, str]] = {}

    def add(self, start: int, rows: Rows, chunk: "Chunk") -> None:
        """Keep the rows from `start` on.

        Parameters
        ----------
        start : int
        rows : Rows
        chunk : Chunk
        """
        stop = start + len(chunk.status)
        for field, part in rows._asdict().items():
            getattr(self._rows, field)[start:stop] = part
        for name, whole in self._columns.items():
            whole[start:stop] = chunk.columns[name]
        self._status[start:stop] = chunk.status
        for label, failure in chunk.failures.items():
            self._failures[label] = min(failure, self._failures.get(label, failure))
        self.done += stop - start
        required = (
            (output.kind, chunk.columns[name])
            for name, output in self.work.model.outputs.items()
            if not output.may_be_undefined
        )
        self.failed += int(np.count_nonzero(failed_rows(chunk.status, required)))

    @property
    def shapes_all_wrong(self) -> str | None:
        """What is wrong with the shape of every row so far, if every row has a wrong shape."""
        label = Status.BAD_SHAPE.label
        wrong = label in self._failures and np.count_nonzero(self._status == Status.BAD_SHAPE)
        return self._failures[label][1] if wrong and wrong == self.done else None

    def dataset(self) -> xr.Dataset:
        """Return the result of a run whose rows have all arrived."""
        examples = {
            label: f"row {self.work.first + row}: {text}"
            for label, (row, text) in self._failures.items()
        }
        return self.work.finish(self._rows, self._columns, self._status, examples)


def row_bytes(work: "Work | Study") -> int:
    """Return about how many bytes a row takes, inputs and outputs."""
    columns = columns_of(work.model, work.settings).values()
    outputs = sum(column.dtype.itemsize * prod(column.shape) for column in columns)
    return 8 * len(work.model.parameter_names) + 32 + outputs


def check_target(path: Path, size: int) -> None:
    """Refuse, before anything is computed, a path that cannot be written.

    Parameters
    ----------
    path : Path
    size : int
        Expected size of the file [bytes].

    Raises
    ------
    InputError
    """
    if path.is_dir():
        raise InputError(f"{path}: is a folder; give the name of a file in it")
    folder = next(parent for parent in path.absolute().parents if parent.exists())
    if not folder.is_dir():
        raise InputError(f"{path}: {folder} is a file, not a folder")
    try:
        with tempfile.TemporaryFile(dir=folder):
            pass
    except OSError as error:
        raise InputError(f"{path}: cannot write in {folder}: {error.strerror}") from None
    free = shutil.disk_usage(folder).free
    if free < size:
        raise InputError(
            f"{path}: the result takes about {size / 1e6:.0f} MB, "
            f"and {folder} has {free / 1e6:.0f} MB left"
        )


def write(ds: xr.Dataset, path: Path) -> None:
    """Write a Dataset as netCDF4 under a temporary name, then rename it.

    Parameters
    ----------
    ds : xarray.Dataset
    path : Path
        Missing folders are made.

    Raises
    ------
    RunError
        When it cannot be written; then nothing is left behind.
    """
    made = [folder for folder in path.absolute().parents if not folder.exists()]
    temporary = path.with_name(f".{path.name}.{os.getpid()}.part")

    def clear() -> None:
        temporary.unlink(missing_ok=True)
        for folder in made:
            if folder.exists() and not any(folder.iterdir()):
                folder.rmdir()

    with undone(clear):
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            ds.to_netcdf(temporary, engine="netcdf4", format="NETCDF4")
            _flush(temporary)
            os.replace(temporary, path)
            _flush(path.parent)
        except (OSError, RuntimeError) as error:
            raise RunError(f"{path}: could not be written: {_reason(error, path)}") from None


def _flush(path: Path) -> None:
    handle = os.open(path, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)


def _reason(error: Exception, path: Path) -> str:
    """Say why a write failed: HDF5 reports a full disk as "HDF error"."""
    if isinstance(error, OSError) and error.strerror:
        return error.strerror
    folder = next(parent for parent in path.absolute().parents if parent.exists())
    return f"{error} ({shutil.disk_usage(folder).free / 1e6:.0f} MB left on the disk)"
