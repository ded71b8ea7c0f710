"""A checksum of the content of a netCDF file, kept in the file itself."""

import hashlib
from pathlib import Path
from typing import Any

import numpy as np

CHECKSUM = "checksum"
"""Attribute of the file."""

_ROWS = 1_000_000  # read at a time


def seal(path: Path) -> None:
    """Store the checksum of a file as an attribute."""
    import netCDF4

    with netCDF4.Dataset(path, "a") as file:
        file.setncattr(CHECKSUM, _checksum(file))


def is_intact(path: Path) -> bool | None:
    """Return whether a file is unchanged since it was sealed; None if it never was.

    Raises
    ------
    Any of `uq.result.result_file.UNREADABLE`
        When it cannot be read at all.
    """
    import netCDF4

    with netCDF4.Dataset(path, "r") as file:
        return file.getncattr(CHECKSUM) == _checksum(file) if CHECKSUM in file.ncattrs() else None


def _checksum(file: Any) -> str:
    """Return the SHA-256 of all variables and attributes but the checksum itself."""
    whole = hashlib.sha256()
    _add_attributes(whole, file)
    for name in sorted(file.variables):
        variable = file[name]
        variable.set_auto_maskandscale(False)
        whole.update(repr((name, variable.dimensions, variable.shape)).encode())
        _add_attributes(whole, variable)
        if variable.shape:
            for start in range(0, variable.shape[0], _ROWS):
                _add_values(whole, variable[start : start + _ROWS])
        else:
            _add_values(whole, variable[...])
    return whole.hexdigest()


def _add_attributes(whole: Any, owner: Any) -> None:
    for name in sorted(owner.ncattrs()):
        if name != CHECKSUM:
            whole.update(name.encode())
            _add_values(whole, owner.getncattr(name))


def _add_values(whole: Any, values: Any) -> None:
    array = np.asarray(values)
    if array.dtype.kind in "OU":
        whole.update(repr(array.tolist()).encode())
    else:
        whole.update(array.dtype.str.encode())
        whole.update(np.ascontiguousarray(array).data)
