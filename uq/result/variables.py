"""The variables of a result and their attributes."""

import hashlib
import json
from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Model, Output, Status, cause_name, censored_name, high_name
from uq.study.installed_models import made_here
from uq.study.row_sampling import block_labels

if TYPE_CHECKING:
    from uq.study.definition import Study
    from uq.study.row_sampling import Rows

SCHEMA_VERSION = 2

Columns = Mapping[str, NDArray[Any]]
"""Columns returned by ``batch``: output name -> (n, *dims), ``<name>_censored`` -> (n, *dims)."""


def parameter_variable(
    model: Model, name: str, value: Any, source: str = "", level: str = ""
) -> tuple[Any, Any, Any]:
    """Return the variable of a parameter: one number, or one per row."""
    declared = model.parameter(name)
    uncertain = isinstance(value, np.ndarray)
    attrs: dict[str, Any] = {
        "role": "input" if uncertain else "fixed",
        "units": declared.unit,
        "long_name": declared.meaning,
        "symbol": declared.symbol,
        "source": source or declared.source,
        "nominal": float(model.nominal[name]),  # to which the source of a fixed value applies
    }
    if uncertain:
        attrs["admissible"] = np.array(declared.bounds)
    attrs |= {"initial": 1} if declared.initial else {}
    attrs |= {"level": level} if level else {}
    return (("row",), value, attrs) if uncertain else ((), np.float64(value), attrs)


def output_variables(
    model: Model,
    settings: Any,
    columns: Columns,
    status: NDArray[np.int8],
    failures: Mapping[str, str],
) -> dict[str, Any]:
    """Return the variables of the outputs, the flags of censored lives and the status."""
    variables: dict[str, Any] = {}
    for name, output in model.outputs.items():
        dims = ("row", *output.dims)
        attrs: dict[str, Any] = {
            "role": "output",
            "kind": output.kind,
            "units": output.unit,
            "long_name": output.meaning,
            "may_be_undefined": int(output.may_be_undefined),
        }
        if output.accuracy:
            attrs["accuracy"] = float(getattr(settings, output.accuracy))
            attrs["accuracy_setting"] = output.accuracy
        if output.is_lifetime:
            attrs["never_known_at_once"] = int(output.never_known_at_once)
        if not output.shown:
            attrs["shown"] = 0
        if output.success:
            attrs["success"] = output.success
        if output.exponents:
            attrs["scales"] = json.dumps(dict(output.exponents))
        if output.is_category:
            attrs |= _flags(("none", *output.categories), np.int8, first=-1)
        variables[name] = (dims, columns[name], attrs)
        if output.has_censored_flag:
            flag = censored_name(name)
            attrs = {"role": "censored", "long_name": f"whether {name} is only a lower bound"}
            variables[flag] = (dims, columns[flag].astype(np.int8), attrs)
        if output.may_be_between:
            attrs = {"role": "high", "units": output.unit, "long_name": f"upper bound of {name}"}
            variables[high_name(name)] = (dims, columns[high_name(name)], attrs)
    attrs = {"role": "status", "long_name": "how the row ended"}
    attrs |= _flags([status.label for status in Status], np.int8)
    for label, message in failures.items():
        attrs[f"example_{label.replace('-', '_')}"] = message
    return variables | {"status": (("row",), status, attrs)}


def outputs_of(ds: xr.Dataset) -> dict[str, Output]:
    """Return the outputs of a result as its variables declare them, by name and in order.

    Results of earlier versions do not record the setting of the accuracy.
    """
    return {
        str(name): Output(
            variable.attrs["units"],
            variable.attrs["long_name"],
            variable.attrs["kind"],
            tuple(map(str, variable.dims[1:])),
            bool(variable.attrs["may_be_undefined"]),
            censored_name(str(name)) in ds,
            tuple(variable.attrs.get("flag_meanings", "").split()[1:]),
            accuracy=str(variable.attrs.get("accuracy_setting", "")),
            success=str(variable.attrs.get("success", "")),
            never_known_at_once=bool(variable.attrs.get("never_known_at_once", True)),
            shown=bool(variable.attrs.get("shown", True)),
            causes=_causes(ds, str(name)),
            may_be_between=high_name(str(name)) in ds,
            scales=json.loads(variable.attrs.get("scales", "{}")),
        )
        for name, variable in ds.variables.items()
        if variable.attrs.get("role") == "output"
    }


