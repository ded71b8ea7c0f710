"""Dask workers of this computer.

They are threads of this process, and each passes its rows on to a process of its own: the calling
script needs no ``__main__`` guard.
"""

import logging
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from tempfile import TemporaryDirectory

import dask
from distributed import Client, LocalCluster

from uq.execution.children import Children
from uq.execution.dask_task import named
from uq.execution.workers import Workers, quiet
from uq.files.interrupts import undone
from uq.result.workload import Workload

_UNUSED = "127.0.0.1:0"
"""Some free port of this computer, with nothing behind it: dask wants one."""


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
        client = stack.enter_context(Client(cluster, set_as_default=False))
        stack.enter_context(undone(children.close))  # first: workers wait for their rows
        yield Workers(client, workload, row_limit, run=stack.enter_context(named(children)))


@contextmanager
def scratch() -> Iterator[None]:
    """Have dask's folders removed at once: workers without a limit of memory keep nothing there."""
    places = sys.path.copy()
    with (
        TemporaryDirectory(prefix="uq-") as folder,
        dask.config.set({"temporary-directory": folder}),
    ):
        yield
    sys.path[:] = places  # dask adds its folders
