"""Going further than a run did: more samples, or failed rows once more."""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from uq.contract import Model
from uq.errors import InputError
from uq.inputs.values import read_settings
from uq.rows import results
from uq.rows.workload import work_of
from uq.running import runner
from uq.running.dispatch import Report
from uq.store import folder_of
from uq.store.folder import history
from uq.store.records import RunRecord
from uq.study.changes import refusal_to_extend, what_changed
from uq.study.definition import Study, study_from_text

Say = Callable[[str], object]


def study_of(path: Path, model: str | None = None) -> Study:
    """Return the study of a result, or of the rows kept for one that is not complete.

    Parameters
    ----------
    path : Path
        Of the result.
    model : str, optional
        Where its model lives, if that is not installed.

    Returns
    -------
    Study
        With as many samples as there are, or are to be.

    Raises
    ------
    InputError
        When there is nothing, or the model here is another than the one that made it.
    """
    identity, text, version, samples = _recorded(path)
    study = study_from_text(text, f"{path}: its study", model).with_samples(samples)
    if study.identity != identity:
        change = what_changed(text, version, study)
        raise InputError(
            f"{path}: was computed with another model ({change}); run the study anew, into another"
            " output or with --fresh"
        )
    return study


def _recorded(path: Path) -> tuple[str, str, str, int]:
    """Return identity, text, version of the model and samples of the study of a result."""
    folder = folder_of(path)
    if not path.is_file():
        runs = [run for run in history(folder) if isinstance(run, RunRecord)]
        if runs:
            return runs[-1].identity, runs[-1].study, runs[-1].model_version, runs[-1].samples
    attrs = results.open_result(path).attrs
    names = ("study_identity", "study", "model_version", "samples")
    identity, text, version, samples = (attrs[name] for name in names)
    return identity, text, version, int(samples)


def extend(path: Path, samples: int, model: str | None = None, **options: Any) -> xr.Dataset:
    """Give a result more samples; nothing is computed again.

    Parameters
    ----------
    path : Path
        A result, or what is to become one.
    samples : int
        Base size of each replicate, in all.
    model : str, optional
        Where the model lives, if it is not installed.
    **options
        As `uq.running.runner.run` takes them.

    Returns
    -------
    xarray.Dataset
        The same bits as if so many samples had been asked for from the start.

    Raises
    ------
    InputError
        When the design cannot be extended, or there are more samples already.
    RunError
        As `uq.running.runner.run` does.
    """
    study = study_of(path, model)
    there = study.design.samples
    if samples < there:
        raise InputError(f"--samples {samples}: {path} has {there} already; ask for more")
    problem = refusal_to_extend(study)
    if samples > there and problem:
        raise InputError(f"{path}: {problem}")
    study = study.with_samples(samples)
    # So many are wanted, whatever is known: [design] until has no say.
    design = study.design.model_copy(update={"until": None})
    return runner.run(replace(study, design=design), path, **options)


def rerun_failed(
    path: Path,
    settings: Mapping[str, Any],
    model: str | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    row_limit: float | None = None,
    progress: Report | None = None,
    say: Say = lambda _: None,
    mixed: bool = False,
) -> xr.Dataset:
    """Compute the failed rows of a result again.

    Parameters
    ----------
    path : Path
        A complete result; replaced when all these rows are done.
    settings : dict
        Numerical settings other than the study's; the result says for each row whether it was
        computed with them, in the variable ``rerun``.
    model, workers, scheduler, row_limit, progress, say, mixed
        As in `extend` and `uq.running.runner.run`.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InputError
        When a setting is not admissible, or changes what the outputs are.
    RunError
        As `uq.running.runner.run` does.
    """
    ds = results.open_result(path)
    study = study_of(path, model)
    changed = changed_settings(study, settings)
    failed = int(np.count_nonzero(results.failed(ds)))
    if not failed:
        say(f"{path}: no row failed; there is nothing to do")
        return ds
    differing = {
        name: getattr(changed, name)
        for name in settings
        if getattr(changed, name) != getattr(study.settings, name)
    }
    plain = json.loads(json.dumps(differing))  # as it will be read again
    with runner.kept(study, path, again=plain, say=say, mixed=mixed) as kept:
        work = work_of(study)._replace(settings=changed)
        return runner.carry_out(work, workers, scheduler, None, progress, row_limit, kept)


def changed_settings(study: Study, settings: Mapping[str, Any]) -> Any:
    """Return the settings of a study with some of them changed.

    Raises
    ------
    InputError
        When one is not admissible, or rows would have outputs of other shapes or coordinates.
    """
    changed, wrong = read_settings(study.model, asdict(study.settings) | dict(settings))
    if wrong:
        raise InputError(
            *(
                f"--setting {name} = {settings[name]!r}: {problem}" if name in settings else problem
                for name, problem in wrong.items()
            )
        )
    if _axes(study.model, changed) != _axes(study.model, study.settings):
        names = ", ".join(settings)
        raise InputError(f"--setting {names}: would give these rows other outputs than the others")
    return changed


def _axes(model: Model, settings: Any) -> dict[str, list[Any]]:
    return {dim: list(values) for dim, values in model.coordinates(settings).items()}
