"""Start or resume a run whose rows are kept on disk."""

import os
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Status
from uq.errors import InputError
from uq.execution.disk_store import DiskStore, by_settings
from uq.execution.options import RunOptions, Say
from uq.execution.row_folder import (
    History,
    RunRecord,
    clear,
    folder_of,
    history,
    locked,
    without_overlap,
)
from uq.execution.tally import Failures, blocks_of, row_bytes
from uq.files.interrupts import undone
from uq.files.whole_files import check_target
from uq.result import result_file
from uq.study.definition import Study, refusal_to_extend, what_changed
from uq.study.evaluate import Chunk, columns_of
from uq.study.installed_models import is_other_code, made_here
from uq.study.row_sampling import Rows, row_block, rows
from uq.text.numbers import counted

_ROWS = 100_000  # of a result, at a time
_REMEDY = "choose another output, or start over with --fresh"


@contextmanager
def keep(
    study: Study, path: Path, options: RunOptions, again: Mapping[str, Any] | None = None
) -> Iterator[DiskStore]:
    """Keep the rows of a run on disk, with those already there.

    Parameters
    ----------
    study : Study
    path : Path
        Of the result. An existing result is of this study, with as many samples or fewer: its
        rows are reused.
    options : RunOptions
        With ``fresh``, the rows kept so far and the result are dropped; with ``mixed``, rows
        from another version of the model's code are reused, too.
    again : dict, optional
        Reuse only rows that did not fail, and compute the others with these settings instead of
        the study's.

    Yields
    ------
    DiskStore

    Raises
    ------
    InputError
        When there is no room, the rows there are not of this study or were computed by other
        code, or another process is writing.
    RunError
        When nothing can be written.
    """
    folder = folder_of(path)
    kept = sum(file.stat().st_size for file in folder.iterdir()) if os.path.isdir(folder) else 0
    check_target(path, 2 * row_bytes(study) * rows(study) - kept)  # rows, and the result of them
    with locked(folder):
        run_history = None if options.fresh else _usable(folder, study, again)
        if run_history is None:
            clear(folder)
        existing = None
        if run_history is None and not options.fresh and path.is_file():
            existing = result_file.open_result(path)
        origins = [record.made for record in run_history.chunks] if run_history else []
        if not options.mixed:
            _check_code(study, path, origins if existing is None else [existing.attrs])
        store = DiskStore(study, path)
        with undone(store.close):
            if run_history is not None:
                _find(store, run_history, options.say)
            elif existing is not None:
                _adopt(store, study, path, existing, all_rows=again is None)
            store.note(
                RunRecord(
                    time=time.time(),
                    host=os.uname().nodename,
                    pid=os.getpid(),
                    identity=study.identity,
                    study=study.text,
                    model_version=study.model.version,
                    samples=study.design.samples,
                    rows=store.total,
                    row_type=str(store.row_type),
                    again=again is not None,
                )
            )
            store.settings = dict(again or {})
            if store.reused:
                options.say(f"{path}: {store.reused} of {store.total} rows were already done")
            for line in _other_versions(study, store):
                options.say(f"{path}: {line}")
            yield store


def drop_leftovers(path: Path) -> None:
    """Remove the rows of a complete result, left by a process killed at the very end."""
    folder = folder_of(path)
    if folder.is_dir():
        with suppress(InputError), locked(folder):
            run_history = history(folder)
            if run_history is None or run_history.complete:
                clear(folder)


def _usable(folder: Path, study: Study, again: Mapping[str, Any] | None) -> History | None:
    """Return the history of a folder if its rows can be reused; refuse another study."""
    run_history = history(folder)
    if run_history is None:
        return None
    if again is not None and run_history.complete:  # left by a result's own run
        return None
    last = run_history.run
    if again is not None and not last.again:
        raise InputError(f"{folder}: has rows of a run that is not complete; finish it first")
    if last.identity != study.identity:
        change = what_changed(last.study, last.model_version, study)
        raise InputError(f"{folder}: has rows of another study ({change}); {_REMEDY}")
    if last.samples != study.design.samples:
        sizes = f"samples = {last.samples}, now {study.design.samples}"
        if last.samples > study.design.samples:
            raise InputError(f"{folder}: has rows of this study with more ({sizes}); {_REMEDY}")
        if problem := refusal_to_extend(study):
            raise InputError(f"{folder}: has rows of this study with fewer ({sizes}); {problem}")
    return run_history


