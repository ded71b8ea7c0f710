"""What commands on a result are given: its file, and where a model that is not installed lives."""

import shlex

import xarray as xr

from uq.study.registry import model_names

_FILE = "result_file"


def named(ds: xr.Dataset, file: str) -> xr.Dataset:
    """Return a result whose commands name this file."""
    ds.encoding[_FILE] = file
    return ds


def file_of(ds: xr.Dataset) -> str:
    """Return the file of a result as a shell reads it, OUT where it is not known."""
    return shlex.quote(str(ds.encoding.get(_FILE, "OUT")))


def model_option(ds: xr.Dataset) -> str:
    """Return `` --model FILE`` for rows of a model that is not installed here, else ""."""
    return "" if ds.attrs["model"] in model_names() else " --model FILE"
