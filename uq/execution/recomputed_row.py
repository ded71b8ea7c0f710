"""Recomputation of a stored row, and its comparison with the stored values."""

from collections.abc import Mapping
from dataclasses import asdict
from typing import Any

import numpy as np
import xarray as xr

from uq.contract import Status, censored_name
from uq.errors import InputError, first_fault_alone
from uq.execution.disk_store import by_settings
from uq.execution.isolation import Isolated, spec_of
from uq.execution.loading import study_of_text
from uq.result.one_row import Row, computed
from uq.result.workload import workload_of
from uq.sampling.named_values import fault_lines, read_settings
from uq.study.definition import Study, what_changed
from uq.study.installed_models import find_model, made_here
from uq.study.row_sampling import row_block


def study_here(
    text: str, identity: str, version: str, samples: int, source: str, model: str | None = None
) -> tuple[Study, str]:
    """Return a study under the installed model, and its first difference from the stored study.

    Parameters
    ----------
    text : str
        The study file.
    identity, version : str
        Of the study and of its model when its rows were computed.
    samples : int
    source : str
        Name of the result in messages.
    model : str, optional
        Where the model lives, if it is not installed.

    Returns
    -------
    study : Study
    change : str
        The first difference; "" if it is the same study.

    Raises
    ------
    InputError
        When there is no such model, or the study does not suit it.
    """
    study = study_of_text(text, f"{source}: its study", model).with_samples(samples)
    return study, "" if study.identity == identity else what_changed(text, version, study)


def changed_settings(study: Study, settings: Mapping[str, Any]) -> Any:
    """Return the settings of a study with some changes.

    Raises
    ------
    InputError
        When one is not admissible, or would change shapes or coordinates of the outputs.
    """
    changed, wrong = read_settings(study.model, asdict(study.settings) | dict(settings))
    if wrong:
        raise InputError(*fault_lines("setting ", settings, wrong))
    axes, others = (
        {dim: list(values) for dim, values in study.model.coordinates(variant).items()}
        for variant in (changed, study.settings)
    )
    if axes != others:
        names = ", ".join(settings)
        raise InputError(f"setting {names}: would give these rows other outputs than the rest")
    return changed


def settings_by_row(ds: xr.Dataset, study: Study, places: np.ndarray) -> dict[int, Any]:
    """Return the settings used to compute the given rows of a result, by position."""
    settings: dict[int, Any] = {}
    for changes, rows in by_settings(ds):
        matching = places[rows[places]].tolist()
        if matching:
            with first_fault_alone():
                settings |= dict.fromkeys(matching, changed_settings(study, changes))
    return settings


def other_versions(ds: xr.Dataset, model: str | None = None) -> dict[str, tuple[str, str]]:
    """Return the versions that differ from those that made a result: name -> (there, here).

    Compared are processor, Python, libraries and the code of the model.
    """
    if model is None:
        find_model(model := str(ds.attrs["model"]))  # refuses all but the name of an installed one
    pairs = made_here(model).items()
    versions = {name: (str(ds.attrs.get(name, "unknown")), here) for name, here in pairs}
    return {name: (made, here) for name, (made, here) in versions.items() if made != here}


def computed_again(study: Study, settings: Any, number: int, status: int = Status.OK) -> Row:
    """Compute a row of a study.

    Parameters
    ----------
    study : Study
    settings : object
        Of this row.
    number : int
        From 0.
    status : int
        Stored status: a row that crashed is computed in a separate process.

    Returns
    -------
    Row
    """
    rows = row_block(study, number, number + 1)
    values = dict(zip(study.model.parameter_names, rows.x[0].tolist(), strict=True))
    seed = int(rows.seed[0])
    if status != Status.CRASHED:
        return computed(study.model, settings, values, seed)
    spec = spec_of(workload_of(study)._replace(settings=settings))
    with Isolated(spec).running() as batch:
        return computed(study.model, settings, values, seed, lambda x, seeds: batch(x, seeds, 0))


def differing(again: Row, stored: xr.Dataset) -> list[str]:
    """Return the names of variables that are not bitwise equal in a row and the stored one.

    Parameters
    ----------
    again : Row
    stored : xarray.Dataset
        The row in the result, along a dimension ``sample`` of size 1.
    """
    columns = {name: np.float64(value) for name, value in again.values.items()} | again.columns
    columns |= {"status": again.status}
    flags = {censored_name(name) for name in again.model.outputs}
    return [
        name
        for name, values in columns.items()
        if name not in stored.variables
        or np.asarray(values, np.int8 if name in flags else None).tobytes()
        != stored[name].values.tobytes()
    ]


def largest_change(again: Row, stored: xr.Dataset) -> float:
    """Return the largest relative difference between the numbers of a row and the stored one.

    It is infinite where an output of another type differs, or is missing on one side.
    """
    largest = 0.0
    for name in differing(again, stored):
        values = again.columns.get(name, again.values.get(name))
        if values is None or name not in stored.variables:
            return np.inf
        now, before = np.ravel(values), np.ravel(stored[name].values)
        if now.dtype.kind != "f" or now.shape != before.shape:
            return np.inf
        both = np.isfinite(now) & np.isfinite(before)
        if not np.array_equal(now[~both], before[~both], equal_nan=True):
            return np.inf
        scale = np.maximum(np.abs(now[both]), np.abs(before[both]))
        change = np.abs(now[both] - before[both]) / np.where(scale > 0, scale, 1.0)
        largest = max(largest, change.max(initial=0.0))
    return float(largest)
