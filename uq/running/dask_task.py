"""What a worker process is asked to do: plain data in, plain data out.

A worker hands the rows on to a child of its own, one per thread, which they may crash or never
leave. Apart from the rest, so that a worker imports no more than it needs.
"""

import threading
import time
from collections.abc import Iterator, Mapping
from contextlib import contextmanager

import numpy as np
from numpy.typing import NDArray

from uq.errors import InputError
from uq.provenance import differences
from uq.rows.evaluate import Chunk
from uq.running.child import ModelSpec
from uq.running.isolation import Isolated

_lock = threading.Lock()
_idle: list[Isolated] = []
_KEPT = 64  # children at most that wait for more rows of their model


def evaluate_rows(
    spec: ModelSpec,
    versions: Mapping[str, str],
    limit: float | None,
    x: NDArray[np.float64],
    seed: NDArray[np.uint64],
    start: int,
) -> tuple[Chunk, float]:
    """Run some rows in a worker process, and say how many seconds that took.

    One dask task, given plain data only: a worker that lacks the model would not survive the
    arrival of one of its objects.

    Parameters
    ----------
    spec : uq.running.child.ModelSpec
    versions : dict of str to str
        What computes must be, as `uq.provenance.versions` tells.
    limit : float or None
        Longest time for one row [s].
    x, seed, start
        As in `uq.rows.evaluate.evaluate`.
    """
    if wrong := differences(versions):
        raise InputError(f"a worker {wrong}")
    with _child(spec, limit) as child:
        child.start()
        began = time.perf_counter()
        return child.evaluate(x, seed, start), time.perf_counter() - began


def end_children() -> None:
    """End the children that wait for more rows."""
    with _lock:
        waiting = _idle.copy()
        _idle.clear()
    for child in waiting:
        child.close()


@contextmanager
def _child(spec: ModelSpec, limit: float | None) -> Iterator[Isolated]:
    """Yield a child that nobody else uses, a waiting one if there is one."""
    with _lock:
        fitting = [child for child in _idle if (child.spec, child.limit) == (spec, limit)]
        child = fitting[0] if fitting else Isolated(spec, limit)
        if fitting:
            _idle.remove(child)
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
