"""Clustering of rows by the attractor on which they settled, from their outputs alone.

Sorted by one output, rows of two attractors are separated by a gap. Rows are split at every gap of
every output, and the parts again until no gap is left. So rows that differ no more than neighbours
do stay together, however many lie in between: a branch of responses that changes with a parameter
is one attractor.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats

STANDARD_ERRORS = 4.0
"""Of the difference between two values: a smaller difference is no gap."""


Compared = tuple[Floats, Floats, float]
"""Values of every row, shape (n,), of which NaN agrees with NaN and infinity with infinity; their
standard errors, 0 where there are none; and the tolerance, relative to the largest finite magnitude
among the values; 0: equal or not."""


def attractors(compared: Sequence[Compared], rows: int) -> NDArray[np.int32]:
    """Return the number of the attractor of each row, the most frequent first.

    Parameters
    ----------
    compared : sequence of Compared
    rows : int

    Returns
    -------
    ndarray of int32, shape (rows,)
        Of equally frequent attractors, the first to occur has the lower number.
    """
    labels, count = np.zeros(rows, np.int64), 0
    while count < (count := len(np.unique(labels))):
        for values, errors, tolerance in compared:
            labels = _parted(labels, values, errors, tolerance)
    _, first, place, frequency = np.unique(
        labels, return_index=True, return_inverse=True, return_counts=True
    )
    rank = np.empty(len(first), np.int32)
    rank[np.lexsort((first, -frequency))] = np.arange(len(first))
    return rank[place]


def _parted(
    labels: NDArray[np.int64], values: Floats, errors: Floats, tolerance: float
) -> NDArray[np.int64]:
    """Split each group of rows at the gaps of one output."""
    size = np.abs(values[np.isfinite(values)]).max(initial=0.0)
    order = np.lexsort((values, labels))
    values, errors, groups = values[order], errors[order], labels[order]
    lower, upper = values[:-1], values[1:]
    slack = tolerance * size + STANDARD_ERRORS * np.hypot(errors[:-1], errors[1:])
    with np.errstate(invalid="ignore"):
        alike = (lower == upper) | (upper - lower <= slack) | (np.isnan(lower) & np.isnan(upper))
    new = np.concatenate([[False], ~alike | (groups[:-1] != groups[1:])])[: len(labels)]
    parted = np.empty_like(labels)
    parted[order] = np.cumsum(new)
    return parted
