"""From a study to its result: rows in chunks, on this computer or on dask workers.

The first rows always run on this computer. They compile the kernel once, before any worker needs
it, they show what a row costs, and they are the first chunks of the result. A process of its own
computes them, so that a row may crash it, unless the user wants all in one process.
"""

import os
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager, nullcontext
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq import results, store
from uq.changes import refusal_to_extend, what_changed
from uq.errors import InputError
from uq.evaluate import Chunk, evaluate
from uq.interrupts import in_background
from uq.isolation import Evaluate, isolated
from uq.job import Job, Report
from uq.sampling import rows
from uq.study import Study, load_study
from uq.work import Work, work_of

SHORT_SECONDS = 4.0
"""A study whose remaining work is shorter than this is not worth starting workers."""


def run(
    study: Study | str | Path,
    output: str | Path | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    chunk_rows: int | None = None,
    row_limit: float | None = None,
    fresh: bool = False,
    progress: Report | None = None,
    say: Callable[[str], object] = lambda _: None,
) -> xr.Dataset:
    """Run a study and write its result, or return the result that is already there.

    Rows are kept on disk as they arrive: a run that was stopped goes on where it was, and a result
    with fewer samples is extended, where the design allows it.

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
        Called with a `Progress` as rows arrive.
    say : callable, optional
        Called with a line for the user: what was found on disk.

    Returns
    -------
    xarray.Dataset
        See `uq.results`; in memory if it takes less than 200 MB, else read when it is used.

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
    with kept(study, path, fresh, say=say) as there:
        return carry_out(work_of(study), workers, scheduler, chunk_rows, progress, row_limit, there)


@contextmanager
def kept(
    study: Study,
    path: Path,
    fresh: bool = False,
    again: Mapping[str, Any] | None = None,
    say: Callable[[str], object] = lambda _: None,
) -> Iterator[store.DiskStore]:
    """Keep the rows of a run on disk, if there is room for them; see `uq.store.keep`."""
    needed = 2 * store.row_bytes(study) * rows(study)  # the rows, and the result made from them
    store.check_target(path, needed - store.size_kept(path))
    with store.keep(study, path, fresh, again, say) as there:
        yield there


def output_path(study: Study, output: str | Path | None = None) -> Path:
    """Return where the result of a study goes."""
    return Path(output) if output is not None else Path("results") / f"{study.name}.nc"


def finished(study: Study, path: Path) -> xr.Dataset | None:
    """Return the result of this very study, if `path` holds it.

    Its [analysis], comments and sources may have changed since: then the file gets the new text.
    None also where it holds fewer samples, and more can be appended.

    Raises
    ------
    InputError
        When `path` holds something else.
    """
    if not os.path.isfile(path):  # nor can it be seen
        return None
    remedy = "choose another output, or overwrite it with --fresh"
    try:
        ds = results.open_result(path)
    except InputError as error:
        raise InputError(f"{error}; {remedy}") from None
    if ds.attrs["study_identity"] != study.identity:
        change = what_changed(ds.attrs["study"], ds.attrs["model_version"], study)
        raise InputError(f"{path}: holds the result of another study ({change}); {remedy}")
    there, wanted = ds.attrs["samples"], study.design.samples
    if there != wanted:
        problem = remedy if there > wanted else refusal_to_extend(study)
        if problem:
            sizes = f"samples = {there}, not {wanted}"
            raise InputError(f"{path}: holds this study with {sizes}; {problem}")
        return None
    if ds.attrs["study"] != study.text:
        store.write_result(results.relabel(ds, study), path)
        ds = results.open_result(path)
    store.drop_leftovers(path)
    return ds


def compute(
    study: Study,
    workers: int | None = None,
    scheduler: str | None = None,
    chunk_rows: int | None = None,
    progress: Report | None = None,
    row_limit: float | None = None,
) -> xr.Dataset:
    """Run a study without writing anything; parameters as in `run`."""
    return carry_out(work_of(study), workers, scheduler, chunk_rows, progress, row_limit)


def carry_out(
    work: Work,
    workers: int | None = None,
    scheduler: str | None = None,
    chunk_rows: int | None = None,
    progress: Report | None = None,
    row_limit: float | None = None,
    kept: store.DiskStore | None = None,
) -> xr.Dataset:
    """Compute the rows of some work, in memory or to be kept; other parameters as in `run`."""
    if workers is not None and scheduler is not None:
        raise InputError("workers and scheduler exclude each other")
    if workers is not None and workers < 0:
        raise InputError(f"workers must not be negative: {workers}")
    if chunk_rows is not None and chunk_rows < 1:
        raise InputError(f"chunk_rows must be at least 1: {chunk_rows}")
    if row_limit is not None and not row_limit > 0:
        raise InputError(f"the time limit of a row must be positive: {row_limit:g} s")
    if row_limit is not None and workers == 0:
        raise InputError(
            "a time limit for rows needs another process that can be stopped: "
            "workers = 0 has none (leave it out, or take 1)"
        )
    where = kept or store.MemoryStore(work)
    place = nullcontext(_in_process(work)) if workers == 0 else isolated(work, row_limit)
    with place as evaluate_here:
        job = Job(work, chunk_rows, progress or (lambda _: None), where, evaluate_here, row_limit)
        if where.found:
            job.tell()
        _finish(job, workers, scheduler)
    return where.dataset()


def _finish(job: Job, workers: int | None, scheduler: str | None) -> None:
    if scheduler is not None:
        from uq import cluster

        with cluster.remote(scheduler) as crew:  # before anything is computed
            job.pilot(share=1 / 8)
            job.finish_on(crew)
        return
    if not workers:
        job.pilot(share=1)
    if workers == 0 or (workers is None and job.seconds_left < SHORT_SECONDS):
        job.finish_here()
    elif not job.complete:
        from uq import cluster

        with cluster.local(min(workers or cluster.CORES, job.groups)) as crew:
            if workers:
                job.pilot(share=1 / 8)  # while they start
            job.finish_on(crew)


def _in_process(work: Work) -> Evaluate:
    """Return what computes rows in this process: nothing protects it from them."""

    def call(x: NDArray[np.float64], seed: NDArray[np.uint64], start: int) -> Chunk:
        return in_background(lambda: evaluate(work.model, work.settings, x, seed, start))

    return call
