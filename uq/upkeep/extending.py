"""More samples for a result."""

from dataclasses import replace
from pathlib import Path

import xarray as xr

from uq.errors import InputError
from uq.running import runner
from uq.running.options import DEFAULTS, RunOptions
from uq.study.changes import refusal_to_extend
from uq.upkeep.stored_study import study_of


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
        The same bits as if it had had this many samples from the start.

    Raises
    ------
    InputError
        When the design cannot be extended, or there are more samples already.
    RunError
        As in `uq.running.runner.run`.
    """
    study = study_of(path, model)
    there = study.design.samples
    if samples < there:
        raise InputError(f"--samples {samples}: {path} has {there} already; ask for more")
    problem = refusal_to_extend(study)
    if samples > there and problem:
        raise InputError(f"{path}: {problem}")
    study = study.with_samples(samples)
    # This many are wanted, whatever the precision: [design] until does not apply.
    design = study.design.model_copy(update={"until": None})
    return runner.run_study(replace(study, design=design), path, options)
