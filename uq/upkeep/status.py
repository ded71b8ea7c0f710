"""Where a run stands, also one that is under way: read from the journal, without disturbing it."""

from pathlib import Path
from typing import Any

import numpy as np

from uq.rows import results
from uq.store import folder_of
from uq.store.folder import history, holder, is_held
from uq.store.records import RowsRecord, RunRecord, without_overlap
from uq.store.tally import ended


def standing(path: Path) -> dict[str, Any]:
    """Tell how far the run is that makes a result.

    Parameters
    ----------
    path : Path
        Of the result, whether it exists or not.

    Returns
    -------
    dict
        ``output``; ``state``: ``complete``, ``running`` or ``interrupted``; ``rows`` in all, of
        them ``done``, ``failed`` and ``left``; ``status``: label -> rows; ``rate`` [rows/s] of the
        latest run and ``seconds_left`` [s], None where unknown; ``process``: ``host`` and ``pid``
        of who is writing, or None; ``complete_rows``: rows of the result that exists, or None.

    Raises
    ------
    InputError
        When there is neither a result nor rows that were kept for one.
    """
    folder = folder_of(path)
    records = history(folder)
    exists = path.is_file() or not records
    complete = _complete(path) if exists else None
    under_way = _under_way(records) if records else None
    held = holder(folder)
    running = held is not None and is_held(folder)
    if under_way is None or (complete is not None and not under_way["left"]):
        assert complete is not None
        found, state = complete, "complete"
    else:
        found, state = under_way, "running" if running else "interrupted"
    return {
        "output": str(path),
        "state": state,
        **found,
        "process": {"host": held.computer, "pid": held.pid} if held and running else None,
        "complete_rows": complete["rows"] if complete else None,
    }


def _complete(path: Path) -> dict[str, Any]:
    ds = results.open_result(path)
    rows, failed = ds.sizes["sample"], int(np.count_nonzero(results.failed(ds)))
    return _counts(rows, rows, failed, ended(ds["status"].values), None)


def _under_way(records: list[RunRecord | RowsRecord]) -> dict[str, Any]:
    last = max(i for i, record in enumerate(records) if isinstance(record, RunRecord))
    run = records[last]
    assert isinstance(run, RunRecord)
    chunks = [record for record in records if isinstance(record, RowsRecord)]
    kept = without_overlap(chunks, run.rows)
    latest = [record for record in records[last:] if isinstance(record, RowsRecord)]
    # From the first rows on, if there are others: before them, the model may have been compiled.
    began, since = (latest[0].time, latest[1:]) if latest[1:] else (run.time, latest)
    seconds = since[-1].time - began if since else 0.0
    status: dict[str, int] = {}
    for record in kept:
        for label, count in record.status.items():
            status[label] = status.get(label, 0) + count
    return _counts(
        run.rows,
        sum(record.rows for record in kept),
        sum(record.failed for record in kept),
        status,
        sum(record.rows for record in since) / seconds if seconds > 0 else None,
    )


def _counts(
    rows: int, done: int, failed: int, status: dict[str, int], rate: float | None
) -> dict[str, Any]:
    left = rows - done
    return {
        "rows": rows,
        "done": done,
        "failed": failed,
        "left": left,
        "status": status,
        "rate": rate,
        "seconds_left": left / rate if rate else None,
    }
