"""The folder beside a result in which its rows are kept until it is complete."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from uq.errors import InputError, RunError
from uq.interrupts import undone
from uq.places import file_behind
from uq.store.files import flush, reason, remove_empty
from uq.store.journal import read
from uq.store.records import RowsRecord, RunRecord, understood

JOURNAL, LOCK = "journal", "lock"
_LOCK_SECONDS = 0.5  # some disks need a second attempt to take over a lock


class Holder(NamedTuple):
    """The process that writes into a folder, as filelock names it.

    Attributes
    ----------
    host : str
        In a container with its number space for processes: "name?pidns-number".
    pid : int
    """

    host: str
    pid: int

    @property
    def computer(self) -> str:
        """Name of the computer alone."""
        return self.host.partition("?")[0]


def folder_of(path: Path) -> Path:
    """Return the folder in which the rows of a result are kept, beside the file itself."""
    file = file_behind(path)
    return file.with_name(f"{file.name}.rows")


def history(folder: Path) -> list[RunRecord | RowsRecord]:
    """Return what the journal of a folder says; nothing if no run ever began there."""
    try:
        records = understood(read(folder / JOURNAL))
    except OSError as error:
        raise InputError(f"{folder / JOURNAL}: cannot be read: {error.strerror}") from None
    return records if any(isinstance(record, RunRecord) for record in records) else []


def holder(folder: Path) -> Holder | None:
    """Return who wrote the lock of a folder, whether that process is alive or not."""
    try:
        pid, host = (folder / LOCK).read_text("utf-8", "replace").splitlines()[:2]
        return Holder(host, int(pid))
    except (OSError, ValueError):
        return None


def is_held(folder: Path) -> bool:
    """Return whether a process has the lock of a folder, or may have it on another computer.

    One that has ended does not, though its number may be in use again: a copy of the lock is tried
    to be taken over, which disturbs nobody.
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
    """Make a folder if need be, and be the only one to write into it.

    A lock whose process is gone is taken over. A folder that holds nothing at the end is removed,
    with those above it that were made for its sake.

    Parameters
    ----------
    folder : Path

    Raises
    ------
    InputError
        When another process holds the lock.
    RunError
        When the folder cannot be made.
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
            raise RunError(f"{folder}: could not be made: {reason(error, folder)}") from None
        yield


def _held(folder: Path) -> str:
    held = holder(folder)
    if held is None:
        return f"{folder}: in use by another process; if there is none, remove {folder / LOCK}"
    line = f"{folder}: in use by process {held.pid} on {held.computer}"
    if held.host != _this_host():
        line += f"; if that has ended, remove {folder / LOCK}"
    return line


def _this_host() -> str:
    from filelock import SoftFileLock

    with TemporaryDirectory(prefix="uq-") as place, SoftFileLock(Path(place) / LOCK):
        held = holder(Path(place))
        return held.host if held else ""


def clear(folder: Path) -> None:
    """Remove all that is kept in a folder; the journal first, for without it nothing counts."""
    (folder / JOURNAL).unlink(missing_ok=True)
    for file in folder.iterdir():
        if file.name != LOCK and file.is_file():
            file.unlink()
