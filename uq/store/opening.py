"""Beginning a run whose rows are kept on disk, or going on with it."""

import os
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

from uq.errors import InputError
from uq.interrupts import undone
from uq.rows import results
from uq.store.adopt import adopted
from uq.store.disk import DiskStore
from uq.store.folder import clear, folder_of, history, locked
from uq.store.records import RowsRecord, RunRecord, missing, without_overlap
from uq.study.changes import refusal_to_extend, what_changed
from uq.study.code import is_other_code, made_here

if TYPE_CHECKING:
    from uq.study.definition import Study

_REMEDY = "choose another output, or start anew with --fresh"


@contextmanager
def keep(
    study: "Study",
    path: Path,
    fresh: bool = False,
    again: Mapping[str, Any] | None = None,
    say: Callable[[str], object] = lambda _: None,
    mixed: bool = False,
) -> Iterator[DiskStore]:
    """Keep the rows of a run on disk, beside those that are there.

    Parameters
    ----------
    study : Study
    path : Path
        Of the result. If there is one, it is of this study, with as many samples or fewer: its
        rows are taken over.
    fresh : bool
        Forget what was kept, and the result.
    again : dict, optional
        Take over only rows that did not fail, and compute the others with these settings in place
        of the study's.
    say : callable
        Called with a line for the user: what was found.
    mixed : bool
        Take over also rows that other code of the model computed.

    Yields
    ------
    DiskStore

    Raises
    ------
    InputError
        When the rows that are kept are not of this study, or other code computed them, or another
        process writes.
    RunError
        When nothing can be written.
    """
    folder = folder_of(path)
    with locked(folder):
        records = [] if fresh else _usable(folder, study, again)
        if not records:
            clear(folder)
        if not fresh and not mixed:
            _check_code(study, path, records)
        store = DiskStore(study, path)
        with undone(store.close):
            if records:
                _find(store, records, say)
            elif path.is_file() and not fresh:
                for some in adopted(study, path, all_rows=again is None):
                    store.adopt(*some)
            store.note(_run_record(study, store, again is not None))
            store.settings = dict(again or {})
            if store.found:
                say(f"{path}: {store.found} of {store.total} rows were done already")
            for line in _other_versions(study, store):
                say(f"{path}: {line}")
            yield store


def drop_leftovers(path: Path) -> None:
    """Remove the rows of a result that is complete, left by a process killed at the very end."""
    folder = folder_of(path)
    if folder.is_dir():
        with suppress(InputError), locked(folder):
            records = history(folder)
            if not records or not _missing(records):
                clear(folder)


def size_kept(path: Path) -> int:
    """Return how many bytes the rows kept for a result take."""
    folder = folder_of(path)
    return sum(file.stat().st_size for file in folder.iterdir()) if os.path.isdir(folder) else 0


def _usable(
    folder: Path, study: "Study", again: Mapping[str, Any] | None
) -> list[RunRecord | RowsRecord]:
    """Return what the journal says, if it is of use; refuse what is not of this study."""
    records = history(folder)
    runs = [record for record in records if isinstance(record, RunRecord)]
    if not runs:
        return []
    last = runs[-1]
    if again is not None:
        if not _missing(records):  # left over from what made the result
            return []
        if not last.again:
            raise InputError(f"{folder}: holds rows of a run that is not complete; finish it first")
    if last.identity != study.identity:
        change = what_changed(last.study, last.model_version, study)
        raise InputError(f"{folder}: holds rows of another study ({change}); {_REMEDY}")
    if last.samples != study.design.samples:
        sizes = f"samples = {last.samples}, now {study.design.samples}"
        if last.samples > study.design.samples:
            raise InputError(f"{folder}: holds rows of this study with more ({sizes}); {_REMEDY}")
        if problem := refusal_to_extend(study):
            raise InputError(f"{folder}: holds rows of this study with fewer ({sizes}); {problem}")
    return records


def _missing(records: list[RunRecord | RowsRecord]) -> bool:
    last = [record for record in records if isinstance(record, RunRecord)][-1]
    chunks = [record for record in records if isinstance(record, RowsRecord)]
    return bool(missing(without_overlap(chunks, last.rows), last.rows))


def _find(
    store: DiskStore, records: list[RunRecord | RowsRecord], say: Callable[[str], object]
) -> None:
    last = [record for record in records if isinstance(record, RunRecord)][-1]
    if last.row_type != str(store.row_type):
        raise InputError(
            f"{store.folder}: the model's outputs are others than when its rows were computed; "
            f"{_REMEDY}"
        )
    chunks = [record for record in records if isinstance(record, RowsRecord)]
    if damaged := store.find(without_overlap(chunks, store.total)):
        say(f"{store.folder}: {damaged} rows are damaged and will be computed again")


def _run_record(study: "Study", store: DiskStore, again: bool) -> RunRecord:
    return RunRecord(
        time=time.time(),
        host=os.uname().nodename,
        pid=os.getpid(),
        identity=study.identity,
        study=study.text,
        model_version=study.model.version,
        samples=study.design.samples,
        rows=store.total,
        row_type=str(store.row_type),
        again=again,
    )


def _check_code(study: "Study", path: Path, records: list[RunRecord | RowsRecord]) -> None:
    """Refuse to go on with rows that other code of the model computed."""
    made = [record.made for record in records if isinstance(record, RowsRecord)]
    if not records and path.is_file():
        made = [results.open_result(path).attrs]
    if any(is_other_code(one, study.model_reference) for one in made):
        raise InputError(
            f"{path}: holds rows that other code of model '{study.model.name}' computed, whose "
            "version was left as it was; start anew with uq run --fresh, or go on with --mixed"
        )


def _other_versions(study: "Study", store: DiskStore) -> Iterator[str]:
    here = made_here(study.model_reference)
    for made in store.made:
        differing = [name for name in here if made.get(name) != here[name]]
        if differing:
            pairs = ", ".join(f"{name} {made.get(name)} (here {here[name]})" for name in differing)
            yield f"some rows were computed with {pairs}"
