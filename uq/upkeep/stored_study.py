"""The study of a result, or of a run that is not complete."""

import os
from pathlib import Path

from uq.errors import InputError
from uq.rows import results
from uq.store import folder_of
from uq.store.folder import history
from uq.study.changes import what_changed
from uq.study.definition import Study, study_from_text


def study_of(path: Path, model: str | None = None) -> Study:
    """Return the study of a result, or of the rows kept for one that is not complete.

    Parameters
    ----------
    path : Path
        Of the result.
    model : str, optional
        Where its model lives, if it is not installed.

    Returns
    -------
    Study
        With the number of samples of the result or run.

    Raises
    ------
    InputError
        When there is nothing, or the model here differs from the one that computed it.
    """
    identity, text, version, samples = _recorded(path)
    study = study_from_text(text, f"{path}: its study", model).with_samples(samples)
    if study.identity != identity:
        change = what_changed(text, version, study)
        raise InputError(
            f"{path}: was computed with another model ({change}); rerun the study, into another"
            " output or with --fresh"
        )
    return study


def _recorded(path: Path) -> tuple[str, str, str, int]:
    """Return identity, text, version of the model and samples of the study of a result."""
    if not os.path.isfile(path) and (found := history(folder_of(path))):
        run = found.run
        return run.identity, run.study, run.model_version, run.samples
    attrs = results.open_result(path).attrs
    samples = int(attrs["samples"])
    return attrs["study_identity"], attrs["study"], attrs["model_version"], samples
