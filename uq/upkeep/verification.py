"""Whether a result is as written, and would be the same if computed here."""

from pathlib import Path

import numpy as np
import xarray as xr

from uq.contract import Status
from uq.errors import InputError
from uq.interrupts import in_background
from uq.rows import results
from uq.rows.columns import censored_name
from uq.rows.evaluate import evaluate
from uq.rows.sampling import row_block
from uq.store.merge import by_settings
from uq.store.seal import is_intact
from uq.study.definition import Study
from uq.study.registry import made_here
from uq.upkeep.amending import changed_settings, study_of

ROWS = 16
"""Rows to recompute."""

_NOT_AGAIN = (Status.CRASHED, Status.TIMED_OUT)  # they would do the same to this process


def checksum_holds(path: Path) -> bool | None:
    """Return whether a result is as written; None if it has no checksum.

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


def other_versions(ds: xr.Dataset, model: str | None = None) -> dict[str, tuple[str, str]]:
    """Return what differs here from what made a result: name -> (there, here).

    Compared are processor, Python, libraries and the code of the model.
    """
    pairs = made_here(model or ds.attrs["model"]).items()
    found = {name: (str(ds.attrs.get(name, "unknown")), here) for name, here in pairs}
    return {name: (made, here) for name, (made, here) in found.items() if made != here}


def recompute(path: Path, model: str | None = None) -> tuple[list[int], list[str]]:
    """Recompute a few random rows of a result, and compare them bit by bit.

    Rows that crashed or timed out are skipped.

    Parameters
    ----------
    path : Path
    model : str, optional
        Where the model lives, if it is not installed.

    Returns
    -------
    rows : list of int
        Numbers of the recomputed rows.
    differences : list of str
        One sentence per row that differs.

    Raises
    ------
    InputError
        When the model is missing or differs.
    """
    ds, study = results.open_result(path), study_of(path, model)
    candidates = np.flatnonzero(~np.isin(ds["status"].values, _NOT_AGAIN))
    count = min(ROWS, len(candidates))
    chosen = np.sort(np.random.default_rng().choice(candidates, count, replace=False))
    settings: dict[int, object] = {}
    for changes, rows in by_settings(ds):
        settings |= dict.fromkeys(chosen[rows[chosen]].tolist(), changed_settings(study, changes))
    differences = [
        f"row {row}: {', '.join(names)}"
        for row, own in sorted(settings.items())
        if (names := _differing(study, own, row, ds.isel(sample=[row])))
    ]
    return sorted(settings), differences


def _differing(study: Study, settings: object, row: int, there: xr.Dataset) -> list[str]:
    """Return the names of what differs."""
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
