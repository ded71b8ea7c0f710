"""Errors that a model states for each row."""

import xarray as xr

from uq.rows.elements import Element, elements_of, output_names


def error_name(output: str) -> str:
    """Return the name of the output that states the error of another."""
    return f"{output}_error"


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
