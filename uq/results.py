"""The schema of a result: one flat, self-describing Dataset, built here and checked here.

One dimension ``sample``; one variable per parameter (``role`` is ``input`` where it is uncertain,
``fixed`` where it is one number), one per output (``role="output"``, plus the model's own
dimensions), one ``<name>_censored`` beside each lifetime that can be censored, and ``status``.
``replicate``, ``group`` and ``block`` say which place of the design a row has. Nothing in it
depends on clock, host, chunks or workers.
"""

import hashlib
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.code import made_here
from uq.columns import censored_name, failed_rows
from uq.contract import Model, Status
from uq.designs import DESIGNS, block_names
from uq.errors import InputError, choices, nearest
from uq.provenance import provenance
from uq.soundness import unsound

if TYPE_CHECKING:
    from uq.sampling import Rows
    from uq.study import Study

SCHEMA_VERSION = 1
CHECKSUM = "checksum"
"""Attribute of the file; see `uq.store.seal`."""

UNREADABLE = (OSError, ValueError, RuntimeError, AttributeError, LookupError, TypeError)
"""What a damaged file makes netCDF4 and xarray raise."""

_IN_MEMORY_BYTES = 200_000_000
_INFLATED_BYTES, _INFLATION = 100_000_000, 100  # a file that claims more was not made by us

Columns = Mapping[str, NDArray[Any]]


def build(
    study: "Study",
    rows: "Rows",
    columns: Columns,
    status: NDArray[np.int8],
    failures: Mapping[str, str],
    numbers: NDArray[np.int64] | None = None,
) -> xr.Dataset:
    """Put the rows of a study and what the model made of them into one Dataset.

    Parameters
    ----------
    study : Study
    rows : Rows
        Inputs and place in the design, n rows.
    columns : dict of str to ndarray
        What ``batch`` returns, joined: output name -> (n, *dims), ``<name>_censored`` -> (n,
        *dims).
    status : ndarray of int8, shape (n,)
    failures : dict of str to str
        Status label -> what happened to the first row with that status.
    numbers : ndarray of int64, shape (n,), optional
        Of the rows; by default they are the first.

    Returns
    -------
    xarray.Dataset
    """
    model = study.model
    inputs: dict[str, Any] = {}
    for i, name in enumerate(model.parameter_names):
        if name in study.uncertain:
            inputs[name] = _input(model, name, rows.x[:, i], study.uncertain[name].source)
        elif name in study.tied:
            inputs[name] = _input(model, name, rows.x[:, i], study.tied[name].source)
        else:
            inputs[name] = _input(model, name, study.fixed.get(name, model.nominal[name]))
    ds = xr.Dataset(
        inputs | _outputs(model, columns, status, failures),
        _places(study, rows, numbers) | _coordinates(model, study.settings),
        _attributes(study),
    )
    for variable in ds.variables.values():
        variable.encoding["_FillValue"] = None
    return ds


