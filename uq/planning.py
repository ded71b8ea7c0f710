"""What a study will cost: a few of its rows are run, spread over all of them."""

import time
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from math import ceil
from queue import SimpleQueue
from typing import NamedTuple

import numpy as np
import xarray as xr

from uq import computing, results
from uq.errors import InputError
from uq.evaluate import Chunk, joined
from uq.interrupts import undone
from uq.isolation import Isolated, task_of
from uq.job import chunk_rows
from uq.sampling import Rows
from uq.store import row_bytes
from uq.study import Study
from uq.work import Work, work_of

PILOT_SECONDS = 8.0
"""Time for the pilot, once the model is compiled."""

_FIRST_ROWS = 16
_FILE_BYTES = 30_000  # names, units, the study
_CHUNKS_AT_LEAST = 2  # per process
# What a run does beside its rows takes this many times the start of a process: a busy computer is
# slow in both.
_RUN_STARTS = 6.0
_WORKERS_STARTS = 10.0


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
    result_bytes: int
    run_bytes: int


def pilot(study: Study, workers: int | None = None) -> tuple[Cost, xr.Dataset]:
    """Run a few rows of a study, as many at the same time as the whole run would.

    Parameters
    ----------
    study : Study
    workers : int, optional
        As in `uq.run`.

    Returns
    -------
    Cost
    xarray.Dataset
        The rows of the pilot, with the schema of a result.
    """
    if workers is not None and workers < 0:
        raise InputError(f"workers must not be negative: {workers}")
    from uq.cluster import CORES

    work = work_of(study)
    processes = min(workers or (1 if workers == 0 else CORES), work.total // work.group)
    with ExitStack() as stack:
        crew = [Isolated(task_of(work)) for _ in range(processes)]
        for process in crew:
            stack.enter_context(undone(process.close))
        began = time.perf_counter()
        crew[0].start()
        start_seconds = time.perf_counter() - began
        some, chunks, row_seconds = _sample(work, crew, _warm_up(work, crew))
    kept = row_bytes(study) * work.total
    constants = len(study.model.parameter_names) - len(study.uncertain)
    size = _FILE_BYTES + kept - 8 * constants * work.total  # a constant is one number in the result
    alone = row_seconds * work.total
    if workers is None and alone < computing.SHORT_SECONDS:
        processes = 1
    starts = _RUN_STARTS + (_WORKERS_STARTS if workers or processes > 1 else 0.0)
    seconds = alone / processes + starts * start_seconds
    chunk = joined(chunks)
    rows = Rows(*(np.concatenate(parts) for parts in zip(*some, strict=True)))
    cost = Cost(work.total, processes, len(rows.x), row_seconds, seconds, size, kept + size)
    failures = {label: f"row {row}: {text}" for label, (row, text) in chunk.failures.items()}
    return cost, results.build(study, rows, chunk.columns, chunk.status, failures)


def _warm_up(work: Work, crew: list[Isolated]) -> float:
    """Compile the model in one process, load it in the others; return the time of a row."""
    first = work.block(0, min(work.total, work.group * ceil(_FIRST_ROWS / work.group)))
    for process in crew:
        process.evaluate(first.x, first.seed)
    began = time.perf_counter()
    crew[0].evaluate(first.x, first.seed)
    return (time.perf_counter() - began) / len(first.x)


def _sample(
    work: Work, crew: list[Isolated], row_seconds: float
) -> tuple[list[Rows], list[Chunk], float]:
    """Return rows spread over the study, what became of them, and the time of a row.

    They are cut as a run cuts them: rows that are computed together may share work.
    """
    size = chunk_rows(work, row_seconds)
    chunks = ceil(PILOT_SECONDS * len(crew) / (size * row_seconds))
    chunks = max(chunks, _CHUNKS_AT_LEAST * len(crew))
    if chunks * size >= work.total:
        starts = list(range(0, work.total, size))
    else:
        groups = np.linspace(0, (work.total - size) // work.group, chunks).astype(int)
        starts = [int(group) * work.group for group in groups]
    idle: SimpleQueue[Isolated] = SimpleQueue()
    for process in crew:
        idle.put(process)

    def compute(start: int) -> tuple[Rows, Chunk, float]:
        rows = work.block(start, min(start + size, work.total))
        process = idle.get()
        began = time.perf_counter()
        chunk = process.evaluate(rows.x, rows.seed, start)
        seconds = time.perf_counter() - began
        idle.put(process)
        return rows, chunk, seconds

    with ThreadPoolExecutor(len(crew)) as pool:
        rows, done, seconds = zip(*pool.map(compute, starts), strict=True)
    return list(rows), list(done), sum(seconds) / sum(len(some.x) for some in rows)
