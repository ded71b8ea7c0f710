"""The task of a worker process: plain data in, plain data out.

A worker passes the rows on to a child of its own, one per thread, which they may crash or never
leave. A separate module, so that a worker imports only what it needs.
"""

import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.errors import InputError
from uq.provenance import differences
from uq.rows.evaluate import Chunk
from uq.running.child import ModelSpec
from uq.running.isolation import Isolated

_lock = threading.Lock()
_idle: list[Isolated] = []
_KEPT = 64  # idle children at most


def evaluate_rows(
    spec: ModelSpec,
    versions: Mapping[str, str],
    limit: float | None,
    x: Floats,
    seed: NDArray[np.uint64],
    start: int,
) -> tuple[Chunk, float]:
    """Run some rows in a worker process; return their outputs and the time it took [s].

    One dask task, given plain data only: a worker that lacks the model would not survive receiving
    one of its objects.

    Parameters
    ----------
    spec : uq.running.child.ModelSpec
    versions : dict of str to str
        Versions that the worker must have; see `uq.provenance.versions`.
    limit : float or None
        Time limit of a row [s].
    x, seed, start
        As in `uq.rows.evaluate.evaluate`.
    """
    if wrong := differences(versions):
        raise InputError(f"a worker {wrong}")
    with _child(spec, limit) as child:
        child.start()
        began = time.perf_counter()
        return child.evaluate(x, seed, start), time.perf_counter() - began


def begin_child(spec: ModelSpec, limit: float | None) -> None:
    """Start a child before there are rows for it; parameters as of `evaluate_rows`."""
    child = Isolated(spec, limit)
    child.begin()
    with _lock:
        _idle.append(child)


def end_children() -> None:
    """End the idle children."""
    with _lock:
        while _idle:
            _idle.pop().close()


@contextmanager
def _child(spec: ModelSpec, limit: float | None) -> Iterator[Isolated]:
    """Yield a child for this call alone, an idle one if there is one."""
    with _lock:
        fitting = [i for i, one in enumerate(_idle) if (one.spec, one.limit) == (spec, limit)]
        child = _idle.pop(fitting[0]) if fitting else Isolated(spec, limit)
    try:
        yield child
    except BaseException:
        child.close()
        raise
    with _lock:
        _idle.append(child)
        surplus = _idle.pop(0) if len(_idle) > _KEPT else None
    if surplus:
        surplus.close()
