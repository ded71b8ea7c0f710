"""The arrays that a model's ``batch`` must return, and which of their rows failed."""

from collections.abc import Iterable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uq.contract import Mask, Model, Output, Status, censored_name


def columns_of(model: Model, settings: Any) -> dict[str, NDArray[Any]]:
    """Return the columns of a model's batch under these settings, in declared order.

    Returns
    -------
    dict of str to ndarray, shape (*dims)
        A row that could not be computed: the type and shape of every row.
    """
    coordinates = model.coordinates(settings)
    columns: dict[str, NDArray[Any]] = {}
    for name, output in model.outputs.items():
        shape = tuple(len(coordinates[dim]) for dim in output.dims)
        blank = np.int8(-1) if output.is_category else np.nan
        columns[name] = np.full(shape, blank)
        if output.has_censored_flag:
            columns[censored_name(name)] = np.full(shape, False)
    return columns


def failed_rows(status: NDArray[np.int8], required: Iterable[tuple[Output, NDArray[Any]]]) -> Mask:
    """Return which rows failed.

    A row out of budget failed only if an output is missing.

    Parameters
    ----------
    status : ndarray of int8, shape (n,)
    required : iterable of (Output, ndarray)
        Each output that may not be undefined, and its values, shape (n, *dims).

    Returns
    -------
    ndarray of bool, shape (n,)
    """
    if not np.any(status == Status.OUT_OF_BUDGET):  # no output needs to be read
        return np.asarray(status != Status.OK)
    incomplete = np.zeros(len(status), dtype=np.bool_)
    for output, values in required:
        incomplete |= output.is_absent(values).any(axis=tuple(range(1, values.ndim)))
    return np.where(status == Status.OUT_OF_BUDGET, incomplete, status != Status.OK)
