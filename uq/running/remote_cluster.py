"""Dask workers of a cluster that somebody else runs."""

import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager

from distributed import Client
from distributed.security import Security

from uq.errors import InputError, RunError
from uq.provenance import differences, versions
from uq.running.dask_task import end_children
from uq.running.workers import Workers, quiet

_PACKAGE = "vibrolife"
_REMOTE_SECONDS = 10
_WORKERLESS_SECONDS = 120.0


@contextmanager
def remote_workers(address: str) -> Iterator[Workers]:
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
        stack.enter_context(quiet())
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
