"""Dask worker processes on this computer.

They are plain child processes that import ``uq.running.dask_worker``, so that the calling script
needs no ``__main__`` guard; dask's scheduler runs in a thread of this process.
"""

import logging
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import dask
from dask.system import CPU_COUNT
from distributed import Client, LocalCluster

from uq.errors import RunError
from uq.interrupts import undone
from uq.running.environment import command, inherited
from uq.running.workers import Workers, quiet

CORES = CPU_COUNT
"""Cores this process may use: affinity and container limits included."""

_START_SECONDS = 60
_DEATHS_AT_MOST = 50  # between two chunks that arrive


@contextmanager
def local_workers(count: int) -> Iterator[Workers]:
    """Start `count` worker processes with one thread each, and end them.

    Parameters
    ----------
    count : int

    Yields
    ------
    Workers
        They connect in their own time; what is submitted before waits for them.
    """
    with ExitStack() as stack:
        folder = Path(tempfile.mkdtemp(prefix="uq-"))
        stack.enter_context(undone(lambda: shutil.rmtree(folder, ignore_errors=True)))
        settings = {
            "temporary-directory": str(folder),
            "distributed.scheduler.http.routes": [],
            "distributed.scheduler.allowed-failures": 2,  # the third worker killed ends a task
        }
        stack.enter_context(dask.config.set(settings))
        stack.enter_context(quiet())
        cluster = stack.enter_context(
            LocalCluster(
                n_workers=0,
                processes=True,
                threads_per_worker=1,
                host="127.0.0.1",
                # The port cannot be done without: one that is free, with nothing behind it.
                dashboard_address="127.0.0.1:0",
                scheduler_kwargs={"dashboard": False},
                silence_logs=logging.CRITICAL,
            )
        )
        client = stack.enter_context(Client(cluster, set_as_default=False, direct_to_workers=True))
        processes = _Processes(cluster.scheduler_address, folder)
        stack.enter_context(undone(processes.kill))
        for _ in range(count):
            processes.start()
        yield Workers(client, processes.watch, own=count)


class _Processes:
    """The worker processes of one local cluster."""

    def __init__(self, address: str, folder: Path) -> None:
        self._address = address
        self._folder = folder
        self._running: dict[subprocess.Popen[bytes], Path] = {}
        self._started = 0
        self._deaths = 0
        self._connected = False
        self._began = time.monotonic()

    def start(self) -> None:
        log = self._folder / f"{self._started}.log"
        self._started += 1
        with log.open("wb") as stream:
            process = subprocess.Popen(
                command("uq.running.dask_worker", self._address, str(self._folder)),
                stdin=subprocess.PIPE,
                stdout=stream,
                stderr=stream,
                env=_environment(),
            )
        self._running[process] = log

    def watch(self, threads: int, progress: bool) -> None:
        """Replace dead processes; give up when they die young, or none has ever connected."""
        self._connected = self._connected or threads > 0
        if progress:
            self._deaths = 0
        for process, log in list(self._running.items()):
            if process.poll() is None:
                continue
            killed = process.returncode < 0  # by somebody: the next may live
            if not self._connected and not killed:
                said = log.read_text(errors="replace").strip()
                last = said.splitlines()[-1] if said else f"exit code {process.returncode}"
                raise RunError(f"a worker process could not start: {last}")
            del self._running[process]
            _close(process)
            self._deaths += 1
            self.start()
        if self._deaths > _DEATHS_AT_MOST:
            raise RunError(f"worker processes keep dying: {self._deaths} without a row computed")
        if not self._connected and time.monotonic() > self._began + _START_SECONDS:
            raise RunError(f"no worker process answered within {_START_SECONDS} s")

    def kill(self) -> None:
        for process in self._running:
            process.kill()
        for process in self._running:
            process.wait()
            _close(process)


def _close(process: subprocess.Popen[bytes]) -> None:
    if process.stdin:
        process.stdin.close()


def _environment() -> dict[str, str]:
    return inherited() | {
        "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",
        "DASK_DISTRIBUTED__WORKER__HTTP__ROUTES": "[]",
    }