def build_rows(
    model: Model,
    settings: Any,
    values: Mapping[str, float | NDArray[np.float64]],
    columns: Columns,
    status: NDArray[np.int8],
    failures: Mapping[str, str],
) -> xr.Dataset:
    """Put rows computed outside of any study into a Dataset of the same schema.

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
    inputs = {name: _input(model, name, value) for name, value in values.items()}
    attrs = {"title": model.title} | _model_attributes(model) | provenance()
    outputs = _outputs(model, columns, status, failures)
    return xr.Dataset(inputs | outputs, _coordinates(model, settings), attrs)


def elements(variable: xr.DataArray) -> Iterator[tuple[str, xr.DataArray]]:
    """Yield name and values of each element of an output: ``work_rate[site=left]``.

    Parameters
    ----------
    variable : xarray.DataArray
        With or without the dimension ``sample``.

    Yields
    ------
    tuple of str and xarray.DataArray
        Coordinates appear as Python's repr without quotes.
    """
    dims = [str(dim) for dim in variable.dims if dim != "sample"]
    for index in np.ndindex(*(variable.sizes[dim] for dim in dims)):
        place = dict(zip(dims, index, strict=True))
        label = ",".join(f"{dim}={variable[dim].values[i].item()}" for dim, i in place.items())
        yield f"{variable.name}[{label}]" if label else str(variable.name), variable.isel(place)


def open_result(path: str | Path, remedy: str = "'uq run STUDY' makes results") -> xr.Dataset:
    """Open a result and check its schema.

    One that takes less than 200 MB is read into memory, and its file closed; what is larger is
    read when it is used.

    Parameters
    ----------
    path : str or Path
    remedy : str, optional
        What an error line says can be done.

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
    if not path.exists():
        raise InputError(f"{path}: no such file{_others(path)}; {remedy}")
    if path.is_dir():
        raise InputError(f"{path}: is a folder, not a result{_others(path / '_')}; {remedy}")
    try:
        ds = _opened(path)
        check(ds, path)
    except InputError as error:
        raise InputError(f"{error}; {remedy}") from None
    ds.attrs.pop(CHECKSUM, None)  # of the file, not of what is made of it
    return ds


def _opened(path: Path) -> xr.Dataset:
    try:
        ds = xr.open_dataset(path, engine="netcdf4", decode_timedelta=False)
        if ds.nbytes > _INFLATED_BYTES + _INFLATION * path.stat().st_size:
            ds.close()
            raise InputError(
                f"{path}: not a sound result: its {path.stat().st_size / 1e6:.3g} MB claim to be "
                f"{ds.nbytes / 1e9:.3g} GB"
            )
        if ds.nbytes < _IN_MEMORY_BYTES:
            with ds:
                ds.load()
        return ds
    except UNREADABLE:
        raise InputError(f"{path}: not a readable netCDF file") from None


def _others(path: Path) -> str:
    """Return which results there are in the folder of a path that is none."""
    there = sorted(one.name for one in path.parent.glob("*.nc"))
    return nearest(path.name, there) or (f" (there: {choices(there)})" if there else "")


def check(ds: xr.Dataset, path: str | Path = "dataset") -> None:
    """Refuse a Dataset that is not a result of this schema version.

    Parameters
    ----------
    ds : xarray.Dataset
    path : str or Path
        What the message calls it.

    Raises
    ------
    InputError
    """
    version = ds.attrs.get("schema_version")
    if version is None or "study" not in ds.attrs or "status" not in ds:
        raise InputError(f"{path}: not a result of 'uq run'")
    if version != SCHEMA_VERSION:
        raise InputError(
            f"{path}: written with schema version {version}; this version of vibrolife reads "
            f"{SCHEMA_VERSION}: run the study again, or read it with xarray"
        )
    if fault := unsound(ds):
        raise InputError(f"{path}: not a sound result: {fault}")


def failed(ds: xr.Dataset) -> NDArray[np.bool_]:
    """Return which rows of a result failed, shape (n,), by the rule of `failed_rows`."""
    required = (
        (variable.attrs["kind"], variable.values)
        for variable in ds.data_vars.values()
        if variable.attrs.get("role") == "output" and not variable.attrs["may_be_undefined"]
    )
    return failed_rows(ds["status"].values, required)


def relabel(ds: xr.Dataset, study: "Study") -> xr.Dataset:
    """Return the same rows under the present text of their study.

    Comments, sources and [analysis] of a study may change without a row being computed again.
    """
    here = made_here(study.model_reference)
    made = {name: ds.attrs[name] for name in here if name in ds.attrs}
    ds = ds.assign_attrs(_attributes(study) | made)
    for name, entry in (dict(study.uncertain) | dict(study.tied)).items():
        ds[name].attrs["source"] = entry.source or study.model.parameter(name).source
    return ds


