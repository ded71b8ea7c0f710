"""From a study to its result: rows in chunks, on this computer or on dask workers.

The first rows always run on this computer. They compile the kernel once, before any worker needs
it, they show what a row costs, and they are the first chunks of the result. A process of its own
computes them, so that a row may crash it, unless the user wants all in one process.
"""

import os
import warnings
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import xarray as xr

from uq import store
from uq.errors import InputError
from uq.rows import results, stopping
from uq.rows.sampling import rows
from uq.rows.workload import Work, work_of
from uq.running.dispatch import Job, Progress, Report
from uq.running.executor import Computing
from uq.study.changes import refusal_to_extend, what_changed
from uq.study.code import is_other_code
from uq.study.definition import Study, load_study
from uq.study.reading import read_study_text


def run(
    study: Study | str | Path,
    output: str | Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    chunk_rows: int | None = None,
    row_limit: float | None = None,
    fresh: bool = False,
    progress: Report | None = None,
    say: Callable[[str], object] | None = None,
    mixed: bool = False,
) -> xr.Dataset:
    """Run a study and write its result, or return the result that is already there.

    Rows are kept on disk as they arrive: a run that was stopped goes on where it was, and a result
    with fewer samples is extended, where the design allows it. A study with [design] until is
    looked at on the way, and ends when enough is known or its samples are spent.

    Parameters
    ----------
    study : Study, str or Path
        A study, or the path of its file.
    output : str or Path, optional
        Default ``results/<name>.nc``.
    workers : int, optional
        Worker processes; 0 computes in this process, and a row that crashes ends it. By default
        one process computes what takes a few seconds, else one worker per core.
    scheduler : str, optional
        Address of a running dask scheduler, instead of own workers.
    chunk_rows : int, optional
        Rows per task, rounded up to whole groups of the design; by default half a second of work.
    row_limit : float, optional
        Longest time for one row [s]; one that outlives it is stopped and marked ``timed-out``.
    fresh : bool
        Overwrite whatever `output` holds.
    progress : callable, optional
        Called with a `Progress` as rows arrive, and when the model begins to be compiled.
    say : callable, optional
        Called with a line for the user: what was found on disk. Without it, a complete result that
        other code of the model computed is returned with a warning.
    mixed : bool
        Go on also with rows that other code of the model computed.

    Returns
    -------
    xarray.Dataset
        See `uq.rows.results`; in memory if it takes less than 200 MB, else read when it is used.

    Raises
    ------
    InputError
        Before anything is computed, when study or output are not usable.
    KernelError
        When the model does not keep its contract.
    RunError
        When no result can be had: workers that die, a disk that is full.

    Examples
    --------
    >>> ds = uq.run("studies/ishigami.toml")  # in results/ishigami.nc, too
    >>> ds.sizes["sample"]
    10240
    """
    if not isinstance(study, Study):
        study = load_study(study)
    path, until = output_path(study, output), _until(study)
    if not fresh and (found := finished(study, path)) is not None:
        if say is None and not mixed and (line := made_elsewhere(study, path, found)):
            warnings.warn(line, stacklevel=2)
        return found
    with kept(study, path, fresh, say=say or (lambda _: None), mixed=mixed) as there:
        options = (workers, scheduler, chunk_rows, progress, row_limit)
        return carry_out(work_of(study), *options, there, until)


@contextmanager
def kept(
    study: Study,
    path: Path,
    fresh: bool = False,
    again: Mapping[str, Any] | None = None,
    say: Callable[[str], object] = lambda _: None,
    mixed: bool = False,
) -> Iterator[store.DiskStore]:
    """Keep the rows of a run on disk, if there is room for them; see `uq.store.keep`."""
    needed = 2 * store.row_bytes(study) * rows(study)  # the rows, and the result made from them
    store.check_target(path, needed - store.size_kept(path))
    with store.keep(study, path, fresh, again, say, mixed) as there:
        yield there


def output_path(study: Study, output: str | Path | None = None) -> Path:
    """Return where the result of a study goes."""
    return Path(output) if output is not None else Path("results") / f"{study.name}.nc"


