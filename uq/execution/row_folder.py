"""Folder beside a result that keeps its rows, the records of its journal, and its progress."""

import shutil
from bisect import bisect_left
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, Any, Literal, NamedTuple

import numpy as np
from numpy.typing import NDArray
from pydantic import AfterValidator, BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from uq.errors import InputError, RunError
from uq.execution.tally import Block, Failures, by_status
from uq.files.interrupts import undone
from uq.files.journal import Record, read
from uq.files.whole_files import file_behind, flush, reason, remove_empty
from uq.result import result_file

Count = Annotated[int, Field(ge=0, lt=2**62)]


class RunRecord(BaseModel):
    """A run that started or resumed.

    Attributes
    ----------
    time : float
        When [s since 1970].
    host, pid
        The process.
    identity, study, model_version, samples
        What is to be computed, as in the attributes of a result.
    rows : int
        Total number of rows.
    row_type : str
        Layout of a row in the chunk files.
    again : bool
        Whether the run recomputes failed rows of a complete result.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: Literal["run"] = "run"
    time: float
    host: str
    pid: int
    identity: str
    study: str
    model_version: str
    samples: Count
    rows: Count
    row_type: str
    again: bool


def _ascending(blocks: tuple[Block, ...]) -> tuple[Block, ...]:
    edges = [edge for block in blocks for edge in block]
    if edges != sorted(edges) or any(start == stop for start, stop in blocks):
        raise ValueError("blocks are empty, overlap or do not ascend")
    return blocks


class RowsRecord(BaseModel):
    """Rows in a chunk file.

    Attributes
    ----------
    time : float
        When they were written [s since 1970].
    blocks : tuple of (int, int)
        First row and end of each block (end excluded), in ascending order.
    sha256 : str
        Checksum of the file.
    failed : int
    status : dict of str to int
        Status label -> rows.
    failures : Failures
    made : dict of str to str
        Processor and versions that computed them.
    settings : dict
        Settings that differ from the study's.
    """

    model_config = ConfigDict(extra="forbid", frozen=True)

    kind: Literal["rows"] = "rows"
    time: float
    blocks: Annotated[
        tuple[tuple[Count, Count], ...], Field(min_length=1), AfterValidator(_ascending)
    ]
    sha256: str
    failed: Count
    status: dict[str, Count]
    failures: Failures
    made: dict[str, str]
    settings: dict[str, Any]

    @property
    def rows(self) -> int:
        """Number of rows."""
        return sum(stop - start for start, stop in self.blocks)

    @property
    def numbers(self) -> NDArray[np.int64]:
        """Numbers of the rows, in the order of the file."""
        return np.concatenate([np.arange(*block) for block in self.blocks])


class History(NamedTuple):
    """The records of a journal in which a run has started.

    Attributes
    ----------
    run : RunRecord
        The latest run.
    chunks : list of RowsRecord
        Rows of all runs.
    latest : list of RowsRecord
        Rows of the latest run.
    """

    run: RunRecord
    chunks: list[RowsRecord]
    latest: list[RowsRecord]

    @property
    def kept(self) -> list[RowsRecord]:
        """Valid records, each row once."""
        return without_overlap(self.chunks, self.run.rows)

    @property
    def complete(self) -> bool:
        """Whether all rows are present."""
        return not missing(self.kept, self.run.rows)


_RECORD: TypeAdapter[RunRecord | RowsRecord] = TypeAdapter(
    Annotated[RunRecord | RowsRecord, Field(discriminator="kind")]
)


def understood(records: Sequence[Record]) -> list[RunRecord | RowsRecord]:
    """Return the valid records of a journal."""
    valid = []
    for record in records:
        with suppress(ValidationError):
            valid.append(_RECORD.validate_python(record))
    return valid


def history_of(records: Sequence[Record]) -> History | None:
    """Return the history recorded in a journal; None if no run has started."""
    run, chunks, before = None, list[RowsRecord](), 0
    for record in understood(records):
        if isinstance(record, RowsRecord):
            chunks.append(record)
        else:
            run, before = record, len(chunks)
    return History(run, chunks, chunks[before:]) if run else None


def without_overlap(records: Sequence[RowsRecord], total: int) -> list[RowsRecord]:
    """Return the latest records of rows within 0..total that no later record covers."""
    kept: list[RowsRecord] = []
    taken: list[Block] = []
    for record in reversed(records):
        end = record.blocks[-1][1]
        if end <= total and all(_is_free(taken, *block) for block in record.blocks):
            kept.append(record)
            taken = sorted([*taken, *record.blocks])
    return sorted(kept, key=lambda record: record.blocks)


def _is_free(taken: Sequence[Block], start: int, stop: int) -> bool:
    """Return whether a block is disjoint from the given ascending blocks."""
    place = bisect_left(taken, (stop, 0))
    return not place or taken[place - 1][1] <= start


def missing(records: Sequence[RowsRecord], total: int) -> list[Block]:
    """Return the blocks of rows missing from non-overlapping records."""
    blocks = sorted(block for record in records for block in record.blocks)
    edges = [0, *(edge for block in blocks for edge in block), total]
    return [(a, b) for a, b in zip(edges[::2], edges[1::2], strict=True) if a < b]


JOURNAL, LOCK = "journal", "lock"
_LOCK_SECONDS = 0.5  # some disks need a second attempt to take a lock over


def folder_of(path: Path) -> Path:
    """Return the folder that keeps the rows of a result, beside the file itself."""
    file = file_behind(path)
    return file.with_name(f"{file.name}.rows")


def history(folder: Path) -> History | None:
    """Return the history recorded in the journal of a folder; None if no run has started."""
    try:
        return history_of(read(folder / JOURNAL))
    except OSError as error:
        raise InputError(f"{folder / JOURNAL}: cannot be read: {error.strerror}") from None


def holder(folder: Path) -> tuple[str, int] | None:
    """Return host and number of the process that wrote the lock of a folder, alive or not.

    The host is as filelock names it, in a container with its process namespace:
    "name?pidns-number".
    """
    try:
        pid, host = (folder / LOCK).read_text("utf-8", "replace").splitlines()[:2]
        return host, int(pid)
    except (OSError, ValueError):
        return None


def computer(host: str) -> str:
    """Return the name of the computer alone of a host, as filelock names it."""
    return host.partition("?")[0]


def is_held(folder: Path) -> bool:
    """Return whether a process holds the lock of a folder, or may hold it on another computer.

    A terminated process holds no lock, even if its process id is reused: the check tries to take
    over a copy of the lock, without side effects.
    """
    from filelock import SoftFileLock, Timeout

    with TemporaryDirectory(prefix="uq-") as place:
        copy = Path(place) / LOCK
        try:
            shutil.copyfile(folder / LOCK, copy)
            with SoftFileLock(copy, timeout=_LOCK_SECONDS):
                return False
        except FileNotFoundError:
            return False
        except Timeout:
            return True


@contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Create a folder if needed and lock it for exclusive writing.

    The lock of a terminated process is taken over. A folder that is empty at the end is removed,
    with those above it that were created with it.

    Parameters
    ----------
    folder : Path

    Raises
    ------
    InputError
        When another process holds the lock.
    RunError
        When the folder cannot be created.
    """
    from filelock import SoftFileLock, Timeout

    made = [folder, *(parent for parent in folder.absolute().parents if not parent.exists())]
    lock = SoftFileLock(folder / LOCK)

    def release() -> None:
        lock.release(force=True)
        with suppress(OSError):
            remove_empty(made)

    with undone(release):
        try:
            folder.mkdir(parents=True, exist_ok=True)
            flush(folder.parent)
            lock.acquire(timeout=_LOCK_SECONDS)
        except Timeout:
            raise InputError(_held(folder)) from None
        except OSError as error:
            raise RunError(f"{folder}: could not be created: {reason(error, folder)}") from None
        yield