def _causes(ds: xr.Dataset, name: str) -> tuple[str, ...]:
    """Return the causes that may end a lifetime."""
    variables = ds.variables  # to take one of these makes no DataArray
    if variables[name].attrs["kind"] != "lifetime" or cause_name(name) not in variables:
        return ()
    return tuple(str(variables[cause_name(name)].attrs.get("flag_meanings", "")).split()[1:])


def coordinates(model: Model, settings: Any) -> dict[str, Any]:
    """Return the coordinates of the dimensions of the outputs."""
    values = model.coordinates(settings)
    used = {dim for output in model.outputs.values() for dim in output.dims}
    coordinates: dict[str, Any] = {}
    for dim in sorted(used):
        described = zip(("units", "long_name"), model.dimensions.get(dim, ()), strict=False)
        coordinates[dim] = ((dim,), np.asarray(values[dim]), dict(described))
    return coordinates


def places(study: "Study", rows: "Rows", numbers: NDArray[np.int64] | None) -> dict[str, Any]:
    """Return the design indices of each row, as coordinates."""
    along = ("row",)
    numbers = np.arange(len(rows.x)) if numbers is None else numbers
    block = {"long_name": "block of the design"} | _flags(block_labels(study), np.int16)
    variables = {
        "row": (along, numbers, {"long_name": "row"}),
        "replicate": (along, rows.replicate, {"long_name": "independent scramble of the design"}),
        "group": (along, rows.group, {"long_name": "base point of the design"}),
        "block": (along, rows.block, block),
    }
    design = study.design
    if design.rows_of_a_sample > 1:
        within = numbers % design.rows_of_a_sample
        unit, repeat = np.divmod(within, design.repeats)
        world = rows.group * design.replicates + rows.replicate
        variables["world"] = (along, world, {"long_name": "sample, whose units share inputs"})
        variables["unit"] = (along, unit.astype(np.int32), {"long_name": "unit of the sample"})
        variables["repeat"] = (along, repeat.astype(np.int32), {"long_name": "repeat of the unit"})
    return variables


def _flags(labels: Sequence[str], dtype: type[np.integer[Any]], first: int = 0) -> dict[str, Any]:
    values = np.arange(first, first + len(labels), dtype=dtype)
    if len(labels) == 1:
        values = values[0]  # as netCDF stores an attribute of one number
    return {"flag_values": values, "flag_meanings": " ".join(labels)}


def study_attributes(study: "Study") -> dict[str, Any]:
    """Return the attributes of a result of a study."""
    design = study.design
    nested = design.rows_of_a_sample > 1
    return (
        {"title": study.description or study.name}
        | model_attributes(study.model)
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
        | ({"random": 1} if study.random else {})
        | ({"units_per_sample": design.units, "repeats": design.repeats} if nested else {})
        | made_here(study.model_reference)
    )


def model_attributes(model: Model) -> dict[str, Any]:
    """Return the attributes common to all Datasets that a model computes."""
    return {
        "Conventions": "CF-1.11",
        "schema_version": SCHEMA_VERSION,
        "source": f"{model.name} {model.version}",
        "model": model.name,
        "model_version": model.version,
        "row_name": "/".join(model.row_name),
    }


def error_name(output: str) -> str:
    """Return the name of the output that states the error of another."""
    return f"{output}_error"


def is_error(name: str, outputs: Collection[str]) -> bool:
    """Return whether an output states the error of another output."""
    return name in {error_name(output) for output in outputs}
