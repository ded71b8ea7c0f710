"""Dask workers of this computer, or of an existing cluster.

They are threads of this process, and each passes its rows on to a process of its own: the calling
script needs no ``__main__`` guard.
"""

import logging
import re
import sys
import time
from asyncio import AbstractEventLoop
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from tempfile import TemporaryDirectory
from typing import Any

import dask
from distributed import Client, LocalCluster
from distributed.deploy.cluster import Cluster
from distributed.security import Security

from uq.errors import InputError, RunError, one_line
from uq.execution.dask_task import end_children, named
from uq.execution.isolation import Children
from uq.execution.workers import Workers, quiet
from uq.files.interrupts import undone
from uq.result.workload import Workload
from uq.study.provenance import differences, versions

_UNUSED = "127.0.0.1:0"
"""Placeholder address without a server: dask requires one."""


@contextmanager
def local_workers(
    count: int, children: Children, workload: Workload, row_limit: float | None
) -> Iterator[Workers]:
    """Start `count` workers with one thread each, and end them.

    Parameters
    ----------
    count : int
    children : Children
        Which compute the rows; ended with the workers.
    workload, row_limit
        As for `uq.execution.workers.Workers`.

    Yields
    ------
    Workers
    """
    settings = {
        "distributed.scheduler.http.routes": [],
        "distributed.worker.http.routes": [],
        "distributed.worker.profile.enabled": False,
        "distributed.worker.use-file-locking": False,
    }
    with ExitStack() as stack:
        stack.enter_context(dask.config.set(settings))
        stack.enter_context(quiet())
        with scratch():
            cluster = LocalCluster(
                n_workers=count,
                threads_per_worker=1,
                processes=False,
                dashboard_address=_UNUSED,
                worker_dashboard_address=_UNUSED,
                scheduler_kwargs={"dashboard": False},
                memory_limit=0,
                silence_logs=logging.CRITICAL,
            )
        stack.enter_context(cluster)
        client = stack.enter_context(client_of(cluster))
        stack.enter_context(undone(children.close))  # first: workers wait for their rows
        yield Workers(client, workload, row_limit, run=stack.enter_context(named(children)))


def client_of(server: Cluster | str, **options: Any) -> Client:
    """Connect to a scheduler; late replies to the client say nothing."""
    client = Client(server, set_as_default=False, **options)
    loop: Any = client.loop
    loop.asyncio_loop.set_exception_handler(_without_timeouts)
    return client


def _without_timeouts(loop: AbstractEventLoop, context: dict[str, Any]) -> None:
    """Handle what a loop of dask reports, except a reply that nobody awaits any more.

    On a busy computer such a future may be collected after the run, when logs are shown again.
    """
    if not isinstance(context.get("exception"), TimeoutError):
        loop.default_exception_handler(context)


@contextmanager
def scratch() -> Iterator[None]:
    """Remove dask's scratch folders at once: workers without a memory limit do not use them."""
    places = sys.path.copy()
    with (
        TemporaryDirectory(prefix="uq-") as folder,
        dask.config.set({"temporary-directory": folder}),
    ):
        yield
    sys.path[:] = places  # dask adds its folders


_REMOTE_SECONDS = 10
_WORKERLESS_SECONDS = 120.0


@contextmanager
def remote_workers(
    address: str, workload: Workload, row_limit: float | None = None
) -> Iterator[Workers]:
    """Connect to a running dask scheduler.

    Parameters
    ----------
    address : str
        Such as ``tcp://host:8786``.
    workload, row_limit
        As for `uq.execution.workers.Workers`.

    Yields
    ------
    Workers

    Raises
    ------
    InputError
        When nothing answers there, or no worker can be used.
    """
    where = f"scheduler {address}"
    with ExitStack() as stack:
        stack.enter_context(quiet())
        _check_address(where, address)
        _check_certificates(where, encrypted=address.startswith("tls:"))
        try:
            client = client_of(address, timeout=_REMOTE_SECONDS)
        except (OSError, ValueError, TypeError, RuntimeError) as error:  # also of its addresses
            reason = one_line(error)
            raise InputError(
                f"{where}: cannot connect: {reason}; is a dask scheduler running there?"
            ) from None
        stack.enter_context(client)
        _check_versions(client, where)
        last_seen = time.monotonic()

        def watch(threads: int, progress: bool) -> None:
            nonlocal last_seen
            if client.status in ("closing", "closed"):
                raise RunError(f"{where}: the scheduler is gone")
            if threads or progress:
                last_seen = time.monotonic()
            elif time.monotonic() > last_seen + _WORKERLESS_SECONDS:
                raise RunError(
                    f"{where}: the cluster has had no workers for {_WORKERLESS_SECONDS:g} s"
                )

        try:
            yield Workers(client, workload, row_limit, watch)
        finally:
            if client.status == "running":
                client.run(end_children, on_error="ignore")


def _check_address(where: str, address: str) -> None:
    """Refuse an address that dask cannot connect to, before dask prints a traceback."""
    if not re.fullmatch(
        r"((tcp|tls|ws|wss)://)?(\[[0-9a-fA-F:.]+\]|[^\s:/\[\]]+):\d{1,5}", address
    ):
        raise InputError(f"{where}: not an address such as tcp://host:8786")


def _check_certificates(where: str, encrypted: bool) -> None:
    """Refuse an encrypted connection without certificates."""
    try:
        context = Security().get_connection_args("client")["ssl_context"]
    except OSError as error:
        raise InputError(f"{where}: the certificates cannot be used: {error}") from None
    if encrypted and context is None:
        raise InputError(
            f"{where}: cannot connect without certificates: set "
            "DASK_DISTRIBUTED__COMM__TLS__CA_FILE, ..__TLS__CLIENT__CERT and ..__TLS__CLIENT__KEY"
        )


def _check_versions(client: Client, where: str) -> None:
    """Refuse workers with versions that change results or make tasks fail."""
    by_worker = client.run(differences, versions(), on_error="return")
    if not by_worker:
        raise InputError(f"{where}: the cluster has no workers; start some with 'dask worker'")
    for worker, wrong in by_worker.items():
        if isinstance(wrong, Exception):
            reason = one_line(wrong)
            raise InputError(
                f"{where}: worker {worker} lacks vibrolife: {reason}; install it there"
            )
        if wrong:
            raise InputError(f"{where}: worker {worker} {wrong}")
