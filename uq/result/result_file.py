"""The schema of a result: one flat, self-describing Dataset, built and checked here.

One dimension ``row``; one variable per parameter (``role`` is ``input`` where it is uncertain,
``fixed`` where it is one number), one per output (``role="output"``, plus the model's own
dimensions), one ``<name>_censored`` beside each lifetime that can be censored, and ``status``.
``replicate``, ``group`` and ``block`` give the place of a row in the design. Nothing depends on the
clock, the host, chunks or workers.
"""

import os
import re
import shlex
import warnings
from collections.abc import Mapping
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Floats, Mask, Model
from uq.errors import InputError, choices, nearest_file
from uq.files.netcdf_files import CHECKSUM, SIGNATURES, most_bytes, refuse_tricks
from uq.files.whole_files import node
from uq.result.soundness import unsound
from uq.result.variables import (
    SCHEMA_VERSION,
    Columns,
    coordinates,
    model_attributes,
    output_variables,
    outputs_of,
    parameter_variable,
    places,
    study_attributes,
)
from uq.study.evaluate import failed_rows
from uq.study.file import source_of_fixed
from uq.study.installed_models import FIELD_RECORD, made_here, model_names, without_returns
from uq.study.model_files import file_with, shortened
from uq.study.provenance import provenance
from uq.text.literals import without_control

if TYPE_CHECKING:
    from uq.study.definition import Study
    from uq.study.row_sampling import Rows


_FILE = "result_file"
_MODEL = "model_reference"
_NEAR = 3  # folders: the current one, the result's, and the one above


def named(ds: xr.Dataset, file: str) -> xr.Dataset:
    """Return a result with the file name to use in suggested commands."""
    ds.encoding[_FILE] = file
    return ds


def file_of(ds: xr.Dataset) -> str:
    """Return the file of a result as a shell reads it, OUT if it is not recorded."""
    return shlex.quote(str(ds.encoding.get(_FILE, "OUT")))


def with_model(ds: xr.Dataset, reference: str) -> xr.Dataset:
    """Return a result with the model reference to use in suggested commands."""
    ds.encoding[_MODEL] = without_returns(reference)
    return ds


def model_option(ds: xr.Dataset) -> str:
    """Return ``--model`` and a file, after a blank, for rows of a model that is not installed here.

    The file that the user gave, one here or near the result that has the model, else FILE.
    """
    model = ds.attrs["model"]
    given = ds.encoding.get(_MODEL, model)
    if given != model:
        return f" --model {shortened(given)}"
    if model == FIELD_RECORD or model in model_names():
        return ""
    folders = [Path(), *Path(str(ds.encoding.get(_FILE, "."))).parents][:_NEAR]
    return f" --model {file_with(model, folders) or 'FILE'}"


UNREADABLE = (OSError, ValueError, RuntimeError, AttributeError, LookupError, TypeError)
"""Exceptions that netCDF4 and xarray raise for damaged files."""

_IN_MEMORY_BYTES = 200_000_000
_MOST_READ = 100_000  # bytes of a file that is no result, to tell what it is


def build(
    study: "Study",
    rows: "Rows",
    columns: Columns,
    status: NDArray[np.int8],
    failures: Mapping[str, str],
    numbers: NDArray[np.int64] | None = None,
) -> xr.Dataset:
    """Return the rows of a study and the outputs of the model as one Dataset.

    Parameters
    ----------
    study : Study
    rows : Rows
        Inputs and place in the design, n rows.
    columns : dict of str to ndarray
        The concatenated columns of ``batch``: output name -> (n, *dims), ``<name>_censored`` -> (n,
        *dims).
    status : ndarray of int8, shape (n,)
    failures : dict of str to str
        Status label -> what happened to the first row with that status.
    numbers : ndarray of int64, shape (n,), optional
        Of the rows; by default 0 to n - 1.

    Returns
    -------
    xarray.Dataset
    """
    model = study.model
    varied = dict(study.uncertain) | dict(study.tied)
    nested = study.design.rows_of_a_sample > 1
    inputs = {
        name: parameter_variable(
            model, name, rows.x[:, i], varied[name].source, study.level(name) if nested else ""
        )
        if name in varied
        else parameter_variable(
            model,
            name,
            study.fixed.get(name, model.nominal[name]),
            source_of_fixed(study.fixed.get(name, 0.0)),
        )
        for i, name in enumerate(model.parameter_names)
    }
    ds = xr.Dataset(
        inputs | output_variables(model, study.settings, columns, status, failures),
        places(study, rows, numbers) | coordinates(model, study.settings),
        study_attributes(study),
    )
    for variable in ds.variables.values():
        variable.encoding["_FillValue"] = None
    return ds


