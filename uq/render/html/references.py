"""References that a model asks to cite."""

import xarray as xr

from uq.errors import InputError
from uq.study.installed_models import find_model


def references(ds: xr.Dataset) -> tuple[str, ...] | None:
    """Return the references that the model asks to cite, or None if it is not installed."""
    try:
        return find_model(ds.attrs["model"]).references
    except InputError:
        return None
