"""Rows computed again: one, compared with what is stored, and all from what they have kept."""

from collections.abc import Mapping
from dataclasses import asdict, replace
from typing import Any

import numpy as np
import xarray as xr

from uq.contract import Again, Batch, Kept, Model, Status, censored_name
from uq.errors import InputError, first_fault_alone
from uq.execution.disk_store import by_settings
from uq.execution.isolation import Isolated, spec_of
from uq.execution.loading import study_of_text
from uq.result import result_file
from uq.result.one_row import Row, computed
from uq.result.result import AnyResult, Result
from uq.result.workload import workload_of
from uq.sampling.named_values import fault_lines, read_settings
from uq.study.definition import Study, what_changed
from uq.study.evaluate import evaluate, examples_of, joined
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


_BLOCK = 512  # rows computed at a time


def recompute(result: AnyResult, changes: Mapping[str, Any]) -> xr.Dataset:
    """Compute a result again under other settings or inputs, without running its machine.

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result whose rows kept what this takes: of the beam, one with ``map_growth``.
    changes : dict of str to object
        Entries of the study file, such as ``{"settings.scar": "flat-bar",
        "fixed.creep_down": 2e-5}``.

    Returns
    -------
    xarray.Dataset
        The result of the changed study, with the same bits as a run of it, except for rows that
        would need the machine: these are out of budget.

    Raises
    ------
    InputError
        When the model keeps nothing, or the changes concern more than its rows can tell.
    """
    result = Result.of(result)
    result.refuse_if_weighted("rows computed again")
    ds = result.dataset
    text, identity, version, samples = (
        ds.attrs[name] for name in ("study", "study_identity", "model_version", "samples")
    )
    source = result_file.file_of(ds)
    studied, difference = study_here(text, identity, version, int(samples), source)
    model, n = studied.model, len(result)
    if model.again is None:
        raise InputError(
            f"what if: rows of '{model.name}' keep nothing from which others are computed:"
            f" '{next(iter(changes))}' needs rows of its own: change it in a study, and run that"
        )
    if difference:
        raise InputError(
            f"{source}: was computed with another model ({difference}): run its study again"
        )
    if any(settings and rows.any() for settings, rows in by_settings(ds)):
        raise InputError(
            f"{source}: rows of it were rerun with other settings: change the study, and run that"
        )
    study = studied.with_changes(changes)
    before, rows = row_block(studied, 0, n), row_block(study, 0, n)
    kept = Kept(before.x, studied.settings, _columns(ds, model))
    first = slice(0, 1)
    try:
        model.again(rows.x[first], rows.seed[first], study.settings, _part(kept, first))
    except ValueError as fault:
        raise InputError(f"what if: {fault}") from None
    chunks = []
    for start in range(0, n, _BLOCK):
        block = slice(start, start + _BLOCK)
        machine = replace(study.model, batch=_batch(model.again, _part(kept, block)))
        chunks.append(evaluate(machine, study.settings, rows.x[block], rows.seed[block], start))
    chunk = joined(chunks)
    failures = examples_of(chunk.failures)
    return result_file.build(study, rows, chunk.columns, chunk.status, failures)


def _batch(again: Again, kept: Kept) -> Batch:
    return lambda x, seed, settings: again(x, seed, settings, kept)


def _part(kept: Kept, rows: slice) -> Kept:
    """Return some of the rows."""
    outputs = {name: values[rows] for name, values in kept.outputs.items()}
    return Kept(kept.x[rows], kept.settings, outputs)


def _columns(ds: xr.Dataset, model: Model) -> dict[str, Any]:
    """Return the outputs of a result as ``batch`` returned them."""
    columns = {}
    for name, output in model.outputs.items():
        columns[name] = ds[name].values
        if output.has_censored_flag:
            flag = censored_name(name)
            columns[flag] = ds[flag].values.astype(bool)
    return {name: np.ascontiguousarray(values) for name, values in columns.items()}
