"""End of the processes that a program leaves behind."""

import ctypes
import os
import resource
import select
import shutil
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

_PR_SET_CHILD_SUBREAPER = 36
_SECONDS = 5.0

LARGEST = 10_000_000_000
"""Bytes of a file that a program may write, where the disk has room for several."""

_SHARE = 4  # of the room that is left, for a file

_adopting = False
_judge = os.getpid()


def adopt() -> None:
    """Become, on Linux, the parent of all descendants whose own parent ends.

    For a process whose descendants all belong to rows, so that `end_descendants` may end them.
    """
    global _adopting, _judge
    _adopting, _judge = True, os.getppid()
    if sys.platform == "linux":
        with suppress(OSError, AttributeError):
            ctypes.CDLL(None).prctl(_PR_SET_CHILD_SUBREAPER, 1, 0, 0, 0)


def judge() -> int:
    """Return the process that keeps or removes the folder of a row that ends this process."""
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
    """Wait for a process, for some seconds at most; return whether it has ended."""
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
        process.wait(seconds)  # elsewhere it looks again and again, ever more seldom
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
