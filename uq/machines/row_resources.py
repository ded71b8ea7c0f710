"""Resources of a row of a program: its folder, and child processes, which end with it."""

import ctypes
import hashlib
import os
import resource
import select
import shutil
import socket
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from stat import S_ISREG

_PR_SET_CHILD_SUBREAPER = 36
_SECONDS = 5.0

LARGEST = 10_000_000_000
"""Bytes of a file that a program may write, where the disk has room for several."""

_SHARE = 4  # of the room that is left, for a file

_adopting = False
_judge = os.getpid()


def adopt() -> None:
    """Become the parent of orphaned descendants (child subreaper, Linux only).

    For a process whose descendants all belong to rows, so that `end_descendants` may end them.
    """
    global _adopting, _judge
    _adopting, _judge = True, os.getppid()
    if sys.platform == "linux":
        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def judge() -> int:
    """Return the process that keeps or removes the folder if a row crashes this process."""
    return _judge if _adopting else os.getpid()


def bound_files(folder: Path) -> int:
    """Bound the files that this process and its descendants can write, where it adopts.

    Parameters
    ----------
    folder : Path
        On the disk to which they write.

    Returns
    -------
    int
        The largest size [bytes].
    """
    most = min(LARGEST, shutil.disk_usage(folder).free // _SHARE)
    _, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    if hard != resource.RLIM_INFINITY:
        most = min(most, hard)
    if _adopting:
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, hard))
    return most


def ended_within(process: subprocess.Popen[bytes], seconds: float) -> bool:
    """Wait for a process up to a time limit; return whether it has ended."""
    seconds = max(seconds, 0.0)
    if sys.platform == "linux":
        with suppress(OSError):
            descriptor = os.pidfd_open(process.pid)
            try:
                poll = select.poll()
                poll.register(descriptor, select.POLLIN)
                return bool(poll.poll(1000 * seconds))
            finally:
                os.close(descriptor)
    try:
        process.wait(seconds)  # on other systems it polls with increasing intervals
    except subprocess.TimeoutExpired:
        return False
    return True


def end_descendants() -> None:
    """End all descendants of this process, where it adopts; else do nothing."""
    if not _adopting or not _has_children():
        return
    import psutil

    left = psutil.Process().children(recursive=True)
    for descendant in left:
        with suppress(psutil.NoSuchProcess):
            descendant.kill()
    psutil.wait_procs(left, timeout=_SECONDS)


def end_with_descendants(pid: int) -> None:
    """End a child of this process and all that descends from it."""
    import psutil

    with suppress(psutil.NoSuchProcess):
        process = psutil.Process(pid)
        for descendant in (process, *process.children(recursive=True)):
            with suppress(psutil.NoSuchProcess):
                descendant.kill()


def _has_children() -> bool:
    try:
        files = [task / "children" for task in Path(f"/proc/{os.getpid()}/task").iterdir()]
        return any(file.read_bytes() for file in files)
    except OSError:
        return True


_RUNNING = "running"
_BLOCK = 512  # bytes, in which the room that a file takes is counted
_MOST_KEPT = 10_000_000  # bytes of a row that failed
_SHARE_KEPT = 100  # of the room on the disk, if that is less: many rows may fail


def size_of(folder: Path) -> int:
    """Return the size of the files in a folder [bytes]."""
    return sum(_sizes(folder).values())


def _sizes(folder: Path) -> dict[Path, int]:
    sizes = {}
    for file in folder.rglob("*"):
        with suppress(OSError):  # it has just been removed
            status = file.lstat()
            if S_ISREG(status.st_mode):
                sizes[file] = min(status.st_size, _BLOCK * status.st_blocks)
    return sizes


