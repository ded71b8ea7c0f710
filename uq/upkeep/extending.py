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
    """Give a result more samples; nothing is computed again.

    Parameters
    ----------
    path : Path
        A result, or what is to become one.
    samples : int
        Base size of each replicate, in all.
    model : str, optional
        Where the model lives, if it is not installed.
    options : RunOptions

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
    return runner.run_study(replace(study, design=design), path, options)
