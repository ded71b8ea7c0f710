"""The existing result of a study."""

import os
from pathlib import Path

import xarray as xr

from uq import store
from uq.errors import InputError
from uq.rows import results, stopping
from uq.study.changes import refusal_to_extend, what_changed
from uq.study.code import is_other_code
from uq.study.definition import Study


def output_path(study: Study, output: str | Path | None = None) -> Path:
    """Return the path of the result of a study."""
    return Path(output) if output is not None else Path("results") / f"{study.name}.nc"


def finished(study: Study, path: Path) -> xr.Dataset | None:
    """Return the result of this study, if `path` holds it.

    If its [analysis], comments or sources have changed since, the file gets the new text. None also
    if it holds fewer samples and more can be appended; a study with [design] until is complete once
    its estimate is precise enough.

    Raises
    ------
    InputError
        When `path` holds something else.
    """
    if not os.path.isfile(path):  # or it is out of reach
        return None
    remedy = "choose another output, or overwrite it with --fresh"
    ds = results.open_result(path, remedy)
    if ds.attrs["study_identity"] != study.identity:
        change = what_changed(ds.attrs["study"], ds.attrs["model_version"], study)
        raise InputError(f"{path}: holds the result of another study ({change}); {remedy}")
    there, wanted = int(ds.attrs["samples"]), study.design.samples
    if there > wanted or (there < wanted and not stopping.ended(study.design, ds)):
        problem = remedy if there > wanted else refusal_to_extend(study)
        if problem:
            sizes = f"samples = {there}, not {wanted}"
            raise InputError(f"{path}: holds this study with {sizes}; {problem}")
        return None
    if ds.attrs["study"] != study.text:
        store.write_result(results.relabel(ds, study.with_samples(there)), path)
        ds = results.open_result(path)
    store.drop_leftovers(path)
    return ds


def made_elsewhere(study: Study, path: Path, ds: xr.Dataset) -> str:
    """Say what to do about rows of a result that other code of the model computed."""
    if not is_other_code(ds.attrs, study.model_reference):
        return ""
    return (
        f"{path}: holds rows that other code of model '{study.model.name}' computed; 'uq verify' "
        "compares them with the code here, 'uq run --fresh' computes all of them again"
    )
