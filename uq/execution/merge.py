"""Result that is written in parts: its variables, then rows in their places."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

import numpy as np
import xarray as xr

from uq.contract import Mask
from uq.execution.chunk_file import Block
from uq.execution.records import RowsRecord
from uq.text.literals import read_toml, toml


def define(file: Any, ds: xr.Dataset, total: int) -> None:
    """Write everything in a result but the rows."""
    variables, attributes = xr.conventions.encode_dataset_coordinates(ds)
    file.setncatts(attributes)
    for dim, size in ds.sizes.items():
        file.createDimension(dim, total if dim == "row" else size)
    for name, variable in variables.items():
        kind = str if variable.dtype.kind == "U" else variable.dtype
        made = file.createVariable(
            name, kind, variable.dims, fill_value=None if kind is str else False
        )
        made.setncatts(variable.attrs)
        made.set_auto_maskandscale(False)
        if "row" not in variable.dims:
            made[...] = variable.values.astype(object) if kind is str else variable.values


def place(file: Any, ds: xr.Dataset, blocks: Sequence[Block]) -> None:
    """Write rows to their places."""
    for name, variable in ds.variables.items():
        if "row" in variable.dims:
            done = 0
            for start, stop in blocks:
                file[name][start:stop] = variable.values[done : done + stop - start]
                done += stop - start


def made_by(records: Sequence[RowsRecord]) -> dict[str, str]:
    """Return the processors and versions that computed the rows, as attributes of the result."""
    names = dict.fromkeys(name for record in records for name in record.made)
    return {
        name: "; ".join(sorted({record.made.get(name, "unknown") for record in records}))
        for name in names
    }


def variants_of(records: Sequence[RowsRecord]) -> list[dict[str, Any]]:
    """Return the sets of settings that differ from the study's, ordered by first row."""
    variants: list[dict[str, Any]] = [{}]
    for record in sorted(records, key=lambda record: record.blocks):
        if record.settings not in variants:
            variants.append(record.settings)
    return variants


def rerun(variants: Sequence[Mapping[str, Any]], code: int, count: int) -> xr.Variable:
    """Return which of these settings some rows were computed with, as a variable of a result."""
    labels = ["no", *(f"changed-{i}" for i in range(1, len(variants)))]
    attrs: dict[str, Any] = {
        "role": "rerun",
        "long_name": "whether a failed row was computed again with changed settings",
        "flag_values": np.arange(len(variants), dtype=np.int16),
        "flag_meanings": " ".join(labels),
    }
    attrs |= {f"changed_{i}": toml(variants[i]) for i in range(1, len(variants))}
    return xr.Variable("row", np.full(count, code, np.int16), attrs)


def by_settings(ds: xr.Dataset) -> Iterator[tuple[dict[str, Any], Mask]]:
    """Yield the settings of rows that differ from the study's, and which rows have them."""
    if "rerun" not in ds:
        yield {}, np.ones(ds.sizes["row"], np.bool_)
        return
    codes = ds["rerun"].values
    for code in np.unique(codes):
        text = ds["rerun"].attrs.get(f"changed_{code}", "{}")
        yield read_toml(f"settings = {text}")["settings"], codes == code
