"""The rows of a complete result, taken back into a run that extends or repeats it."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Mask, Status
from uq.literals import read_toml
from uq.rows import results
from uq.rows.columns import columns_of
from uq.rows.evaluate import Chunk
from uq.rows.sampling import Rows, row_block
from uq.store.chunk_file import blocks_of
from uq.store.disk import DiskStore
from uq.store.tally import Failures
from uq.study.definition import Study
from uq.study.registry import made_here

_ROWS = 100_000  # at a time


def adopt(store: DiskStore, study: Study, path: Path, all_rows: bool) -> None:
    """Copy the rows of a result into a store.

    Parameters
    ----------
    store : DiskStore
    study : Study
        The result's own, perhaps with more samples.
    path : Path
    all_rows : bool
        Whether to include failed rows.
    """
    ds = results.open_result(path)
    here = made_here(study.model_reference)
    made = {name: str(ds.attrs[name]) for name in here if name in ds.attrs}
    for first in range(0, ds.sizes["sample"], _ROWS):
        some = ds.isel(sample=slice(first, first + _ROWS)).load()
        wanted = np.ones(some.sizes["sample"], np.bool_) if all_rows else ~results.failed(some)
        for settings, variant in variants(some):
            numbers = first + np.flatnonzero(wanted & variant)
            if numbers.size:
                part = some.isel(sample=numbers - first)
                rows, chunk = _inputs(study, part, first), _outputs(study, part, numbers)
                store.adopt(blocks_of(numbers), rows, chunk, (made, settings))


def variants(ds: xr.Dataset) -> Iterator[tuple[dict[str, Any], Mask]]:
    """Yield the settings of rows that differ from the study's, and which rows have them."""
    if "rerun" not in ds:
        yield {}, np.ones(ds.sizes["sample"], np.bool_)
        return
    codes = ds["rerun"].values
    for code in np.unique(codes):
        text = ds["rerun"].attrs.get(f"changed_{code}", "{}")
        yield read_toml(f"settings = {text}")["settings"], codes == code


def _inputs(study: Study, part: xr.Dataset, first: int) -> Rows:
    numbers = part["sample"].values
    drawn = row_block(study, first, int(numbers[-1]) + 1)
    kept = Rows(*(field[numbers - first] for field in drawn))
    for i, name in enumerate(study.model.parameter_names):
        kept.x[:, i] = part[name].values
    return kept


def _outputs(study: Study, part: xr.Dataset, numbers: NDArray[np.int64]) -> Chunk:
    columns = {
        name: part[name].values.astype(column.dtype)
        for name, column in columns_of(study.model, study.settings).items()
    }
    status = part["status"].values
    failures: Failures = {}
    for code in np.unique(status[status != Status.OK]):
        kind, row = Status(code), int(numbers[np.argmax(status == code)])
        example = str(part["status"].attrs.get(f"example_{kind.name.lower()}", ""))
        known = example.startswith(f"row {row}: ")
        failures[kind.label] = row, example.partition(": ")[2] if known else kind.meaning
    return Chunk(columns, status, failures)
