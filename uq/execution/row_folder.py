"""The folder beside a result that keeps its rows until it is complete."""

import shutil
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryDirectory

from uq.errors import InputError, RunError
from uq.execution.records import History, history_of
from uq.files.interrupts import undone
from uq.files.journal import read
from uq.files.paths import file_behind
from uq.files.whole_files import flush, reason, remove_empty

JOURNAL, LOCK = "journal", "lock"
_LOCK_SECONDS = 0.5  # some disks need a second attempt to take a lock over


def folder_of(path: Path) -> Path:
    """Return the folder that keeps the rows of a result, beside the file itself."""
    file = file_behind(path)
    return file.with_name(f"{file.name}.rows")


def history(folder: Path) -> History | None:
    """Return what the journal of a folder records; None if no run has started there."""
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

    A process that has ended does not, even if its number is in use again: this tries to take over
    a copy of the lock, which disturbs nobody.
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
    """Create a folder if need be, and be the only process to write into it.

    The lock of a process that is gone is taken over. A folder that is empty at the end is removed,
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