def _lighten(folder: Path, passing: str) -> None:
    """Remove a passing folder and the largest files of a failed row, which would fill the disk."""
    if passing:
        shutil.rmtree(folder / passing, ignore_errors=True)
    sizes = _sizes(folder)
    left = sum(sizes.values())
    most = min(_MOST_KEPT, (shutil.disk_usage(folder).free + left) // _SHARE_KEPT)
    for file in sorted(sizes, key=lambda path: sizes[path], reverse=True):
        if left > most:
            file.unlink()
            left -= sizes[file]


ROWS_OF_JOB = "VIBROLIFE_ROWS_OF_JOB"
"""Environment variable of a job of a queue: the folder in which it computes its rows. The run
removes it, as a job that is killed cannot."""


class Folders:
    """The folders of the rows of a machine, in one folder.

    Parameters
    ----------
    root : Path
        Where they are computed, but in a job, and where those that failed are kept.
    passing : str
        Name of a folder in each that is not kept.
    """

    def __init__(self, root: Path, passing: str = ""):
        self.root = root
        self._passing = passing
        self._tidied = False

    @contextmanager
    def row(self, numbers: Sequence[float | int]) -> Iterator[Path]:
        """Yield the folder of a row, empty; if the block raises, it is kept, and the error says so.

        Parameters
        ----------
        numbers : sequence of float
            The row: its parameters and seed.
        """
        if not self._tidied:
            self._tidied = True
            self._tidy()
        folder = self._new(numbers)
        try:
            yield folder
        except Exception as error:
            self._keep(folder, numbers)
            error.args = (f"{error}; see {self.kept(numbers)}",)
            raise
        else:
            shutil.rmtree(self.kept(numbers), ignore_errors=True)  # of an earlier run
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _new(self, numbers: Sequence[float | int]) -> Path:
        """Return a new folder of this process."""
        mine = f"{_running_on_this()}{judge()}-{os.getpid()}-{_digest(numbers)}-"
        if self._running != self.root:  # it is not made again after the end of the run
            return Path(tempfile.mkdtemp(prefix=mine, dir=self._running))
        while True:
            self.root.mkdir(parents=True, exist_ok=True)
            with suppress(FileNotFoundError):  # another process has just left
                return Path(tempfile.mkdtemp(prefix=mine, dir=self.root))

    @property
    def _running(self) -> Path:
        """Return the folder of rows that are computed."""
        return Path(os.environ.get(ROWS_OF_JOB, self.root))

    def leave(self) -> None:
        """Remove folders that killed processes left, and the root if it is empty."""
        self._tidy()
        with suppress(OSError):
            self.root.rmdir()

    def kept(self, numbers: Sequence[float | int]) -> Path:
        """Return the folder in which a row is kept that failed."""
        return self.root / f"failed-{_digest(numbers)}"

    def keep(self, numbers: Sequence[float | int]) -> Path | None:
        """Keep the folder of a row that ended a child of this process; return its path."""
        kept = self.kept(numbers)
        mine = f"{_running_on_this()}{os.getpid()}-*-{_digest(numbers)}-*"
        for folder in self._running.glob(mine):
            self._keep(folder, numbers)
        return kept if kept.is_dir() else None

    def _keep(self, folder: Path, numbers: Sequence[float | int]) -> None:
        kept = self.kept(numbers)
        shutil.rmtree(kept, ignore_errors=True)
        with suppress(OSError):
            _lighten(folder, self._passing)
            self.root.mkdir(exist_ok=True)
            folder.rename(kept)

    def _tidy(self) -> None:
        """Remove the folders of processes on this computer that were killed.

        While the process that judges a row lives, it may want to keep its folder.
        """
        import psutil

        for folder in self._running.glob(f"{_running_on_this()}*"):
            judge, pid, *_ = folder.name.removeprefix(_running_on_this()).split("-")
            mine = int(judge) == os.getpid()
            if not psutil.pid_exists(int(pid)) and (mine or not psutil.pid_exists(int(judge))):
                shutil.rmtree(folder, ignore_errors=True)


def _running_on_this() -> str:
    """Return the beginning of the names of folders of running rows on this computer."""
    return f"{_RUNNING}-{socket.gethostname()}-"


def _digest(numbers: Sequence[float | int]) -> str:
    return hashlib.sha256(repr(list(numbers)).encode()).hexdigest()[:12]
