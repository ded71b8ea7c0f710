"""The task of a dask worker: plain data in, plain data out.

A worker passes the rows on to a process, one per thread, which they may crash or never leave. A
separate module, so that a worker imports only what it needs.
"""

import asyncio
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any
from uuid import uuid4

import numpy as np
from distributed import Status, get_worker
from numpy.typing import NDArray

from uq.contract import Floats
from uq.errors import InputError
from uq.execution.child import ModelSpec
from uq.execution.isolation import Children
from uq.study.evaluate import Chunk
from uq.study.provenance import differences

_FETCHED_SECONDS = 0.1  # between looks whether a result has been fetched

_of_runs = {"": Children()}
"""Processes that compute rows for each run in this process; of a worker under ""."""


def evaluate_rows(
    spec: ModelSpec,
    versions: Mapping[str, str],
    limit: float | None,
    x: Floats,
    seed: NDArray[np.uint64],
    start: int,
    run: str = "",
) -> tuple[Chunk, float]:
    """Run rows on a worker; return their outputs and the elapsed time [s].

    One dask task, given plain data only: a worker that lacks the model would not survive receiving
    one of its objects.

    Parameters
    ----------
    spec : uq.execution.child.ModelSpec
    versions : dict of str to str
        Versions that the worker must have; see `uq.study.provenance.versions`.
    limit : float or None
        Time limit of a row [s].
    x, seed, start
        As in `uq.study.evaluate.evaluate`.
    run : str
        Name of a run of this process whose processes compute (`named`), or "".
    """
    if wrong := differences(versions):
        raise InputError(f"a worker {wrong}")
    with _of_runs[run].reserved(spec, limit) as child:
        child.start()
        began = time.perf_counter()
        return child.evaluate(x, seed, start), time.perf_counter() - began


def evaluate_in_job(*rows: Any) -> tuple[Chunk, float]:
    """Run rows as `evaluate_rows` does, on a worker that ends when they have been fetched."""
    worker: Any = get_worker()
    leaving = _leave_after(worker, worker.get_current_task())
    asyncio.run_coroutine_threadsafe(leaving, worker.loop.asyncio_loop).result()
    return evaluate_rows(*rows)


async def _leave_after(worker: Any, key: object) -> None:
    """Let a worker take nothing but the task that it has begun, and close after it."""
    worker.status = Status.paused

    async def leave() -> None:
        while key in worker.state.tasks:  # its result has not been fetched
            await asyncio.sleep(_FETCHED_SECONDS)
        await worker.close(reason="its job is done")

    worker.loop.add_callback(leave)


@contextmanager
def named(children: Children) -> Iterator[str]:
    """Yield a name by which tasks in this process find the processes of a run."""
    name = uuid4().hex
    _of_runs[name] = children
    try:
        yield name
    finally:
        del _of_runs[name]


def end_children() -> None:
    """End the idle processes of this worker."""
    _of_runs[""].end_idle()
