"""Where the rows of a design with groups stand in a result."""

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.errors import InputError
from uq.rows.elements import Floats, flags


def grouped_rows(ds: xr.Dataset) -> tuple[NDArray[np.intp], tuple[str, ...]]:
    """Find the groups of a design.

    Parameters
    ----------
    ds : xarray.Dataset
        A result, its rows in any order.

    Returns
    -------
    order : ndarray of int, shape (R, N, blocks)
        Row of each replicate, group and block.
    labels : tuple of str
        Names of the blocks.

    Raises
    ------
    InputError
        When a group lacks rows.
    """
    labels = flags(ds["block"])
    keys = np.stack([ds[name].values for name in ("replicate", "group", "block")])
    order = np.lexsort(keys[::-1])
    if order.size % len(labels) == 0:
        groups = keys[:, order].reshape(3, -1, len(labels))
        whole = (np.ptp(groups[:2], axis=2) == 0).all()
        if whole and (groups[2] == [code for code, _ in labels]).all():
            order = order.reshape(ds.attrs["replicates"], -1, len(labels))
            return order, tuple(label for _, label in labels)
    raise InputError("rows of the design are missing: its indices need whole groups")


def whole_groups(values: Floats, order: NDArray[np.intp]) -> NDArray[np.bool_]:
    """Return which groups have a value in each of their rows.

    Parameters
    ----------
    values : ndarray of float64, shape (S,)
        NaN where a row has none.
    order : ndarray of int, shape (..., rows of a group)
        The rows of each group.

    Returns
    -------
    ndarray of bool, shape (...)
    """
    return np.asarray(np.isfinite(values[order]).all(axis=-1))
