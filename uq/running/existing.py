"""The result of a study that is already there."""

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
    """Return where the result of a study goes."""
    return Path(output) if output is not None else Path("results") / f"{study.name}.nc"


def finished(study: Study, path: Path) -> xr.Dataset | None:
    """Return the result of this very study, if `path` holds it.

    Its [analysis], comments and sources may have changed since: then the file gets the new text.
    None also where it holds fewer samples, and more can be appended; a study that may end early is
    complete where enough is known.

    Raises
    ------
    InputError
        When `path` holds something else.
    """
    if not os.path.isfile(path):  # nor can it be seen
        return None
    remedy = "choose another output, or overwrite it with --fresh"
    ds = results.open_result(path, remedy)
    if ds.attrs["study_identity"] != study.identity:
        change = what_changed(ds.attrs["study"], ds.attrs["model_version"], study)
        raise InputError(f"{path}: holds the result of another study ({change}); {remedy}")
    there, wanted = int(ds.attrs["samples"]), study.design.samples
    enough = there < wanted and stopping.ended(study.design, ds)
    if there != wanted and not enough:
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
    """Say what to do where rows of a result are of other code of its model than is here."""
    if not is_other_code(ds.attrs, study.model_reference):
        return ""
    return (
        f"{path}: holds rows that other code of model '{study.model.name}' computed; 'uq verify' "
        "compares them with the code here, 'uq run --fresh' computes all of them again"
    )
