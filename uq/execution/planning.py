"""Cost of a study, estimated from a few of its rows."""

import subprocess
import time
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from math import ceil, gcd
from threading import Event, Lock
from typing import NamedTuple

import numpy as np
import xarray as xr

from uq.execution.environment import command, inherited
from uq.execution.executor import (
    CHUNK_SECONDS,
    GROWTH,
    first_chunk,
    first_rows_alone,
    good_chunk,
    in_one_process,
    processes,
)
from uq.execution.isolation import Action, Evaluate, Isolated, spec_of
from uq.execution.options import RunOptions, Say, ignore
from uq.execution.tally import row_bytes
from uq.result import result_file
from uq.result.workload import Workload, workload_of
from uq.stats.intervals import upper_probability
from uq.stats.quantile_functions import student
from uq.study.definition import Study
from uq.study.evaluate import Chunk, examples_of, joined
from uq.study.row_sampling import Rows
from uq.text.numbers import elapsed

PILOT_SECONDS = 8.0
"""Time for the pilot, once the model is compiled."""

_SLOW_SECONDS = 2.0  # of a first chunk, of which loading takes little

_LONG_SECONDS = 8.0  # of a chunk, so that few are computed

_FILE_BYTES = 30_000  # names, units, the study
_CHUNKS_AT_LEAST = 2  # per process, of slow rows in all
_GOLDEN = (5**0.5 - 1) / 2
# The overhead of a run, as a multiple of the time that loading its packages takes: both grow
# together on a busy computer.
_RUN_LOADS = 1.5
_WORKERS_LOADS = 2.0


