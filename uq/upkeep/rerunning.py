"""Failed rows computed again, with other numerical settings if need be."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from uq import store
from uq.errors import InputError
from uq.inputs.values import read_settings
from uq.rows import results
from uq.rows.workload import workload_of
from uq.running import runner
from uq.running.options import DEFAULTS, RunOptions
from uq.study.definition import Study
from uq.upkeep.stored_study import study_of


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
        As in `uq.running.runner.run`.
    """
    ds = results.open_result(path)
    study = study_of(path, model)
    changed = changed_settings(study, settings)
    failed = int(np.count_nonzero(results.failed(ds)))
    if not failed:
        options.say(f"{path}: no row failed; nothing to do")
        return ds
    differing = {
        name: getattr(changed, name)
        for name in settings
        if getattr(changed, name) != getattr(study.settings, name)
    }
    plain = json.loads(json.dumps(differing))  # as read back later
    with store.keep(study, path, options.fresh, plain, options.say, options.mixed) as kept:
        workload = workload_of(study)._replace(settings=changed)
        return runner.carry_out(workload, options, kept)


def changed_settings(study: Study, settings: Mapping[str, Any]) -> Any:
    """Return the settings of a study with some changes.

    Raises
    ------
    InputError
        When one is not admissible, or would change shapes or coordinates of the outputs.
    """
    changed, wrong = read_settings(study.model, asdict(study.settings) | dict(settings))
    if wrong:
        raise InputError(
            *(
                f"--setting {name} = {settings[name]!r}: {problem}" if name in settings else problem
                for name, problem in wrong.items()
            )
        )
    axes, others = (
        {dim: list(values) for dim, values in study.model.coordinates(each).items()}
        for each in (changed, study.settings)
    )
    if axes != others:
        names = ", ".join(settings)
        raise InputError(f"--setting {names}: would give these rows other outputs than the rest")
    return changed