def _input(model: Model, name: str, value: Any, source: str = "") -> tuple[Any, Any, Any]:
    """Return the variable of a parameter: one number, or one per row."""
    declared = model.parameter(name)
    uncertain = isinstance(value, np.ndarray)
    attrs = {
        "role": "input" if uncertain else "fixed",
        "units": declared.unit,
        "long_name": declared.meaning,
        "symbol": declared.symbol,
        "source": source or declared.source,
    }
    return (("sample",), value, attrs) if uncertain else ((), np.float64(value), attrs)


def _outputs(
    model: Model, columns: Columns, status: NDArray[np.int8], failures: Mapping[str, str]
) -> dict[str, Any]:
    variables: dict[str, Any] = {}
    for name, output in model.outputs.items():
        dims = ("sample", *output.dims)
        attrs: dict[str, Any] = {
            "role": "output",
            "kind": output.kind,
            "units": output.unit,
            "long_name": output.meaning,
            "may_be_undefined": int(output.may_be_undefined),
        }
        if output.kind == "category":
            attrs |= _flags(("none", *output.categories), np.int8, first=-1)
        variables[name] = (dims, columns[name], attrs)
        if output.has_censored_flag:
            flag = censored_name(name)
            attrs = {"role": "censored", "long_name": f"whether {name} is only a lower bound"}
            variables[flag] = (dims, columns[flag].astype(np.int8), attrs)
    attrs = {"role": "status", "long_name": "how the row ended"}
    attrs |= _flags([status.label for status in Status], np.int8)
    for label, message in failures.items():
        attrs[f"example_{label.replace('-', '_')}"] = message
    return variables | {"status": (("sample",), status, attrs)}


def _coordinates(model: Model, settings: Any) -> dict[str, Any]:
    values = model.coordinates(settings)
    used = {dim for output in model.outputs.values() for dim in output.dims}
    coordinates: dict[str, Any] = {}
    for dim in sorted(used):
        described = zip(("units", "long_name"), model.dimensions.get(dim, ()), strict=False)
        coordinates[dim] = ((dim,), np.asarray(values[dim]), dict(described))
    return coordinates


def _places(study: "Study", rows: "Rows", numbers: NDArray[np.int64] | None) -> dict[str, Any]:
    sample = ("sample",)
    numbers = np.arange(len(rows.x)) if numbers is None else numbers
    block = {"long_name": "block of the design"} | _flags(_block_labels(study), np.int16)
    return {
        "sample": (sample, numbers, {"long_name": "row"}),
        "replicate": (sample, rows.replicate, {"long_name": "independent scramble of the design"}),
        "group": (sample, rows.group, {"long_name": "base point of the design"}),
        "block": (sample, rows.block, block),
    }


def _flags(labels: Sequence[str], dtype: type[np.integer[Any]], first: int = 0) -> dict[str, Any]:
    values = np.arange(first, first + len(labels), dtype=dtype)
    if len(labels) == 1:
        values = values[0]  # what netCDF makes of an attribute of one number
    return {"flag_values": values, "flag_meanings": " ".join(labels)}


def _block_labels(study: "Study") -> list[str]:
    design = study.design
    return list(block_names(DESIGNS[design.method], tuple(study.uncertain), design.second_order))


def _attributes(study: "Study") -> dict[str, Any]:
    design = study.design
    return (
        {"title": study.description or study.name}
        | _model_attributes(study.model)
        | {
            "study": study.text,
            "study_sha256": hashlib.sha256(study.text.encode()).hexdigest(),
            "study_identity": study.identity,
            "design": design.method,
            "samples": design.samples,
            "replicates": design.replicates,
            "second_order": int(design.second_order),
            "seed": design.seed,
        }
        | made_here(study.model_reference)
    )


def _model_attributes(model: Model) -> dict[str, Any]:
    return {
        "Conventions": "CF-1.11",
        "schema_version": SCHEMA_VERSION,
        "source": f"{model.name} {model.version}",
        "model": model.name,
        "model_version": model.version,
    }