class Cost(NamedTuple):
    """Estimated resources of a run.

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
        95 % interval of `seconds`, from the scatter of the cost of rows.
    result_bytes : int
        The result.
    run_bytes : int
        Peak disk use, the result included.
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
    study: Study,
    workers: int | None = None,
    compiling: Action = lambda: None,
    say: Say = ignore,
) -> tuple[Cost, xr.Dataset]:
    """Run a few rows of a study, in as many processes as the whole run would use.

    Parameters
    ----------
    study : Study
    workers : int, optional
        As in `uq.run`.
    compiling : callable
        Called when compilation of the model starts.
    say : callable
        Called with a line for the user if rows are so slow that the pilot takes a while.

    Returns
    -------
    Cost
    xarray.Dataset
        The rows of the pilot, with the schema of a result.
    """
    RunOptions(workers).check()
    workload = workload_of(study)
    total, count = workload.total, processes(workload, workers)
    spec, compiled = spec_of(workload), Event()

    def when_compiling() -> None:
        compiled.set()
        compiling()

    with ExitStack() as stack:
        evaluators = [
            stack.enter_context(Isolated(spec, None, when_compiling).running())
            for _ in range(count)
        ]
        load_seconds = _load_seconds()
        row_seconds, first_seconds = _warm_up(workload, evaluators, compiled)
        size = good_chunk(workload, row_seconds=row_seconds)
        least = _CHUNKS_AT_LEAST * count
        if size * row_seconds > _LONG_SECONDS:
            least = max(_CHUNKS_AT_LEAST, count)
            say(
                f"a row takes about {elapsed(row_seconds)}: running {least * size} more, {count} at"
                " a time"
            )
        done, chunks = _spread_chunks(workload, evaluators, size, least)
    starts, row_blocks, computed_chunks, seconds = zip(*done, strict=True)
    rows = Rows(*(np.concatenate(parts) for parts in zip(*row_blocks, strict=True)))
    row_seconds, error = _row_cost(seconds, [len(part.x) for part in row_blocks], chunks)

    kept = row_bytes(study) * total
    constants = len(study.model.parameter_names) - len(study.uncertain)
    # A constant is one number in the result.
    result_bytes = _FILE_BYTES + kept - 8 * constants * total
    alone = row_seconds * total
    if in_one_process(workers, alone):
        count = 1
    beside = _RUN_LOADS * load_seconds
    if workers or count > 1:
        beside += _WORKERS_LOADS * load_seconds
        beside += first_seconds if first_rows_alone(workload, workers) else 0.0
    shares = 1.0, max(0.0, 1 - error), 1 + error
    likely, low, high = (alone / count * share + beside for share in shares)
    times = row_seconds, likely, low, high
    cost = Cost(total, count, len(rows.x), *times, result_bytes, kept + result_bytes)
    chunk = joined(computed_chunks)
    failures = examples_of(chunk.failures)
    parts = zip(starts, row_blocks, strict=True)
    numbers = np.concatenate([np.arange(start, start + len(part.x)) for start, part in parts])
    return cost, result_file.build(study, rows, chunk.columns, chunk.status, failures, numbers)


def _load_seconds() -> float:
    """Return the time that a new process takes to import the packages of a run [s]."""
    began = time.perf_counter()
    subprocess.run(command("uq.cli.run"), env=inherited(), stdin=subprocess.DEVNULL, check=True)
    return time.perf_counter() - began


def _timed(
    evaluate: Evaluate, workload: Workload, start: int, size: int
) -> tuple[Rows, Chunk, float]:
    """Compute some rows; return them, their outputs, and the time it took [s]."""
    rows = workload.block(start, min(start + size, workload.total))
    began = time.perf_counter()
    chunk = evaluate(rows.x, rows.seed, start)
    return rows, chunk, time.perf_counter() - began


def _warm_up(
    workload: Workload, evaluators: Sequence[Evaluate], compiled: Event
) -> tuple[float, float]:
    """Compile the model in one process, and load it in the others.

    Then one process computes growing chunks, as a run does before it starts workers: return the
    time of a row, and of all those rows. Slow rows of a model that is not compiled are known at
    once.
    """
    size, seconds = min(workload.total, first_chunk(workload)), 0.0
    first, *others = evaluators
    *_, last = _timed(first, workload, 0, size)
    if last > _SLOW_SECONDS and not compiled.is_set():
        return last / size, last
    with ThreadPoolExecutor(max(len(others), 1)) as pool:
        list(pool.map(lambda evaluate: _timed(evaluate, workload, 0, size), others))
    while True:
        *_, last = _timed(first, workload, 0, size)
        seconds += last
        good = good_chunk(workload, row_seconds=last / size)
        grown = min(GROWTH * size, good, workload.total)
        if seconds > CHUNK_SECONDS or grown <= size:
            return last / size, seconds
        size = grown


def _spread_chunks(
    workload: Workload, evaluators: Sequence[Evaluate], size: int, least: int
) -> tuple[list[tuple[int, Rows, Chunk, float]], int]:
    """Compute chunks spread over the study; return them with first row and time, and their total.

    At least the given number is computed, and more as time allows.

    Chunks are cut as in a run: rows that are computed together may share work.
    """
    chunks = ceil(workload.total / size)
    starts = [index * size for index in _spread(chunks)]
    end = time.perf_counter() + PILOT_SECONDS
    done: dict[int, tuple[Rows, Chunk, float]] = {}
    turn = Lock()

    def compute(evaluate: Evaluate) -> None:
        while True:
            with turn:
                taken = len(starts)
                if not taken or (chunks - taken >= least and time.perf_counter() > end):
                    return
                start = starts.pop()
            done[start] = _timed(evaluate, workload, start, size)

    with ThreadPoolExecutor(len(evaluators)) as pool:
        list(pool.map(compute, evaluators))
    return [(start, *done[start]) for start in sorted(done)], chunks


def _spread(count: int) -> list[int]:
    """Return 0..count-1 in a low-discrepancy order, to be taken from its end."""
    stride = next(n for n in range(round(count * _GOLDEN), 0, -1) if gcd(n, count) == 1)
    return [index * stride % count for index in range(count)][::-1]


def _row_cost(seconds: Sequence[float], rows: Sequence[int], chunks: int) -> tuple[float, float]:
    """Estimate the time of a row [s] from sampled chunks, with its relative 95 % half-width."""
    mean, m = sum(seconds) / sum(rows), len(seconds)
    if m == chunks:
        return mean, 0.0
    row_durations = np.divide(seconds, rows)
    deviation = row_durations.std(ddof=1) / np.sqrt(m) * np.sqrt(1 - m / chunks)
    return mean, float(student(upper_probability(), m - 1) * deviation / mean)
