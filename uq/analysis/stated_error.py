"""Errors that a model states for each row."""

import xarray as xr

from uq.rows.elements import Element, elements_of, output_names
from uq.rows.variables import error_name


def stated_error(ds: xr.Dataset, element: Element) -> Element | None:
    """Return the error that the model states for an element, None if it states none.

    Parameters
    ----------
    ds : xarray.Dataset
        The rows that `element` is of.
    element : Element
    """
    name = error_name(element.output)
    if name not in output_names(ds):
        return None
    return next((one for one in elements_of(ds, [name]) if one.place == element.place), None)
