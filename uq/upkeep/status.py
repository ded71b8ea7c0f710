"""Where a run stands, also one that is under way: read from the journal, without disturbing it."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from uq.rows import results
from uq.store import folder_of
from uq.store.folder import history, holder, is_held
from uq.store.records import RowsRecord, RunRecord, without_overlap
from uq.store.tally import ended


@dataclass(frozen=True)
class Writer:
    """The process that is writing rows."""

    host: str
    pid: int


@dataclass(frozen=True)
class RunStatus:
    """How far the run is that makes a result.

    Attributes
    ----------
    output : str
        Path of the result.
    state : {"complete", "running", "interrupted"}
    rows : int
        In all; of them `done`, `failed` and `left`.
    status : dict of str to int
        Status label -> rows.
    rate : float or None
        Of the latest run [rows/s]; None where unknown.
    seconds_left : float or None
        Until it is done, at this rate [s].
    process : Writer or None
        Who is writing.
    complete_rows : int or None
        Rows of the result that exists.
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
    process: Writer | None
    complete_rows: int | None


@dataclass(frozen=True)
class _Counts:
    rows: int
    done: int
    failed: int
    status: Mapping[str, int]
    rate: float | None = None


def run_status(path: Path) -> RunStatus:
    """Return how far the run is that makes a result.

    Parameters
    ----------
    path : Path
        Of the result, whether it exists or not.

    Raises
    ------
    InputError
        When there is neither a result nor rows that were kept for one.
    """
    folder = folder_of(path)
    records = history(folder)
    complete = _complete(path) if path.is_file() or not records else None
    under_way = _under_way(records) if records else None
    held = holder(folder)
    running = held is not None and is_held(folder)
    if under_way is None or (complete is not None and under_way.done == under_way.rows):
        assert complete is not None
        found, state = complete, "complete"
    else:
        found, state = under_way, "running" if running else "interrupted"
    left = found.rows - found.done
    return RunStatus(
        output=str(path),
        state=state,
        rows=found.rows,
        done=found.done,
        failed=found.failed,
        left=left,
        status=found.status,
        rate=found.rate,
        seconds_left=left / found.rate if found.rate else None,
        process=Writer(held.computer, held.pid) if held and running else None,
        complete_rows=complete.rows if complete else None,
    )


def _complete(path: Path) -> _Counts:
    ds = results.open_result(path)
    rows, failed = ds.sizes["sample"], int(np.count_nonzero(results.failed(ds)))
    return _Counts(rows, rows, failed, ended(ds["status"].values))


def _under_way(records: list[RunRecord | RowsRecord]) -> _Counts:
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
    return _Counts(
        run.rows,
        sum(record.rows for record in kept),
        sum(record.failed for record in kept),
        status,
        sum(record.rows for record in since) / seconds if seconds > 0 else None,
    )
