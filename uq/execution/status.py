"""Progress of a run, even one under way: read from its journal, without disturbing it."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from uq.execution.records import History
from uq.execution.row_folder import Holder, folder_of, history, holder, is_held
from uq.execution.tally import by_status
from uq.result import result_file


@dataclass(frozen=True)
class RunStatus:
    """How far a run is.

    Attributes
    ----------
    output : str
        Path of the result.
    state : {"complete", "running", "interrupted"}
    rows : int
        Total; of them `done`, `failed` and `left`.
    status : dict of str to int
        Status label -> rows.
    rate : float or None
        Of the latest run [rows/s]; None if unknown.
    seconds_left : float or None
        Until completion at this rate [s].
    process : Holder or None
        The process that is writing.
    complete_rows : int or None
        Rows of an existing result.
    """

    output: str
    state: str
    rows: int
    done: int
    failed: int
    left: int
    status: Mapping[str, int]
    rate: float | None
    seconds_left: float | None
    process: Holder | None
    complete_rows: int | None


def run_status(path: Path) -> RunStatus:
    """Return how far the run of a result is.

    Parameters
    ----------
    path : Path
        Of the result, existing or not.

    Raises
    ------
    InputError
        When there are neither a result nor rows kept for one.
    """
    folder = folder_of(path)
    run_history = history(folder)
    held = holder(folder)
    process = replace(held, host=held.computer) if held and is_held(folder) else None
    complete = _complete(path, process) if path.is_file() or not run_history else None
    if complete and (not run_history or run_history.complete):
        return complete
    assert run_history is not None
    return _under_way(path, process, run_history, complete.rows if complete else None)


def _complete(path: Path, process: Holder | None) -> RunStatus:
    ds = result_file.open_result(path)
    rows, failed = ds.sizes["row"], int(np.count_nonzero(result_file.failed(ds)))
    status = by_status(ds["status"].values)
    return RunStatus(
        str(path), "complete", rows, rows, failed, 0, status, None, None, process, rows
    )


def _under_way(
    path: Path, process: Holder | None, run_history: History, complete_rows: int | None
) -> RunStatus:
    kept, latest = run_history.kept, run_history.latest
    # From the first rows on, if there are others: before them, the model may have been compiled.
    began, since = (latest[0].time, latest[1:]) if latest[1:] else (run_history.run.time, latest)
    seconds = since[-1].time - began if since else 0.0
    rate = sum(record.rows for record in since) / seconds if seconds > 0 else None
    total, done = run_history.run.rows, sum(record.rows for record in kept)
    failed, left = sum(record.failed for record in kept), total - done
    status: Counter[str] = Counter()
    for record in kept:
        status.update(record.status)
    state, seconds_left = "running" if process else "interrupted", left / rate if rate else None
    counts = total, done, failed, left, dict(status)
    return RunStatus(str(path), state, *counts, rate, seconds_left, process, complete_rows)
