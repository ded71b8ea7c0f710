"""Run of a study: rows in chunks, on this computer or on dask workers.

The first rows always run on this computer. They compile the kernel once, before any worker needs
it, measure the cost of a row, and are the first chunks of the result. A separate process computes
them, because a row may crash it, unless the user requests a single process.
"""

import os
import warnings
from pathlib import Path

import xarray as xr

from uq.assess import stopping
from uq.assess.stopping import out_of_reach
from uq.errors import InputError
from uq.execution import disk_store, resuming, tally
from uq.execution.executor import Dispatcher, Executor
from uq.execution.loading import load_study
from uq.execution.options import Progress, Report, RunOptions, Say, ignore
from uq.execution.scaling_checks import check_scales
from uq.files import whole_files
from uq.result import result_file
from uq.result.result import Result
from uq.result.result_file import with_model
from uq.result.weights import has_weights, weighted_by
from uq.result.workload import Workload, workload_of
from uq.study.definition import Study, refusal_to_extend, what_changed
from uq.study.hints import hints
from uq.study.installed_models import is_other_code
from uq.study.reading import read_study_text
from uq.study.row_sampling import rows


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
    """Run a study and write its result, or return the existing result.

    Rows are kept on disk as they arrive: an interrupted run resumes, and a result with fewer
    samples is extended where the design allows it. A study with [design] until ends when its
    estimate is precise enough, or its samples are spent.

    Parameters
    ----------
    study : Study, str or Path
        A study, or the path of its file.
    output : str or Path, optional
        Default ``results/<name>.nc``.
    workers : int, optional
        Worker processes; 0 computes in this process, which a crashing row ends. By default one
        process computes what takes a few seconds, else one worker per core. Jobs of a cluster for
        a machine file with a table [queue].
    scheduler : str, optional
        Address of a running dask scheduler, instead of own workers.
    chunk_rows : int, optional
        Rows per task, rounded up to whole groups of the design; by default half a second of work.
    row_limit : float, optional
        Time limit of a row [s]; rows that exceed it are stopped and marked ``timed-out``.
    fresh : bool
        Overwrite an existing `output`.
    progress : callable, optional
        Called with a `Progress` as rows arrive, and when compilation of the model starts.
    say : callable, optional
        Called with a line for the user: what was found on disk. Without it, a complete result
        from another version of the model's code is returned with a warning.
    mixed : bool
        Also reuse rows from another version of the model's code.

    Returns
    -------
    xarray.Dataset
        See `uq.result.result_file`; in memory if it takes less than 200 MB, else read on use.

    Raises
    ------
    InputError
        Before anything is computed, when study or output cannot be used.
    KernelError
        When the model breaks its contract.
    RunError
        When there is no result: workers die, a disk is full.

    Examples
    --------
    >>> ds = uq.run("studies/ishigami.toml")  # also in results/ishigami.nc
    >>> ds.sizes["row"]
    10240
    """
    if not isinstance(study, Study):
        study = load_study(study, row_limit=row_limit)
    else:
        check_scales(study, row_limit)  # its laws may have changed since it was loaded
    path = output_path(study, output)
    options = RunOptions(
        workers, scheduler, chunk_rows, row_limit, fresh, mixed, progress or ignore, say or ignore
    )
    ds = with_model(run_study(study, path, options), study.model_reference)
    if say is None and not mixed and (line := line_on_other_code(study, path, ds)):
        warnings.warn(line, stacklevel=2)
    return ds


def run_study(study: Study, path: Path, options: RunOptions) -> xr.Dataset:
    """Run a study into a file, or return the existing result; see `run`."""
    _check_budget(study)
    if not options.fresh and (existing := finished(study, path)) is not None:
        return existing
    with resuming.keep(study, path, options) as kept:
        for sentence in hints(study):
            options.say(sentence)
        return carry_out(workload_of(study), options, kept, study)


def output_path(study: Study, output: str | Path | None = None) -> Path:
    """Return the path of the result of a study."""
    return Path(output) if output is not None else Path("results") / f"{study.name}.nc"


