"""Verification of a result: unchanged since it was written, and reproducible here."""

from pathlib import Path

import numpy as np

from uq.contract import Status
from uq.errors import InputError
from uq.execution.amending import study_of
from uq.execution.recomputed_row import computed_again, differing, settings_by_row
from uq.files.seal import is_intact
from uq.result import result_file

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
    result_file.open_result(path)
    try:
        return is_intact(path)
    except result_file.UNREADABLE:
        raise InputError(f"{path}: not a readable netCDF file") from None


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
    ds, study = result_file.open_result(path), study_of(path, model)
    candidates = np.flatnonzero(~np.isin(ds["status"].values, _NOT_AGAIN))
    count = min(ROWS, len(candidates))
    chosen = np.sort(np.random.default_rng().choice(candidates, count, replace=False))
    settings = settings_by_row(ds, study, chosen)
    differences = [
        f"row {row}: {', '.join(names)}"
        for row, row_settings in sorted(settings.items())
        if (names := differing(computed_again(study, row_settings, row), ds.isel(row=[row])))
    ]
    return sorted(settings), differences
