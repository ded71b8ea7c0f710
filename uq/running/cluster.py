"""Dask workers for one run: processes on this computer, or somebody's running cluster.

The local workers are plain child processes that import ``uq.running.dask_worker``, so that the
calling script needs no ``__main__`` guard; dask's scheduler runs in a thread of this process.
"""

import gc
import logging
import shutil
import subprocess
import tempfile
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import dask
from dask.system import CPU_COUNT
from distributed import Client, LocalCluster
from distributed.security import Security
from distributed.utils import silence_logging_cmgr

from uq.environment import command, inherited
from uq.errors import InputError, RunError
from uq.interrupts import undone
from uq.provenance import differences, versions
from uq.running.dask_task import end_children

CORES = CPU_COUNT
"""Cores this process may use: affinity and container limits included."""

_PACKAGE = "vibrolife"
_START_SECONDS = 60
_REMOTE_SECONDS = 10
_WORKERLESS_SECONDS = 120.0
_DEATHS_AT_MOST = 50  # of local workers, between two chunks that arrive


class Workers:
    """Workers that are connected, or about to be.

    Attributes
    ----------
    client : distributed.Client
    own : int
        Processes that this process started, 0 on somebody's cluster.
    """

    def __init__(self, client: Client, watch: Callable[[int, bool], None], own: int = 0) -> None:
        self.client = client
        self.own = own
        self._watch = watch

    @property
    def connected(self) -> bool:
        """Whether the scheduler can be reached."""
        return bool(self.client.status == "running")

    @property
    def dashboard(self) -> str:
        """Address of the page on which somebody's cluster shows what it does, or ""."""
        if self.own:  # nothing is behind the address that dask tells
            return ""
        try:
            return str(self.client.dashboard_link or "")
        except (KeyError, OSError):  # a scheduler without one, or just gone
            return ""

    @property
    def threads(self) -> int:
        """Tasks that can run at the same time, as long as no worker is connected none."""
        try:
            return sum(self.client.nthreads().values()) if self.connected else 0
        except OSError:  # the scheduler went away just now
            return 0

    def watch(self, progress: bool = False) -> None:
        """Replace workers that died, if they are ours; to be called now and then.

        Parameters
        ----------
        progress : bool
            Whether a worker has delivered something since the last call.

        Raises
        ------
        RunError
            When there will be no workers: they cannot start, keep dying, or stay away.
        """
        self._watch(self.threads, progress)


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
        settings = {
            "temporary-directory": str(folder),
            "distributed.scheduler.http.routes": [],
            "distributed.scheduler.allowed-failures": 2,  # the third worker killed ends a task
        }
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
        yield Workers(client, processes.watch, own=count)


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
        _check_certificates(address)
        try:
            client = stack.enter_context(
                Client(address, set_as_default=False, timeout=_REMOTE_SECONDS)
            )
        except (OSError, ValueError) as error:
            reason = " ".join(str(error).split())
            raise InputError(
                f"--scheduler {address}: cannot connect: {reason}; is a dask scheduler running"
                " there?"
            ) from None
        _check_versions(client, f"--scheduler {address}")
        try:
            yield Workers(client, _Presence(client, address).watch)
        finally:
            if client.status == "running":
                client.run(end_children, on_error="ignore")


def _check_certificates(address: str) -> None:
    """Refuse an encrypted connection that nobody gave certificates for."""
    try:
        context = Security().get_connection_args("client")["ssl_context"]
    except OSError as error:
        raise InputError(
            f"--scheduler {address}: the certificates cannot be used: {error}"
        ) from None
    if address.startswith("tls:") and context is None:
        raise InputError(
            f"--scheduler {address}: cannot connect without certificates: set "
            "DASK_DISTRIBUTED__COMM__TLS__CA_FILE, ..__TLS__CLIENT__CERT and ..__TLS__CLIENT__KEY"
        )


def _check_versions(client: Client, where: str) -> None:
    """Refuse workers that would give other bits, or not survive their first task."""
    there = client.run(differences, versions(), on_error="return")
    if not there:
        raise InputError(f"{where}: the cluster has no workers; start some with 'dask worker'")
    for worker, wrong in there.items():
        if isinstance(wrong, Exception):
            reason = " ".join(str(wrong).split())
            raise InputError(
                f"{where}: worker {worker} lacks {_PACKAGE}: {reason}; install it there"
            )
        if wrong:
            raise InputError(f"{where}: worker {worker} {wrong}")


class _Presence:
    """Whether somebody else's cluster is still there."""

    def __init__(self, client: Client, address: str) -> None:
        self._client = client
        self._address = address
        self._last_seen = time.monotonic()

    def watch(self, threads: int, progress: bool) -> None:
        if self._client.status in ("closing", "closed"):
            raise RunError(f"--scheduler {self._address}: the scheduler is gone")
        if threads or progress:
            self._last_seen = time.monotonic()
        elif time.monotonic() > self._last_seen + _WORKERLESS_SECONDS:
            raise RunError(
                f"--scheduler {self._address}: the cluster has had no workers for "
                f"{_WORKERLESS_SECONDS:g} s"
            )


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


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep dask's log off the terminal: workers that come and go are no news to the user."""
    log = logging.getLogger("asyncio")
    level = log.level
    log.setLevel(logging.CRITICAL)
    try:
        with ExitStack() as stack:
            for logger in ("distributed", "distributed.client", "distributed.gc"):
                stack.enter_context(silence_logging_cmgr(logging.CRITICAL, logger))
            yield
    finally:
        gc.collect()  # what nobody waited for, after an interruption, says so when it is collected
        log.setLevel(level)
