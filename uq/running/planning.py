"""What a study will cost: a few of its rows are run, spread over all of them."""

import subprocess
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from math import ceil, gcd
from threading import Lock
from typing import NamedTuple

import numpy as np
import xarray as xr
from scipy import special

from uq.errors import InputError
from uq.interrupts import undone
from uq.rows import results
from uq.rows.evaluate import Chunk, joined
from uq.rows.sampling import Rows
from uq.rows.workload import Workload, workload_of
from uq.running import executor
from uq.running.dispatch import CHUNK_SECONDS, chunk_rows
from uq.running.environment import command, inherited
from uq.running.isolation import Isolated, spec_of
from uq.store import row_bytes
from uq.study.definition import Study

PILOT_SECONDS = 8.0
"""Time for the pilot, once the model is compiled."""

_FIRST_ROWS = 16
_GROWTH = 4
_FILE_BYTES = 30_000  # names, units, the study
_CHUNKS_AT_LEAST = 2  # per process
_GOLDEN = (5**0.5 - 1) / 2
# What a run does beside its rows takes this many times what loading its packages takes: a busy
# computer is slow in both.
_RUN_LOADS = 1.5
_WORKERS_LOADS = 2.0


class Cost(NamedTuple):
    """What a run needs.

    Attributes
    ----------
    rows : int
    workers : int
        Processes that compute at the same time.
    pilot_rows : int
    row_seconds : float
        Time of one process for one row [s].
    seconds : float
        From start to result, once the model is compiled [s].
    seconds_low, seconds_high : float
        95 % interval of it, as far as rows cost more than others [s].
    result_bytes : int
        The result.
    run_bytes : int
        All that is on disk for a moment, the result included.
    """

    rows: int
    workers: int
    pilot_rows: int
    row_seconds: float
    seconds: float
    seconds_low: float
    seconds_high: float
    result_bytes: int
    run_bytes: int


def pilot(
    study: Study, workers: int | None = None, compiling: Callable[[], object] = lambda: None
) -> tuple[Cost, xr.Dataset]:
    """Run a few rows of a study, as many at the same time as the whole run would.

    Parameters
    ----------
    study : Study
    workers : int, optional
        As in `uq.run`.
    compiling : callable
        Called when the model begins to be compiled.

    Returns
    -------
    Cost
    xarray.Dataset
        The rows of the pilot, with the schema of a result.
    """
    if workers is not None and workers < 0:
        raise InputError(f"workers must not be negative: {workers}")
    from uq.running.local_cluster import CORES

    workload = workload_of(study)
    processes = min(workers or (1 if workers == 0 else CORES), workload.total // workload.group)
    with ExitStack() as stack:
        crew = [Isolated(spec_of(workload), None, compiling) for _ in range(processes)]
        for process in crew:
            stack.enter_context(undone(process.close))
        load_seconds = _load_seconds()
        row_seconds, pilot_seconds = _warm_up(workload, crew)
        some, chunks, row = _sample(workload, crew, row_seconds)
    kept = row_bytes(study) * workload.total
    constants = len(study.model.parameter_names) - len(study.uncertain)
    size = (
        _FILE_BYTES + kept - 8 * constants * workload.total
    )  # a constant is one number in the result
    alone = row.seconds * workload.total
    if workers is None and alone < executor.SHORT_SECONDS:
        processes = 1
    beside = _RUN_LOADS * load_seconds
    if workers or processes > 1:
        beside += _WORKERS_LOADS * load_seconds + pilot_seconds
    low, seconds, high = (
        alone / processes * share + beside
        for share in (max(0.0, 1 - row.error), 1.0, 1 + row.error)
    )
    chunk = joined(chunks)
    rows = Rows(*(np.concatenate(parts) for parts in zip(*some, strict=True)))
    cost = Cost(
        rows=workload.total,
        workers=processes,
        pilot_rows=len(rows.x),
        row_seconds=row.seconds,
        seconds=seconds,
        seconds_low=low,
        seconds_high=high,
        result_bytes=size,
        run_bytes=kept + size,
    )
    failures = {label: f"row {row}: {text}" for label, (row, text) in chunk.failures.items()}
    return cost, results.build(study, rows, chunk.columns, chunk.status, failures)


def _load_seconds() -> float:
    """Return how long a new process takes to load what a run needs [s]."""
    began = time.perf_counter()
    subprocess.run(command("uq.cli.run"), env=inherited(), stdin=subprocess.DEVNULL, check=True)
    return time.perf_counter() - began


def _warm_up(workload: Workload, crew: list[Isolated]) -> tuple[float, float]:
    """Compile the model in one process, load it in the others.

    Then one takes more and more rows, as a run does before it starts workers: return the time of
    a row, and of all those rows.
    """
    size, seconds = min(workload.total, workload.group * ceil(_FIRST_ROWS / workload.group)), 0.0
    first = workload.block(0, size)
    for process in crew:
        process.evaluate(first.x, first.seed)
    while True:
        rows = workload.block(0, size)
        began = time.perf_counter()
        crew[0].evaluate(rows.x, rows.seed)
        last = time.perf_counter() - began
        seconds += last
        grown = min(_GROWTH * size, chunk_rows(workload, last / size), workload.total)
        if seconds > CHUNK_SECONDS or grown <= size:
            return last / size, seconds
        size = grown


def _sample(
    workload: Workload, crew: list[Isolated], row_seconds: float
) -> tuple[list[Rows], list[Chunk], "_RowCost"]:
    """Return rows spread over the study, what became of them, and what a row costs.

    They are cut as a run cuts them: rows that are computed together may share work.
    """
    size = chunk_rows(workload, row_seconds)
    chunks = ceil(workload.total / size)
    starts = [index * size for index in _spread(chunks)]
    least, end = _CHUNKS_AT_LEAST * len(crew), time.perf_counter() + PILOT_SECONDS
    done: dict[int, tuple[Rows, Chunk, float]] = {}
    turn = Lock()

    def compute(process: Isolated) -> None:
        while True:
            with turn:
                taken = len(starts)
                if not taken or (chunks - taken >= least and time.perf_counter() > end):
                    return
                start = starts.pop()
            rows = workload.block(start, min(start + size, workload.total))
            began = time.perf_counter()
            chunk = process.evaluate(rows.x, rows.seed, start)
            done[start] = rows, chunk, time.perf_counter() - began

    with ThreadPoolExecutor(len(crew)) as pool:
        list(pool.map(compute, crew))
    rows, found, seconds = zip(*(done[start] for start in sorted(done)), strict=True)
    return list(rows), list(found), _row_cost(seconds, [len(some.x) for some in rows], chunks)


def _spread(count: int) -> list[int]:
    """Return 0..count-1 in an order, to be taken from its end, whose every part is spread out."""
    stride = next(n for n in range(round(count * _GOLDEN), 0, -1) if gcd(n, count) == 1)
    return [index * stride % count for index in range(count)][::-1]


class _RowCost(NamedTuple):
    """Time of one process for one row [s], and how far off it may be, as a share of it."""

    seconds: float
    error: float


def _row_cost(seconds: Sequence[float], rows: Sequence[int], chunks: int) -> _RowCost:
    """Return the cost of a row by some of the chunks, with the half-width of its 95 % interval."""
    mean, m = sum(seconds) / sum(rows), len(seconds)
    if m == chunks:
        return _RowCost(mean, 0.0)
    each = np.divide(seconds, rows)
    deviation = each.std(ddof=1) / np.sqrt(m) * np.sqrt(1 - m / chunks)
    return _RowCost(mean, float(special.stdtrit(m - 1, 0.975) * deviation / mean))
