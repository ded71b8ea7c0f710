"""Folders of rows: one for each, removed when the row is done and kept when it failed."""

import hashlib
import os
import shutil
import socket
import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path

import psutil

_RUNNING = "running"
_LARGEST_KEPT = 10_000_000  # bytes of a file of a row that failed


def _lighten(folder: Path) -> None:
    """Remove the large files of a row that failed, which could fill the disk."""
    for file in folder.rglob("*"):
        if not file.is_symlink() and file.is_file() and file.stat().st_size > _LARGEST_KEPT:
            file.unlink()


class Folders:
    """The folders of the rows of a machine, in one folder.

    Parameters
    ----------
    root : Path
    """

    def __init__(self, root: Path):
        self.root = root
        self._tidied = False

    @contextmanager
    def row(self, numbers: Sequence[float | int]) -> Iterator[Path]:
        """Yield the folder of a row, empty; if the block raises, it is kept under the row's name.

        Parameters
        ----------
        numbers : sequence of float
            The row: its parameters and seed.
        """
        if not self._tidied:
            self._tidied = True
            self._tidy()
        folder = self._new()
        try:
            yield folder
        except Exception:
            kept = self.kept(numbers)
            shutil.rmtree(kept, ignore_errors=True)
            with suppress(OSError):
                _lighten(folder)
                folder.rename(kept)
            raise
        finally:
            shutil.rmtree(folder, ignore_errors=True)

    def _new(self) -> Path:
        """Return a new folder of this process."""
        mine = f"{_RUNNING}-{socket.gethostname()}-{os.getpid()}-"
        while True:
            self.root.mkdir(parents=True, exist_ok=True)
            with suppress(FileNotFoundError):  # another process has just left
                return Path(tempfile.mkdtemp(prefix=mine, dir=self.root))

    def leave(self) -> None:
        """Remove folders that killed processes left, and that of all folders if it holds none."""
        self._tidy()
        with suppress(OSError):
            self.root.rmdir()

    def kept(self, numbers: Sequence[float | int]) -> Path:
        """Return the folder in which a row is kept that failed."""
        digest = hashlib.sha256(repr(list(numbers)).encode()).hexdigest()
        return self.root / f"failed-{digest[:12]}"

    def _tidy(self) -> None:
        """Remove the folders of processes on this computer that were killed."""
        for folder in self.root.glob(f"{_RUNNING}-{socket.gethostname()}-*"):
            pid = folder.name.removeprefix(f"{_RUNNING}-{socket.gethostname()}-").split("-")[0]
            if pid.isdigit() and not psutil.pid_exists(int(pid)):
                shutil.rmtree(folder, ignore_errors=True)