def build_rows(
    model: Model,
    settings: Any,
    values: Mapping[str, float | Floats],
    columns: Columns,
    status: NDArray[np.int8],
    failures: Mapping[str, str],
) -> xr.Dataset:
    """Return rows computed outside a study as a Dataset of the same schema.

    Parameters
    ----------
    model : Model
    settings : object
    values : dict of str to float or ndarray, shape (n,)
        Every parameter.
    columns, status, failures
        As in `build`.

    Returns
    -------
    xarray.Dataset
    """
    inputs = {name: parameter_variable(model, name, value) for name, value in values.items()}
    attrs = {"title": model.title} | model_attributes(model) | provenance()
    outputs = output_variables(model, settings, columns, status, failures)
    return xr.Dataset(inputs | outputs, coordinates(model, settings), attrs)


def open_result(path: str | Path, remedy: str = "") -> xr.Dataset:
    """Open a result and check its schema.

    A result below 200 MB is read into memory and its file closed; a larger one is read lazily.

    Parameters
    ----------
    path : str or Path
    remedy : str, optional
        The advice in error messages; default: how results are made.

    Returns
    -------
    xarray.Dataset

    Raises
    ------
    InputError
        When the file does not exist, is not netCDF, or is not a result of this schema version.

    Examples
    --------
    >>> ds = uq.run("studies/ishigami.toml")
    >>> uq.open_result("results/ishigami.nc").identical(ds)
    True
    """
    path = Path(path)
    if not remedy and (kind := _kind_of(path)):
        what, does = _KINDS[kind]
        raise InputError(f"{path}: is {what}, not a result; {does.format(shlex.quote(str(path)))}")
    remedy = remedy or "'uq run STUDY' makes results"
    if kind := node(path):
        inside = _others(path / "_") if os.path.isdir(path) else ""
        raise InputError(f"{path}: is {kind}, not a result{inside}; {remedy}")
    if not path.exists():
        raise InputError(f"{path}: no such file{_others(path)}; {remedy}")
    try:
        ds = upgraded(_legible(_opened(path)))
        check(ds, path)
    except InputError as error:
        raise InputError(f"{error}; {remedy}") from None
    ds.attrs.pop(CHECKSUM, None)  # it belongs to the file, not to the Dataset
    for variable in ds.variables.values():
        if variable.attrs.get("kind") == "lifetime":
            # The assumption when files did not state it.
            variable.attrs.setdefault("never_known_at_once", 0)
    return named(ds, str(path))


_STUDY, _MACHINE = ".toml", ".py"
_INIT = (
    "'uq init {0} > study.toml' writes a study of it, 'uq run study.toml --model {0}' its result"
)
_KINDS = {
    _STUDY: ("a study", "'uq run {0}' computes its result"),
    _MACHINE: ("a machine", _INIT),
    ".fmu": ("a machine", _INIT),
    ".csv": (
        "a table",
        "'uq import {0} -o OUT.nc --life COLUMN' reads lives, 'uq update RESULT.nc {0} -o"
        " POSTERIOR.nc' inspections",
    ),
    ".html": ("a page", "'uq report RESULT.nc' made it from a result"),
}
"""Ending of files that are no results -> what they are, and what reads them."""


def _kind_of(path: Path) -> str:
    """Return the ending of a file that cannot be a result, .py of a machine in TOML; or ""."""
    if path.suffix not in _KINDS or not path.is_file():
        return ""
    with suppress(OSError), path.open("rb") as file:
        content = file.read(_MOST_READ)
        if content.startswith(SIGNATURES):
            return ""
        if path.suffix == _STUDY and re.search(rb"^\s*\[?machine\b", content, re.MULTILINE):
            return _MACHINE
    return path.suffix


