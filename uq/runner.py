"""From a study to its result: rows in chunks, in this process or on dask workers.

The first rows always run here. They compile the kernel once, before any worker needs it, they
show what a row costs, and they are the first chunks of the result.
"""

from pathlib import Path

import xarray as xr

from uq import results, stopping, store
from uq.errors import InputError
from uq.job import Job, Report
from uq.sampling import rows
from uq.study import Study, load_study
from uq.work import Work, more_of, work_of

IN_PROCESS_SECONDS = 4.0
"""A study whose remaining work is shorter than this is not worth starting workers."""


def run(
    study: Study | str | Path,
    output: str | Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    chunk_rows: int | None = None,
    fresh: bool = False,
    progress: Report | None = None,
) -> xr.Dataset:
    """Run a study and write its result, or return the result that is already there.

    Parameters
    ----------
    study : Study, str or Path
        A study, or the path of its file.
    output : str or Path, optional
        Default ``results/<name>.nc``.
    workers : int, optional
        Worker processes; 0 computes in this process. By default this process computes what takes
        a few seconds, else one worker per core.
    scheduler : str, optional
        Address of a running dask scheduler, instead of own workers.
    chunk_rows : int, optional
        Rows per task, rounded up to whole groups of the design; by default half a second of work.
    fresh : bool
        Overwrite whatever `output` holds.
    progress : callable, optional
        Called with a `Progress` as rows arrive.

    Returns
    -------
    xarray.Dataset
        In memory; see `uq.results`.

    Raises
    ------
    InputError
        Before anything is computed, when study or output are not usable.
    KernelError
        When the model does not keep its contract.
    RunError
        When no result can be had: workers that die, a disk that is full.
    """
    if not isinstance(study, Study):
        study = load_study(study)
    path = output_path(study, output)
    if not fresh and (found := finished(study, path)) is not None:
        return found
    store.check_target(path, store.row_bytes(study) * rows(study))
    ds = compute(study, workers, scheduler, chunk_rows, progress)
    store.write(ds, path)
    return ds


def output_path(study: Study, output: str | Path | None = None) -> Path:
    """Return where the result of a study goes."""
    return Path(output) if output is not None else Path("results") / f"{study.name}.nc"


def finished(study: Study, path: Path) -> xr.Dataset | None:
    """Return the result of this very study, if `path` holds it.

    Its [analysis], comments and sources may have changed since: then the file gets the new text.

    Raises
    ------
    InputError
        When `path` holds something else.
    """
    if not path.is_file():
        return None
    remedy = "choose another output, or overwrite it with --fresh"
    try:
        ds = results.open_result(path)
    except InputError as error:
        raise InputError(f"{error}; {remedy}") from None
    if ds.attrs["study_identity"] != study.identity:
        raise InputError(f"{path}: holds the result of another study; {remedy}")
    if ds.attrs["samples"] != study.design.samples and not stopping.ended(study.design, ds):
        raise InputError(
            f"{path}: holds this study with samples = {ds.attrs['samples']}, "
            f"not {study.design.samples}; {remedy}"
        )
    if ds.attrs["study"] != study.text:
        ds = results.relabel(ds, study)
        store.write(ds, path)
    return ds


def compute(
    study: Study,
    workers: int | None = None,
    scheduler: str | None = None,
    chunk_rows: int | None = None,
    progress: Report | None = None,
) -> xr.Dataset:
    """Run a study without writing anything; parameters as in `run`.

    One with [design] until is run look by look, until it has seen enough or spent its budget.
    """
    if study.design.until is None:
        return carry_out(work_of(study), workers, scheduler, chunk_rows, progress)
    ds = None
    for samples in stopping.looks(study.design):
        so_far = study.with_samples(samples)
        work = work_of(so_far) if ds is None else more_of(so_far, ds)
        ds = carry_out(work, workers, scheduler, chunk_rows, progress)
        if stopping.look(study.design, ds).reached:
            break
    assert ds is not None
    return ds


def carry_out(
    work: Work,
    workers: int | None = None,
    scheduler: str | None = None,
    chunk_rows: int | None = None,
    progress: Report | None = None,
) -> xr.Dataset:
    """Compute the rows of some work; other parameters as in `run`."""
    if workers is not None and scheduler is not None:
        raise InputError("workers and scheduler exclude each other")
    if workers is not None and workers < 0:
        raise InputError(f"workers must not be negative: {workers}")
    if chunk_rows is not None and chunk_rows < 1:
        raise InputError(f"chunk_rows must be at least 1: {chunk_rows}")
    job = Job(work, chunk_rows, progress or (lambda _: None))
    if scheduler is not None:
        from uq import cluster

        with cluster.remote(scheduler) as crew:  # before anything is computed
            job.pilot(share=1 / 8)
            job.finish_on(crew)
        return job.store.dataset()
    if not workers:
        job.pilot(share=1)
    if workers == 0 or (workers is None and job.seconds_left < IN_PROCESS_SECONDS):
        job.finish_here()
    elif not job.complete:
        from uq import cluster

        with cluster.local(min(workers or cluster.CORES, job.groups)) as crew:
            if workers:
                job.pilot(share=1 / 8)  # while they start
            job.finish_on(crew)
    return job.store.dataset()
