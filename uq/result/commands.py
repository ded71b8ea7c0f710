"""Arguments of commands on a result: its file, and the place of a model that is not installed."""

import shlex
from pathlib import Path

import xarray as xr

from uq.study.installed_models import model_names, without_returns
from uq.study.model_files import file_with, shortened

_FILE = "result_file"
_MODEL = "model_reference"
_NEAR = 3  # folders: the current one, the result's, and the one above


def named(ds: xr.Dataset, file: str) -> xr.Dataset:
    """Return a result whose commands name this file."""
    ds.encoding[_FILE] = file
    return ds


def file_of(ds: xr.Dataset) -> str:
    """Return the file of a result as a shell reads it, OUT if it is not recorded."""
    return shlex.quote(str(ds.encoding.get(_FILE, "OUT")))


def with_model(ds: xr.Dataset, reference: str) -> xr.Dataset:
    """Return a result whose commands name its model as the user did."""
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
    if model in model_names():
        return ""
    folders = [Path(), *Path(str(ds.encoding.get(_FILE, "."))).parents][:_NEAR]
    return f" --model {file_with(model, folders) or 'FILE'}"
