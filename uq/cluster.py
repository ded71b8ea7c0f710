"""Dask workers for one run: processes on this computer, or somebody's running cluster.

The local workers are plain child processes that import ``uq.worker``, so that the calling script
needs no ``__main__`` guard; dask's scheduler runs in a thread of this process.
"""

import importlib.metadata
import logging
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

import dask
from dask.system import CPU_COUNT
from distributed import Client, LocalCluster
from distributed.utils import silence_logging_cmgr

from uq.errors import InputError, RunError
from uq.interrupts import undone
from uq.threads import SINGLE_THREADED

CORES = CPU_COUNT
"""Cores this process may use: affinity and container limits included."""

_PACKAGE = "vibrolife"
_START_SECONDS = 60
_REMOTE_SECONDS = 10
_STARTS_AT_MOST = 100


class Workers:
    """Workers that are connected, or about to be.

    Attributes
    ----------
    client : distributed.Client
    """

    def __init__(self, client: Client, watch: Callable[[], None]) -> None:
        self.client = client
        self._watch = watch

    @property
    def threads(self) -> int:
        """Tasks that can run at the same time, as long as no worker is connected none."""
        return sum(self.client.nthreads().values())

    def watch(self) -> None:
        """Replace workers that died; to be called now and then.

        Raises
        ------
        RunError
            When workers cannot start, or keep dying.
        """
        self._watch()


@contextmanager
def local(count: int) -> Iterator[Workers]:
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
        settings = {"temporary-directory": str(folder), "distributed.scheduler.http.routes": []}
        stack.enter_context(dask.config.set(settings))
        stack.enter_context(_quiet())
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
        yield Workers(client, lambda: processes.watch(bool(client.nthreads())))


@contextmanager
def remote(address: str) -> Iterator[Workers]:
    """Connect to a running dask scheduler.

    Parameters
    ----------
    address : str
        Such as ``tcp://host:8786``.

    Yields
    ------
    Workers

    Raises
    ------
    InputError
        When nothing answers there, or it has no workers that can help.
    """
    with ExitStack() as stack:
        stack.enter_context(_quiet())
        try:
            client = stack.enter_context(
                Client(address, set_as_default=False, timeout=_REMOTE_SECONDS)
            )
        except (OSError, ValueError) as error:
            reason = " ".join(str(error).split())
            raise InputError(f"--scheduler {address}: cannot connect: {reason}") from None
        here = importlib.metadata.version(_PACKAGE)
        _check_packages(client, f"--scheduler {address}", here)
        yield Workers(client, lambda: None)


def _check_packages(client: Client, where: str, here: str) -> None:
    """Refuse workers without this package: they would not survive their first task."""
    there = client.run(importlib.metadata.version, _PACKAGE, on_error="return")
    if not there:
        raise InputError(f"{where}: the cluster has no workers")
    for worker, version in there.items():
        if version != here:
            has = f"has {_PACKAGE} {version}" if isinstance(version, str) else f"lacks {_PACKAGE}"
            raise InputError(f"{where}: worker {worker} {has}, this process has {here}")


class _Processes:
    """The worker processes of one local cluster."""

    def __init__(self, address: str, folder: Path) -> None:
        self._address = address
        self._folder = folder
        self._running: list[subprocess.Popen[bytes]] = []
        self._started = 0
        self._connected = False
        self._began = time.monotonic()

    def start(self) -> None:
        log = self._folder / f"{self._started}.log"
        self._started += 1
        with log.open("wb") as stream:
            process = subprocess.Popen(
                # -P: the folder one works in is searched only where the parent searches it.
                [sys.executable, "-P", "-m", "uq.worker", self._address, str(self._folder)],
                stdin=subprocess.PIPE,
                stdout=stream,
                stderr=stream,
                env=_environment(),
            )
        self._running.append(process)

    def watch(self, connected: bool) -> None:
        """Replace dead processes; give up when they die young, or none has ever connected."""
        self._connected = self._connected or connected
        for number, process in enumerate(list(self._running)):
            if process.poll() is None:
                continue
            if not self._connected:
                log = (self._folder / f"{number}.log").read_text().strip()
                last = log.splitlines()[-1] if log else f"exit code {process.returncode}"
                raise RunError(f"a worker process could not start: {last}")
            self._running.remove(process)
            _close(process)
            self.start()
        if self._started > _STARTS_AT_MOST:
            raise RunError(f"worker processes keep dying: {self._started} were started")
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
    """Return what makes a worker import and compile as this process does."""
    environment = dict(os.environ) | {"PYTHONPATH": os.pathsep.join(sys.path)}
    environment |= {
        "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",
        "DASK_DISTRIBUTED__WORKER__HTTP__ROUTES": "[]",
    }
    return SINGLE_THREADED | environment | _numba_settings()


def _numba_settings() -> dict[str, str]:
    """Return the instruction set and cache that numba uses in this process, if it is loaded.

    It reads the environment once, at import: what the environment says now may be something else.
    """
    if "numba" not in sys.modules:
        return {}
    import numba
    from numba.core.registry import cpu_target

    config: Any = numba.config
    _, cpu, features = cpu_target.target_context.codegen().magic_tuple()
    return {
        "NUMBA_CPU_NAME": cpu,
        "NUMBA_CPU_FEATURES": features,
        "NUMBA_CACHE_DIR": config.CACHE_DIR,
    }


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep dask's log off the terminal: workers that come and go are no news to the user."""
    with ExitStack() as stack:
        for logger in ("distributed", "distributed.client", "distributed.gc"):
            stack.enter_context(silence_logging_cmgr(logging.CRITICAL, logger))
        yield