def _opened(path: Path) -> xr.Dataset:
    try:
        refuse_tricks(path)
    except ValueError as error:
        raise InputError(f"{path}: not a sound result: {error}") from None
    except OSError as error:
        raise InputError(f"{path}: {error.strerror or 'not a readable netCDF file'}") from None
    try:
        with warnings.catch_warnings(action="ignore"):  # they would print names from the file
            # No cache: a large result is read lazily and must not accumulate in memory.
            ds = xr.open_dataset(path, engine="netcdf4", decode_timedelta=False, cache=False)
        if ds.nbytes > most_bytes(path):
            ds.close()
            raise InputError(f"{path}: not a sound result: it claims {ds.nbytes / 1e9:.3g} GB")
        if ds.nbytes < _IN_MEMORY_BYTES:
            with ds:
                ds.load()
        return ds
    except UNREADABLE as error:
        raise InputError(f"{path}: {_of_the_system(error)}") from None


def _of_the_system(error: Exception) -> str:
    """Return why a file cannot be read; error numbers of netCDF are negative."""
    if isinstance(error, OSError) and (error.errno or 0) > 0:
        return f"cannot be read: {error.strerror}"
    return "not a readable netCDF file"


def _legible(ds: xr.Dataset) -> xr.Dataset:
    """Return a Dataset with terminal control characters removed from its texts."""
    owners: list[Any] = [ds, *ds.variables.values()]
    for owner in owners:
        for name, value in owner.attrs.items():
            if isinstance(value, str):
                owner.attrs[name] = without_control(value)
            elif isinstance(value, list):
                owner.attrs[name] = [without_control(str(text)) for text in value]
    for name, variable in ds.coords.items():
        if variable.dtype.kind in "OU" and variable.ndim == 1:
            labels = [without_control(str(label)) for label in variable.values]
            ds = ds.assign_coords({name: (variable.dims, labels, variable.attrs)})
    return ds


def upgraded(ds: xr.Dataset) -> xr.Dataset:
    """Convert a result to the names of this schema version.

    In version 1 the dimension of rows was ``sample``, and ``units`` their number in each sample.
    """
    version = np.asarray(ds.attrs.get("schema_version"))
    if version.ndim or version != 1 or "sample" not in ds.dims or "row" in ds.variables:
        return ds
    attrs = {"units_per_sample" if name == "units" else name: v for name, v in ds.attrs.items()}
    upgraded_ds = ds.rename(sample="row")
    upgraded_ds.attrs = attrs | {"schema_version": SCHEMA_VERSION}
    return upgraded_ds


def _others(path: Path) -> str:
    """List the results in the folder of a path that is not a result."""
    names = sorted(file.name for file in path.parent.glob("*.nc"))
    return nearest_file(path.name, names) or (f" (there: {choices(names)})" if names else "")


def check(ds: xr.Dataset, path: str | Path = "dataset") -> None:
    """Refuse a Dataset that is not a result of this schema version.

    Parameters
    ----------
    ds : xarray.Dataset
    path : str or Path
        Its name in messages.

    Raises
    ------
    InputError
    """
    version = ds.attrs.get("schema_version")
    if version is None or "study" not in ds.attrs or "status" not in ds:
        raise InputError(f"{path}: not a result of 'uq run'")
    if np.ndim(version) or version != SCHEMA_VERSION:
        raise InputError(
            f"{path}: written with schema version {version}; this version of vibrolife reads "
            f"{SCHEMA_VERSION}: run the study again, or read it with xarray"
        )
    if fault := unsound(ds):
        raise InputError(f"{path}: not a sound result: {fault}")


def refuse_empty(ds: xr.Dataset) -> None:
    """Refuse a result without rows; 'uq run' never writes one.

    Raises
    ------
    InputError
    """
    if not ds.sizes["row"]:
        raise InputError("this result has no rows")


def failed(ds: xr.Dataset) -> Mask:
    """Return the mask of failed rows of a result, shape (n,), see `failed_rows`."""
    required = (
        (output, ds[name].values)
        for name, output in outputs_of(ds).items()
        if not output.may_be_undefined
    )
    return failed_rows(ds["status"].values, required)


def relabel(ds: xr.Dataset, study: "Study") -> xr.Dataset:
    """Return the same rows with the current text of their study.

    Comments, sources and [analysis] of a study may change without recomputing a row.
    """
    here = made_here(study.model_reference)
    made = {name: ds.attrs[name] for name in here if name in ds.attrs}
    ds = ds.assign_attrs(study_attributes(study) | made)
    for name, entry in (dict(study.uncertain) | dict(study.tied)).items():
        ds[name].attrs["source"] = entry.source or study.model.parameter(name).source
    return ds