def finished(study: Study, path: Path) -> xr.Dataset | None:
    """Return the result of this study, if it is in `path`.

    If its [analysis], comments or sources have changed since, the file gets the new text. None also
    if it holds fewer samples and more can be appended; a study with [design] until is complete once
    its estimate is precise enough.

    Raises
    ------
    InputError
        When `path` contains something else.
    """
    if not os.path.isfile(path):  # or it is out of reach
        return None
    remedy = "choose another output, or overwrite it with --fresh"
    ds = result_file.open_result(path, remedy)
    if has_weights(ds):
        raise InputError(f"{path}: has rows that {weighted_by(ds)}; {remedy}")
    if ds.attrs["study_identity"] != study.identity:
        change = what_changed(ds.attrs["study"], ds.attrs["model_version"], study)
        raise InputError(f"{path}: has the result of another study ({change}); {remedy}")
    samples, wanted = int(ds.attrs["samples"]), study.design.samples
    if samples > wanted or (samples < wanted and not stopping.ended(study.design, Result(ds))):
        problem = remedy if samples > wanted else refusal_to_extend(study)
        if problem:
            sizes = f"samples = {samples}, not {wanted}"
            raise InputError(f"{path}: has this study with {sizes}; {problem}")
        return None
    if ds.attrs["study"] != study.text:
        whole_files.write_result(result_file.relabel(ds, study.with_samples(samples)), path)
        ds = result_file.open_result(path)
    resuming.drop_leftovers(path)
    return ds


def line_on_other_code(study: Study, path: Path, ds: xr.Dataset) -> str:
    """Return advice on rows of a result computed by another version of the model."""
    if not is_other_code(ds.attrs, study.model_reference):
        return ""
    return (
        f"{path}: has rows from other code of model '{study.model.name}'; 'uq verify' "
        "compares them with the code here, 'uq run --fresh' computes all of them again"
    )


def carry_out(
    workload: Workload,
    options: RunOptions,
    kept: disk_store.DiskStore | None = None,
    study: Study | None = None,
) -> xr.Dataset:
    """Compute the rows of a workload.

    Parameters
    ----------
    workload : Workload
    options : RunOptions
    kept : DiskStore, optional
        Where to keep the rows; in memory by default.
    study : Study, optional
        The study of the rows kept on disk, which may have a [design] until.

    Returns
    -------
    xarray.Dataset
    """
    store = kept or tally.MemoryStore(workload)

    def compiling() -> None:
        counts = store.done, store.total, store.failed, store.reused
        options.progress(Progress(*counts, compiling=True))

    warned = False
    with Executor(workload, options, compiling) as executor:
        for part in (*_interim_studies(study, kept), None):
            stop = rows(part) if part else workload.total
            dispatcher = Dispatcher(workload, options, store, executor.evaluate, stop)
            if store.reused:
                dispatcher.report_progress()
            executor.finish(dispatcher)
            if not (study and kept and part):
                break
            seen = stopping.interim_estimate(study.design, Result(kept.first(part)))
            if seen.reached:
                kept.cut(part)
                dispatcher.report_progress()
                break
            if not warned and (line := out_of_reach(study.design, seen, part.design.samples)):
                options.say(line)
                warned = True
    return store.dataset()


def _check_budget(study: Study) -> None:
    """Refuse a study with [design] until if its number of samples differs from its file."""
    if study.design.until is not None:
        budget = read_study_text(study.text, study.path).design.samples
        if study.design.samples != budget:
            raise InputError(
                f"samples = {study.design.samples}: a study with [design] until uses at most the"
                f" samples of its file, {budget}: change them there"
            )


def _interim_studies(study: Study | None, kept: disk_store.DiskStore | None) -> list[Study]:
    """Return the study at each interim size, starting with the one reached by a resumed run."""
    if study is None or kept is None or study.design.until is None:
        return []
    parts = [study.with_samples(samples) for samples in stopping.interim_sizes(study.design)]
    return [part for part in parts[:-1] if rows(part) >= kept.end]