def _held(folder: Path) -> str:
    held = holder(folder)
    if held is None:
        return f"{folder}: in use by another process; if there is none, remove {folder / LOCK}"
    from filelock import SoftFileLock

    host, pid = held
    with TemporaryDirectory(prefix="uq-") as place, SoftFileLock(Path(place) / LOCK):
        here = holder(Path(place))
    line = f"{folder}: in use by process {pid} on {computer(host)}"
    if here is None or host != here[0]:
        line += f"; if that has ended, remove {folder / LOCK}"
    return line


def clear(folder: Path) -> None:
    """Remove all rows in a folder; the journal first, because without it nothing counts."""
    (folder / JOURNAL).unlink(missing_ok=True)
    for file in folder.iterdir():
        if file.name != LOCK and file.is_file():
            file.unlink()


@dataclass(frozen=True)
class RunStatus:
    """Progress of a run.

    Attributes
    ----------
    output : str
        Path of the result.
    state : {"complete", "running", "interrupted"}
    rows : int
        Total; of them `done`, `failed` and `left`.
    status : dict of str to int
        Status label -> rows.
    rate : float or None
        Of the latest run [rows/s]; None if unknown.
    seconds_left : float or None
        Until completion at this rate [s].
    process : dict or None
        ``host`` and ``pid`` of the process that is writing.
    complete_rows : int or None
        Rows of an existing result.
    """

    output: str
    state: str
    rows: int
    done: int
    failed: int
    left: int
    status: Mapping[str, int]
    rate: float | None
    seconds_left: float | None
    process: dict[str, Any] | None
    complete_rows: int | None


def run_status(path: Path) -> RunStatus:
    """Return the progress of the run of a result.

    Parameters
    ----------
    path : Path
        Of the result, existing or not.

    Raises
    ------
    InputError
        When there are neither a result nor rows kept for one.
    """
    folder = folder_of(path)
    run_history = history(folder)
    held, process = holder(folder), None
    if held and is_held(folder):
        process = {"host": computer(held[0]), "pid": held[1]}
    complete_rows = None
    if path.is_file() or not run_history:
        ds = result_file.open_result(path)
        complete_rows = ds.sizes["row"]
        if not run_history or run_history.complete:
            failed, status = int(result_file.failed(ds).sum()), by_status(ds["status"].values)
            counts = complete_rows, complete_rows, failed, 0, status
            return RunStatus(str(path), "complete", *counts, None, None, process, complete_rows)
    kept, latest = run_history.kept, run_history.latest
    # From the first rows on, if there are others: before them, the model may have been compiled.
    began, since = (latest[0].time, latest[1:]) if latest[1:] else (run_history.run.time, latest)
    seconds = since[-1].time - began if since else 0.0
    rate = sum(record.rows for record in since) / seconds if seconds > 0 else None
    total, done = run_history.run.rows, sum(record.rows for record in kept)
    failed, left = sum(record.failed for record in kept), total - done
    by_label: Counter[str] = Counter()
    for record in kept:
        by_label.update(record.status)
    state, seconds_left = "running" if process else "interrupted", left / rate if rate else None
    counts = total, done, failed, left, dict(by_label)
    return RunStatus(str(path), state, *counts, rate, seconds_left, process, complete_rows)
