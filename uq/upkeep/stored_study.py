"""The study that a result, or what is to become one, holds."""

from pathlib import Path

from uq.errors import InputError
from uq.rows import results
from uq.store import folder_of
from uq.store.folder import history
from uq.store.records import RunRecord
from uq.study.changes import what_changed
from uq.study.definition import Study, study_from_text


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
