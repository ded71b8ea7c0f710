"""From a study to its result: rows in chunks, on this computer or on dask workers.

The first rows always run on this computer. They compile the kernel once, before any worker needs
it, they show what a row costs, and they are the first chunks of the result. A process of its own
computes them, so that a row may crash it, unless the user wants all in one process.
"""

import warnings
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import xarray as xr

from uq import store
from uq.errors import InputError
from uq.rows import stopping
from uq.rows.sampling import rows
from uq.rows.workload import Workload, workload_of
from uq.running.dispatch import Dispatcher
from uq.running.executor import Executor
from uq.running.existing import finished, made_elsewhere, output_path
from uq.running.options import RunOptions, Say, ignore
from uq.running.progress import Progress, Report
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
    say: Say | None = None,
    mixed: bool = False,
) -> xr.Dataset:
    """Run a study and write its result, or return the result that is already there.

    Rows are kept on disk as they arrive: a run that was stopped goes on where it was, and a result
    with fewer samples is extended, where the design allows it. A study with [design] until ends
    when its estimate is known well enough, or its samples are spent.

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
        When there is no result: workers die, a disk is full.

    Examples
    --------
    >>> ds = uq.run("studies/ishigami.toml")  # in results/ishigami.nc, too
    >>> ds.sizes["sample"]
    10240
    """
    if not isinstance(study, Study):
        study = load_study(study)
    path = output_path(study, output)
    options = RunOptions(
        workers,
        scheduler,
        chunk_rows,
        row_limit,
        fresh,
        mixed,
        progress=progress or ignore,
        say=say or ignore,
    )
    ds = run_study(study, path, options)
    if say is None and not mixed and (line := made_elsewhere(study, path, ds)):
        warnings.warn(line, stacklevel=2)
    return ds


def run_study(study: Study, path: Path, options: RunOptions) -> xr.Dataset:
    """Run a study into a file, or return the result that is already there; as `run`."""
    until = _until(study)
    if not options.fresh and (found := finished(study, path)) is not None:
        return found
    with kept(study, path, options) as there:
        return carry_out(workload_of(study), options, there, until)


@contextmanager
def kept(
    study: Study, path: Path, options: RunOptions, again: Mapping[str, Any] | None = None
) -> Iterator[store.DiskStore]:
    """Keep the rows of a run on disk, if there is room for them; see `uq.store.keep`."""
    needed = 2 * store.row_bytes(study) * rows(study)  # the rows, and the result made from them
    store.check_target(path, needed - store.size_kept(path))
    with store.keep(study, path, options.fresh, again, options.say, options.mixed) as there:
        yield there


def compute(study: Study, **options: Any) -> xr.Dataset:
    """Run a study without writing anything; options as those of `RunOptions`."""
    return carry_out(workload_of(study), RunOptions(**options), until=_until(study))


def carry_out(
    workload: Workload,
    options: RunOptions,
    kept: store.DiskStore | None = None,
    until: Study | None = None,
) -> xr.Dataset:
    """Compute the rows of some workload, in memory or to be kept.

    Parameters
    ----------
    workload : Workload
    options : RunOptions
    kept : DiskStore, optional
        Where the rows are kept.
    until : Study, optional
        The study that the workload is, if it may end early.

    Returns
    -------
    xarray.Dataset
    """
    there = kept or store.MemoryStore(workload)

    def compiling() -> None:
        counts = there.done, there.total, there.failed, there.found
        options.progress(Progress(*counts, compiling=True))

    with Executor(workload, options, compiling) as executor:
        for part in (*_interim_studies(until, there.reach), None):
            stop = workload.total if part is None else rows(part)
            dispatcher = Dispatcher(workload, options, there, executor.evaluate, stop)
            if there.found:
                dispatcher.report_progress()
            executor.finish(dispatcher)
            if part is None or until is None:
                break
            if stopping.interim_estimate(until.design, there.first(part)).reached:
                there.cut(part)
                dispatcher.report_progress()
                break
    return there.dataset()


def _until(study: Study) -> Study | None:
    """Return the study, if it may end early: at the interim sizes of its file's budget."""
    if study.design.until is None:
        return None
    budget = read_study_text(study.text, study.path).design.samples
    if study.design.samples != budget:
        raise InputError(
            f"--samples {study.design.samples}: a study with [design] until spends at most the"
            f" samples of its file, {budget}: change them there"
        )
    return study


def _interim_studies(until: Study | None, reach: int) -> list[Study]:
    """Return the study at each interim size from `reach` on, where a resumed run stood."""
    if until is None:
        return []
    parts = [until.with_samples(samples) for samples in stopping.interim_sizes(until.design)]
    return [part for part in parts[:-1] if rows(part) >= reach]
