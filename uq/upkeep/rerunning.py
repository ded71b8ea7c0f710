"""Failed rows once more, with other numerical settings if need be."""

import json
from collections.abc import Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from uq.contract import Model
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
        A complete result; replaced when all these rows are done.
    settings : dict
        Numerical settings other than the study's; the result says for each row whether it was
        computed with them, in the variable ``rerun``.
    model : str, optional
        Where the model lives, if it is not installed.
    options : RunOptions

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
        options.say(f"{path}: no row failed; there is nothing to do")
        return ds
    differing = {
        name: getattr(changed, name)
        for name in settings
        if getattr(changed, name) != getattr(study.settings, name)
    }
    plain = json.loads(json.dumps(differing))  # as it will be read again
    with runner.kept(study, path, options, again=plain) as kept:
        workload = workload_of(study)._replace(settings=changed)
        return runner.carry_out(workload, options, kept)


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