def _find(store: DiskStore, run_history: History, say: Say) -> None:
    if run_history.run.row_type != str(store.row_type):
        raise InputError(
            f"{store.folder}: the model's outputs have changed since its rows were computed; "
            f"{_REMEDY}"
        )
    if damaged := store.find(without_overlap(run_history.chunks, store.total)):
        rows = counted(damaged, "row is", "rows are")
        say(f"{store.folder}: {rows} damaged and will be computed again")


def _check_code(study: Study, path: Path, origins: Sequence[Mapping[str, object]]) -> None:
    """Refuse to resume with rows from another version of the model's code."""
    if any(is_other_code(made, study.model_reference) for made in origins):
        raise InputError(
            f"{path}: has rows from other code of model '{study.model.name}' with the same version;"
            " start over with uq run --fresh, or continue with --mixed"
        )


def _other_versions(study: Study, store: DiskStore) -> Iterator[str]:
    here = made_here(study.model_reference)
    for made in store.made:
        differing = [name for name in here if made.get(name) != here[name]]
        if differing:
            pairs = ", ".join(f"{name} {made.get(name)} (here {here[name]})" for name in differing)
            yield f"some rows were computed with {pairs}"


def _adopt(store: DiskStore, study: Study, path: Path, ds: xr.Dataset, all_rows: bool) -> None:
    """Copy the rows of a result into a store.

    Parameters
    ----------
    store : DiskStore
    study : Study
        The result's own, perhaps with more samples.
    path, ds : Path, xarray.Dataset
    all_rows : bool
        Whether to include failed rows.
    """
    if fault := _incomplete(ds, study):
        raise InputError(f"{path}: not a sound result: {fault}")
    here = made_here(study.model_reference)
    made = {name: str(ds.attrs[name]) for name in here if name in ds.attrs}
    for first in range(0, ds.sizes["row"], _ROWS):
        block = ds.isel(row=slice(first, first + _ROWS)).load()
        wanted = np.ones(block.sizes["row"], np.bool_) if all_rows else ~result_file.failed(block)
        for settings, variant in by_settings(block):
            numbers = first + np.flatnonzero(wanted & variant)
            if numbers.size:
                part = block.isel(row=numbers - first)
                rows, chunk = _inputs(study, part, first), _outputs(study, part, numbers)
                store.adopt(blocks_of(numbers), rows, chunk, (made, settings))


def _incomplete(ds: xr.Dataset, study: Study) -> str:
    """Return a message on the rows of the study that a result lacks, or ""."""
    if not np.array_equal(ds["row"].values, np.arange(ds.sizes["row"])):
        return "'row' does not number all rows from 0"
    for name in study.model.parameter_names:
        if name not in ds.data_vars or ds[name].attrs.get("role") not in ("input", "fixed"):
            return f"it does not contain the input '{name}'"
    for name, column in columns_of(study.model, study.settings).items():
        if name not in ds.data_vars:
            return f"it does not contain the output '{name}'"
        if ds[name].dims[:1] != ("row",) or ds[name].shape[1:] != column.shape:
            return f"'{name}' is not of the shape that the settings give"
    return ""


def _inputs(study: Study, part: xr.Dataset, first: int) -> Rows:
    numbers = part["row"].values
    drawn = row_block(study, first, int(numbers[-1]) + 1)
    kept = Rows(*(field[numbers - first] for field in drawn))
    for i, name in enumerate(study.model.parameter_names):
        kept.x[:, i] = part[name].values
    return kept


def _outputs(study: Study, part: xr.Dataset, numbers: NDArray[np.int64]) -> Chunk:
    columns = {
        name: part[name].values.astype(column.dtype)
        for name, column in columns_of(study.model, study.settings).items()
    }
    status = part["status"].values
    failures: Failures = {}
    for code in np.unique(status[status != Status.OK]):
        kind, row = Status(code), int(numbers[np.argmax(status == code)])
        example = str(part["status"].attrs.get(f"example_{kind.name.lower()}", ""))
        is_of_row = example.startswith(f"row {row}: ")
        failures[kind.label] = row, example.partition(": ")[2] if is_of_row else kind.meaning
    return Chunk(columns, status, failures)
