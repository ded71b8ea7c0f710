"""Dask worker processes on this computer.

They are plain child processes that run ``uq.running.dask_worker``, so that the calling script needs
no ``__main__`` guard; dask's scheduler runs in a thread of this process.
"""

import logging
import os
import shutil
import subprocess
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from multiprocessing.connection import Connection
from pathlib import Path
from typing import TYPE_CHECKING

from dask.system import CPU_COUNT

from uq.errors import RunError
from uq.interrupts import undone
from uq.running.child import ModelSpec
from uq.running.environment import command, inherited
from uq.running.isolation import TRIES

if TYPE_CHECKING:
    from uq.running.workers import Workers

CORES = CPU_COUNT
"""Cores that this process may use, within affinity and container limits."""

_START_SECONDS = 60
_DEATHS_AT_MOST = 50  # between two chunks that arrive
_WORKER_SETTINGS = {
    "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",
    "DASK_DISTRIBUTED__WORKER__HTTP__ROUTES": "[]",
}


Wanted = tuple[ModelSpec, float | None] | None
"""What `begin_child` takes, or None."""


@contextmanager
def local_workers(count: int, wanted: Wanted = None) -> "Iterator[Workers]":
    """Start `count` worker processes with one thread each, and end them.

    Parameters
    ----------
    count : int
    wanted : tuple of ModelSpec and float or None, optional
        The model whose rows they will compute, and the time limit of a row [s].

    Yields
    ------
    Workers
        They connect by and by; tasks submitted earlier wait for them.
    """
    with ExitStack() as stack:
        folder = Path(tempfile.mkdtemp(prefix="uq-"))
        stack.enter_context(undone(lambda: shutil.rmtree(folder, ignore_errors=True)))
        processes = _Processes(folder, wanted)
        stack.enter_context(undone(processes.kill))
        for _ in range(count):
            processes.start()
        import dask  # while they start
        from distributed import Client, LocalCluster

        from uq.running.workers import Workers, quiet

        settings = {
            "temporary-directory": str(folder),
            "distributed.scheduler.http.routes": [],
            "distributed.scheduler.allowed-failures": TRIES - 1,  # one more fails a task
        }
        stack.enter_context(dask.config.set(settings))
        stack.enter_context(quiet())
        cluster = LocalCluster(
            n_workers=0,
            host="127.0.0.1",
            dashboard_address="127.0.0.1:0",  # some free port, with nothing behind it, is required
            scheduler_kwargs={"dashboard": False},
            silence_logs=logging.CRITICAL,
        )
        stack.enter_context(cluster)
        client = stack.enter_context(Client(cluster, set_as_default=False, direct_to_workers=True))
        processes.connect(cluster.scheduler_address)
        yield Workers(client, processes.watch, own=count)


class _Processes:
    """The worker processes of one local cluster."""

    def __init__(self, folder: Path, wanted: Wanted) -> None:
        self._folder, self._wanted = folder, wanted
        self._address = ""
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
                command("uq.running.dask_worker", str(self._folder)),
                stdin=subprocess.PIPE,
                stdout=stream,
                stderr=stream,
                env=inherited() | _WORKER_SETTINGS,
            )
        self._running[process] = log
        _tell(process, self._wanted)
        if self._address:
            _tell(process, self._address)

    def connect(self, address: str) -> None:
        """Tell the processes, also those still to be started, where the scheduler is."""
        self._address = address
        for process in self._running:
            _tell(process, address)

    def watch(self, threads: int, progress: bool) -> None:
        """Replace dead processes; give up if they keep dying, or none ever connects."""
        self._connected = self._connected or threads > 0
        if progress:
            self._deaths = 0
        for process, log in list(self._running.items()):
            if process.poll() is None:
                continue
            killed = process.returncode < 0  # from outside: the next may live
            if not self._connected and not killed:
                output = log.read_text(errors="replace").strip()
                last = output.splitlines()[-1] if output else f"exit code {process.returncode}"
                raise RunError(f"a worker process could not start: {last}")
            del self._running[process]
            process.communicate()  # closes its standard input
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
            process.communicate()


def _tell(process: subprocess.Popen[bytes], what: Wanted | str) -> None:
    """Send something to a process; one that has died is replaced later."""
    assert process.stdin
    pipe = os.dup(process.stdin.fileno())
    with suppress(OSError), Connection(pipe, readable=False) as connection:
        connection.send(what)
