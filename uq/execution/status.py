"""Progress of a run, even one under way: read from its journal, without disturbing it."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from uq.execution.row_folder import computer, folder_of, history, holder, is_held
from uq.execution.tally import by_status
from uq.result import result_file


@dataclass(frozen=True)
class RunStatus:
    """Progress of a run.

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
    process : dict or None
        ``host`` and ``pid`` of the process that is writing.
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
    process: dict[str, Any] | None
    complete_rows: int | None


def run_status(path: Path) -> RunStatus:
    """Return the progress of the run of a result.

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
    held, process = holder(folder), None
    if held and is_held(folder):
        process = {"host": computer(held[0]), "pid": held[1]}
    complete_rows = None
    if path.is_file() or not run_history:
        ds = result_file.open_result(path)
        complete_rows = ds.sizes["row"]
        if not run_history or run_history.complete:
            failed, status = int(result_file.failed(ds).sum()), by_status(ds["status"].values)
            counts = complete_rows, complete_rows, failed, 0, status
            return RunStatus(str(path), "complete", *counts, None, None, process, complete_rows)
    kept, latest = run_history.kept, run_history.latest
    # From the first rows on, if there are others: before them, the model may have been compiled.
    began, since = (latest[0].time, latest[1:]) if latest[1:] else (run_history.run.time, latest)
    seconds = since[-1].time - began if since else 0.0
    rate = sum(record.rows for record in since) / seconds if seconds > 0 else None
    total, done = run_history.run.rows, sum(record.rows for record in kept)
    failed, left = sum(record.failed for record in kept), total - done
    by_label: Counter[str] = Counter()
    for record in kept:
        by_label.update(record.status)
    state, seconds_left = "running" if process else "interrupted", left / rate if rate else None
    counts = total, done, failed, left, dict(by_label)
    return RunStatus(str(path), state, *counts, rate, seconds_left, process, complete_rows)
