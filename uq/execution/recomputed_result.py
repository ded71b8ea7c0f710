"""A result computed again, under other settings and inputs, from what its rows have kept."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import xarray as xr

from uq.contract import Again, Batch, Kept, Model, censored_name
from uq.errors import InputError
from uq.execution.disk_store import by_settings
from uq.execution.recomputed_row import study_here
from uq.result import result_file
from uq.result.result import AnyResult, Result
from uq.study.evaluate import evaluate, examples_of, joined
from uq.study.row_sampling import row_block

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
