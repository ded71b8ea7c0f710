"""Rows that are not independent: several of each independent sample."""

from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from uq.contract import Floats

ENOUGH_SAMPLES = 8
"""Samples in a group, where possible, from which a curve or ratio is estimated."""

MOST_GROUPS = 32


class Clusters(np.ndarray[Any, np.dtype[np.int64]]):
    """The independent part of a design to which each row belongs, where samples have several rows.

    It stands for the replicate of each row: the sample, where samples are independent, else the
    replicate that the sample belongs to.

    Attributes
    ----------
    samples : int
        The number of samples: of independent things, at most.
    are_samples : bool
        Whether the parts are samples, not replicates of a design.
    """

    samples: int
    are_samples: bool

    def __new__(cls, of: ArrayLike, samples: int, are_samples: bool = True) -> Self:
        """Mark the part of each row, shape (n,)."""
        marked = np.asarray(of, dtype=np.int64).view(cls)
        marked.samples, marked.are_samples = samples, are_samples
        return marked

    def __array_finalize__(self, other: Any) -> None:
        """Keep the number of samples where some rows are taken."""
        self.samples = getattr(other, "samples", 0)
        self.are_samples = getattr(other, "are_samples", True)


def linearised_means(values: NDArray[Any], of: NDArray[np.integer]) -> Floats:
    """Return what each part says of the mean of all rows, shape (parts,).

    Parameters
    ----------
    values : ndarray, shape (n,)
    of : ndarray of int, shape (n,)
        The part of each row.

    Returns
    -------
    ndarray
        The mean of all rows plus the influence of each part on it [1]_; where all parts have as
        many rows, their own means.

    References
    ----------
    .. [1] W. G. Cochran, "Sampling techniques", 3rd ed., Wiley (1977), 2.11.
    """
    counts = np.bincount(of)
    there = counts > 0
    mean = float(values.mean())
    pull = np.bincount(of, weights=values.astype(float)) - counts * mean
    return mean + np.count_nonzero(there) * pull[there] / len(values)


def dealt(of: NDArray[np.integer]) -> NDArray[np.integer]:
    """Return rows dealt into at most 32 groups of independent parts, for what is not a mean.

    Parameters
    ----------
    of : ndarray of int, shape (n,)
        The part of each row.

    Returns
    -------
    ndarray of int, shape (n,)
        `of` itself unless samples are its parts.
    """
    if not isinstance(of, Clusters):
        return of
    _, place = np.unique(np.asarray(of), return_inverse=True)
    parts = int(place.max(initial=-1)) + 1
    groups = min(parts, max(ENOUGH_SAMPLES, min(MOST_GROUPS, parts // ENOUGH_SAMPLES)))
    return place * groups // max(parts, 1)