def finished(study: Study, path: Path) -> xr.Dataset | None:
    """Return the result of this very study, if `path` holds it.

    Its [analysis], comments and sources may have changed since: then the file gets the new text.
    None also where it holds fewer samples, and more can be appended; a study that may end early is
    complete where enough is known.

    Raises
    ------
    InputError
        When `path` holds something else.
    """
    if not os.path.isfile(path):  # nor can it be seen
        return None
    remedy = "choose another output, or overwrite it with --fresh"
    ds = results.open_result(path, remedy)
    if ds.attrs["study_identity"] != study.identity:
        change = what_changed(ds.attrs["study"], ds.attrs["model_version"], study)
        raise InputError(f"{path}: holds the result of another study ({change}); {remedy}")
    there, wanted = int(ds.attrs["samples"]), study.design.samples
    enough = there < wanted and stopping.ended(study.design, ds)
    if there != wanted and not enough:
        problem = remedy if there > wanted else refusal_to_extend(study)
        if problem:
            sizes = f"samples = {there}, not {wanted}"
            raise InputError(f"{path}: holds this study with {sizes}; {problem}")
        return None
    if ds.attrs["study"] != study.text:
        store.write_result(results.relabel(ds, study.with_samples(there)), path)
        ds = results.open_result(path)
    store.drop_leftovers(path)
    return ds


def made_elsewhere(study: Study, path: Path, ds: xr.Dataset) -> str:
    """Say what to do where rows of a result are of other code of its model than is here."""
    if not is_other_code(ds.attrs, study.model_reference):
        return ""
    return (
        f"{path}: holds rows that other code of model '{study.model.name}' computed; 'uq verify' "
        "compares them with the code here, 'uq run --fresh' computes all of them again"
    )


def compute(
    study: Study,
    workers: int | None = None,
    scheduler: str | None = None,
    chunk_rows: int | None = None,
    progress: Report | None = None,
    row_limit: float | None = None,
) -> xr.Dataset:
    """Run a study without writing anything; parameters as in `run`."""
    options = (workers, scheduler, chunk_rows, progress, row_limit)
    return carry_out(work_of(study), *options, until=_until(study))


def carry_out(
    work: Work,
    workers: int | None = None,
    scheduler: str | None = None,
    chunk_rows: int | None = None,
    progress: Report | None = None,
    row_limit: float | None = None,
    kept: store.DiskStore | None = None,
    until: Study | None = None,
) -> xr.Dataset:
    """Compute the rows of some work, in memory or to be kept.

    Parameters
    ----------
    work : Work
    workers, scheduler, chunk_rows, progress, row_limit
        As in `run`.
    kept : DiskStore, optional
        Where the rows are kept.
    until : Study, optional
        The study that the work is, if it is to be looked at on the way, and may end early.

    Returns
    -------
    xarray.Dataset
    """
    if chunk_rows is not None and chunk_rows < 1:
        raise InputError(f"chunk_rows must be at least 1: {chunk_rows}")
    report = progress or (lambda _: None)
    where = kept or store.MemoryStore(work)

    def compiling() -> None:
        counts = where.done, where.total, where.failed, where.found
        report(Progress(*counts, compiling=True))

    with Computing(work, workers, scheduler, row_limit, compiling) as computing:
        for part in (*_looks(until, where.reach), None):
            stop = work.total if part is None else rows(part)
            job = Job(work, chunk_rows, report, where, computing.evaluate, row_limit, stop)
            if where.found:
                job.tell()
            computing.finish(job)
            if part and until and stopping.look(until.design, where.first(part)).reached:
                where.cut(part)
                job.tell()
                break
    return where.dataset()


def _until(study: Study) -> Study | None:
    """Return the study, if it may end early; looks and intervals are those of its file's budget."""
    if study.design.until is None:
        return None
    budget = read_study_text(study.text, study.path).design.samples
    if study.design.samples != budget:
        raise InputError(
            f"--samples {study.design.samples}: a study with [design] until spends at most the"
            f" samples of its file, {budget}: change them there"
        )
    return study


def _looks(until: Study | None, reach: int) -> list[Study]:
    """Return what to look at before the budget is spent: a run that goes on looks where it was."""
    if until is None:
        return []
    parts = [until.with_samples(samples) for samples in stopping.looks(until.design)]
    return [part for part in parts[:-1] if rows(part) >= reach]
