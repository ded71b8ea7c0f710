"""Slices of an input: rows with neighbouring values, or with the same one."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats

LEAST_ROWS = 10
"""A value of an input with fewer rows than this has no slice of its own."""

MOST_CATEGORIES = 10
"""An input with no more values than this is sliced by value."""

MANY_EQUAL = 0.05
"""An input has many equal values if one of them has a larger share of the rows than this."""


def has_many_equal(column: Floats) -> bool:
    """Return whether one value of an input has a large share of the rows."""
    return is_repeated(np.sort(column))


def is_repeated(ascending: Floats) -> bool:
    """Return whether one of these ascending values has a large share of them."""
    most = int(max(MANY_EQUAL * len(ascending), 1))
    return bool((ascending[most:] == ascending[:-most]).any())  # a value more than `most` times


def slice_of(column: Floats, cuts: NDArray[np.intp], least: int = LEAST_ROWS) -> NDArray[np.intp]:
    """Divide the rows into slices of an input; rows of the same value are in the same slice.

    Parameters
    ----------
    column : ndarray, shape (n,)
    cuts : ndarray of int, shape (k - 1,)
        Where k slices would begin among the sorted rows if all values differed.
    least : int, optional
        Rows of a slice by value.

    Returns
    -------
    ndarray of int, shape (n,)
        Number of each row's slice. Few values have a slice each, whatever they are called, and
        rare ones share a slice. Among many values, the cuts move to where a value ends.
    """
    values, place, counts = np.unique(column, return_inverse=True, return_counts=True)
    if len(values) <= max(MOST_CATEGORIES, len(cuts) + 1):
        return np.asarray(_categories(counts, least)[place])
    ends = np.cumsum(counts)
    above = np.minimum(np.searchsorted(ends, cuts), len(ends) - 2)
    below = np.maximum(above - 1, 0)
    nearest = np.where(cuts - ends[below] < ends[above] - cuts, ends[below], ends[above])
    return np.asarray(np.searchsorted(np.unique(nearest), ends - counts, side="right")[place])


def _categories(counts: NDArray[np.intp], least: int) -> NDArray[np.intp]:
    """Return the number of each value's slice: one each, and one of all rare values."""
    order = np.argsort(counts, kind="stable")
    rare = int((counts < least).sum())
    if rare:  # enough of them, with the next more frequent ones, to make a slice
        rare = max(rare, int(np.searchsorted(np.cumsum(counts[order]), least)) + 1)
    number = np.empty(len(counts), np.intp)
    number[order] = np.maximum(np.arange(len(counts)) - max(rare - 1, 0), 0)
    return number


def by_slices(
    x: Floats,
    cuts: NDArray[np.intp],
    measure: Callable[[NDArray[np.intp]], float],
    least: int = LEAST_ROWS,
) -> Floats:
    """Return ``measure(number of each row's slice)`` of each input, shape (d,).

    NaN where an input varies within one slice only; see `slice_of`.
    """
    numbers = [slice_of(column, cuts, least) for column in x.T]
    return np.array(
        [
            measure(number) if number.any() or not np.ptp(column) else np.nan
            for column, number in zip(x.T, numbers, strict=True)
        ]
    )


def even_cuts(rows: int, slices: int) -> NDArray[np.intp]:
    """Return where slices of equally many rows begin, except the first."""
    return np.linspace(0, rows, slices + 1)[1:-1].astype(np.intp)
