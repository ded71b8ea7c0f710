"""Errors that a model states for each row, beside the accuracy that was asked for."""

from typing import Any

import numpy as np
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


def accuracy_missed(ds: xr.Dataset, element: Element) -> dict[str, Any]:
    """Count the rows whose stated error exceeds the accuracy that was asked for.

    Parameters
    ----------
    ds : xarray.Dataset
        The rows that `element` is of.
    element : Element

    Returns
    -------
    dict
        ``accuracy``: ``asked``, relative; ``rows`` with a finite value that is not censored;
        ``missed``, how many of them state a larger error or none; ``share``, None without rows.
        Nothing where no accuracy was asked for.
    """
    asked = ds[element.output].attrs.get("accuracy")
    error = stated_error(ds, element)
    if asked is None or error is None:
        return {}
    known = np.isfinite(element.values) & ~element.censored
    kept = np.abs(error.values[known]) <= asked * np.abs(element.values[known])
    rows, missed = len(kept), int((~kept).sum())
    share = missed / rows if rows else None
    return {"accuracy": {"asked": float(asked), "rows": rows, "missed": missed, "share": share}}
