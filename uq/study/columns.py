"""The arrays that a model's ``batch`` must return, and which of their rows failed."""

from collections.abc import Iterable, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Mask, Model, Output, Status, censored_name


class Column(NamedTuple):
    """One array of a batch.

    Attributes
    ----------
    dtype : numpy.dtype
    blank : float, int or bool
        The value in rows that could not be computed.
    shape : tuple of int
        Of one row.
    """

    dtype: np.dtype[Any]
    blank: float
    shape: tuple[int, ...]

    def blanks(self, rows: int) -> NDArray[Any]:
        """Return an array of blank rows."""
        return np.full((rows, *self.shape), self.blank, dtype=self.dtype)


def columns_of(model: Model, settings: Any) -> dict[str, Column]:
    """Return the columns of a model's batch under these settings, in declared order."""
    coordinates = model.coordinates(settings)
    columns = {}
    for name, output in model.outputs.items():
        shape = tuple(len(coordinates[dim]) for dim in output.dims)
        columns[name] = Column(np.dtype(np.float64), np.nan, shape)
        if output.is_category:
            columns[name] = Column(np.dtype(np.int8), -1, shape)
        if output.has_censored_flag:
            columns[censored_name(name)] = Column(np.dtype(np.bool_), False, shape)
    return columns


def blank_rows(columns: Mapping[str, Column], rows: int) -> dict[str, NDArray[Any]]:
    """Return every column filled with its blank value."""
    return {name: column.blanks(rows) for name, column in columns.items()}


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
