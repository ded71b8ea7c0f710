"""Changes to an existing result: extend it, rerun failed rows, or verify rows."""

import json
import os
from collections.abc import Mapping
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from uq.contract import Status
from uq.errors import InputError
from uq.execution import resuming, runner
from uq.execution.options import DEFAULTS, RunOptions
from uq.execution.recomputation import (
    changed_settings,
    computed_again,
    differing,
    largest_change,
    settings_by_row,
    study_here,
)
from uq.execution.row_folder import folder_of, history
from uq.files.netcdf_files import is_intact
from uq.result import result_file
from uq.result.weights import refuse_if_weighted
from uq.result.workload import workload_of
from uq.study.definition import Study, refusal_to_extend


def study_of(path: Path, model: str | None = None) -> Study:
    """Return the study of a result, complete or not.

    Parameters
    ----------
    path : Path
        Of the result.
    model : str, optional
        Location of its model, if it is not installed.

    Returns
    -------
    Study
        With the number of samples of the result or run.

    Raises
    ------
    InputError
        When nothing is there, or the installed model differs from the one that computed it.
    """
    if not os.path.isfile(path) and (run_history := history(folder_of(path))):
        run = run_history.run
        recorded = run.study, run.identity, run.model_version, run.samples
    else:
        ds = result_file.open_result(path)
        refuse_if_weighted(ds, "rows computed again or added")
        names = ("study", "study_identity", "model_version", "samples")
        text, identity, version, samples = (ds.attrs[name] for name in names)
        recorded = text, identity, version, int(samples)
    study, change = study_here(*recorded, str(path), model)
    if change:
        raise InputError(
            f"{path}: was computed with another model ({change}); rerun the study, into another"
            " output or with --fresh"
        )
    return study


def extend(
    path: Path, samples: int, model: str | None = None, options: RunOptions = DEFAULTS
) -> xr.Dataset:
    """Add samples to a result; nothing is computed again.

    Parameters
    ----------
    path : Path
        A result, complete or not.
    samples : int
        Total base size of each replicate.
    model : str, optional
        Where its model lives, if it is not installed.
    options : RunOptions

    Returns
    -------
    xarray.Dataset
        Bitwise equal to a run with this many samples from the start.

    Raises
    ------
    InputError
        When the design cannot be extended, or there are more samples already.
    RunError
        As in `uq.execution.runner.run`.
    """
    study = study_of(path, model)
    current = study.design.samples
    if samples < current:
        raise InputError(f"samples = {samples}: {path} has {current} already; ask for more")
    problem = refusal_to_extend(study)
    if samples > current and problem:
        raise InputError(f"{path}: {problem}")
    study = study.with_samples(samples)
    # The requested number is computed at any precision: [design] until does not apply.
    design = study.design.model_copy(update={"until": None})
    return runner.run_study(replace(study, design=design), path, options)


def rerun_failed(
    path: Path,
    settings: Mapping[str, Any],
    model: str | None = None,
    options: RunOptions = DEFAULTS,
) -> xr.Dataset:
    """Compute the failed rows of a result again.

    Parameters
    ----------
    path : Path
        A complete result; replaced once all these rows are done.
    settings : dict
        Numerical settings that differ from the study's; the variable ``rerun`` of the result says
        which rows were computed with them.
    model : str, optional
        Where the model lives, if it is not installed.
    options : RunOptions

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InputError
        When a setting is not admissible, or changes the outputs.
    RunError
        As in `uq.execution.runner.run`.
    """
    ds = result_file.open_result(path)
    study = study_of(path, model)
    changed = changed_settings(study, settings)
    failed = int(np.count_nonzero(result_file.failed(ds)))
    if not failed:
        options.say(f"{path}: no row is invalid; nothing to do")
        return ds
    new, old = asdict(changed), asdict(study.settings)
    differing = {name: new[name] for name in settings if new[name] != old[name]}
    plain = json.loads(json.dumps(differing))  # as read back later
    with resuming.keep(study, path, options, plain) as kept:
        workload = workload_of(study)._replace(settings=changed)
        return runner.carry_out(workload, options, kept)


ROWS = 16
"""Number of rows to recompute."""

_NOT_AGAIN = (Status.CRASHED, Status.TIMED_OUT)  # they would crash or block this process too


def checksum_holds(path: Path) -> bool | None:
    """Return whether the checksum of a result matches; None if it has no checksum.

    Raises
    ------
    InputError
        When it cannot be read.
    """
    result_file.open_result(path)
    try:
        return is_intact(path)
    except result_file.UNREADABLE:
        raise InputError(f"{path}: not a readable netCDF file") from None


def recompute(path: Path, model: str | None = None) -> tuple[list[int], dict[str, float]]:
    """Recompute a few random rows of a result, and compare them bit by bit.

    Rows that crashed or timed out are skipped.

    Parameters
    ----------
    path : Path
    model : str, optional
        Where the model lives, if it is not installed.

    Returns
    -------
    rows : list of int
        Numbers of the recomputed rows.
    differences : dict of str to float
        For each row that differs a phrase, and by how much its numbers differ, relative to
        themselves.

    Raises
    ------
    InputError
        When the model is missing or differs.
    """
    ds, study = result_file.open_result(path), study_of(path, model)
    candidates = np.flatnonzero(~np.isin(ds["status"].values, _NOT_AGAIN))
    count = min(ROWS, len(candidates))
    chosen = np.sort(np.random.default_rng().choice(candidates, count, replace=False))
    settings = settings_by_row(ds, study, chosen)
    differences = {}
    for row, row_settings in sorted(settings.items()):
        again, stored = computed_again(study, row_settings, row), ds.isel(row=[row])
        if names := differing(again, stored):
            differences[f"row {row}: {', '.join(names)}"] = largest_change(again, stored)
    return sorted(settings), differences
