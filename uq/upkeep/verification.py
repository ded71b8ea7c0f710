"""Whether a result is what was computed, and would be computed here."""

from pathlib import Path
from typing import NamedTuple

import numpy as np
import xarray as xr

from uq.contract import Status
from uq.errors import InputError
from uq.interrupts import in_background
from uq.rows import results
from uq.rows.columns import censored_name
from uq.rows.evaluate import evaluate
from uq.rows.sampling import row_block
from uq.store.adopt import variants
from uq.store.seal import is_intact
from uq.study.code import made_here
from uq.study.definition import Study
from uq.upkeep.rerunning import changed_settings
from uq.upkeep.stored_study import study_of

ROWS = 16
"""Rows that are computed again."""

_NOT_AGAIN = (Status.CRASHED, Status.TIMED_OUT)  # they would do it to this process


class Version(NamedTuple):
    """Something that made a result, and is another here."""

    name: str
    made: str
    here: str


class Recomputed(NamedTuple):
    """Rows that were computed again.

    Attributes
    ----------
    rows : list of int
    differences : list of str
        One sentence per row that came out otherwise.
    """

    rows: list[int]
    differences: list[str]


def checksum_holds(path: Path) -> bool | None:
    """Return whether a result says what it said when it was written; None if it has no checksum.

    Raises
    ------
    InputError
        When it cannot be read.
    """
    results.open_result(path)
    try:
        return is_intact(path)
    except results.UNREADABLE:
        raise InputError(f"{path}: not a readable netCDF file") from None


def other_versions(ds: xr.Dataset, model: str | None = None) -> list[Version]:
    """Return what made a result and is another here: processor, Python, libraries, model's code."""
    pairs = made_here(model or ds.attrs["model"]).items()
    found = [Version(name, str(ds.attrs.get(name, "unknown")), here) for name, here in pairs]
    return [version for version in found if version.made != version.here]


def recompute(path: Path, model: str | None = None) -> Recomputed:
    """Compute a random handful of rows of a result again, and compare them to the bit.

    Rows that crashed or timed out are left alone.

    Parameters
    ----------
    path : Path
    model : str, optional
        Where the model lives, if it is not installed.

    Returns
    -------
    Recomputed

    Raises
    ------
    InputError
        When the model is not there, or another.
    """
    ds, study = results.open_result(path), study_of(path, model)
    candidates = np.flatnonzero(~np.isin(ds["status"].values, _NOT_AGAIN))
    count = min(ROWS, len(candidates))
    chosen = np.sort(np.random.default_rng().choice(candidates, count, replace=False))
    settings: dict[int, object] = {}
    for changes, rows in variants(ds):
        settings |= dict.fromkeys(chosen[rows[chosen]].tolist(), changed_settings(study, changes))
    differences = [
        f"row {row}: {', '.join(names)}"
        for row, own in sorted(settings.items())
        if (names := _differing(study, own, row, ds.isel(sample=[row])))
    ]
    return Recomputed(sorted(settings), differences)


def _differing(study: Study, settings: object, row: int, there: xr.Dataset) -> list[str]:
    """Return the names of what comes out otherwise."""
    model = study.model
    rows = row_block(study, row, row + 1)
    chunk = in_background(lambda: evaluate(model, settings, rows.x, rows.seed, row))
    again = dict(zip(model.parameter_names, rows.x.T, strict=True)) | chunk.columns
    again |= {"status": chunk.status}
    flags = {censored_name(name) for name in model.outputs}
    return [
        name
        for name, values in again.items()
        if np.asarray(values, np.int8 if name in flags else None).tobytes()
        != there[name].values.tobytes()
    ]
