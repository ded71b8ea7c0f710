"""Rows that are not independent: several of each independent sample, or weighted together."""

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from uq.contract import Floats

ENOUGH_SAMPLES = 8
"""Samples in a group, where possible, from which a curve or ratio is estimated."""

MOST_GROUPS = 32


@dataclass(frozen=True)
class SharedInfluence:
    """The law of an input that all units share, which all rows together have learnt.

    Each row weighs values of the input by what all rows say of them, so that an error of this law
    is common to all. Its density is known up to 1 + e @ q: terms q that have mean 0, and errors e.

    Attributes
    ----------
    pulls : ndarray, shape (n, terms)
        Of all rows: the errors are their means.
    part : ndarray of int, shape (n,)
        The independent part of each.
    row : ndarray of int, shape (m,)
        Which of these the rows at hand are.
    follows : ndarray, shape (m, terms)
        The terms at the value of the input in each of them.
    errors : ndarray, shape (n,), optional
        Contribution of the law to the influence of each on the mean at hand.
    """

    pulls: Floats
    part: NDArray[np.integer]
    row: NDArray[np.intp]
    follows: Floats
    errors: Floats | None = None

    def subset(self, rows: Any) -> "SharedInfluence":
        """Return the same for a subset of the rows at hand."""
        return replace(self, row=self.row[rows], follows=self.follows[rows])

    def going_with(self, joint: Floats) -> "SharedInfluence":
        """Return the same for a mean of this covariance with the terms, not computed by row.

        Parameters
        ----------
        joint : ndarray, shape (terms,)
            The weighted mean of the terms times what the numbers lie above their mean.
        """
        return replace(self, errors=self.pulls @ joint)

    def with_errors(self, influence: Floats) -> Floats:
        """Return the influence of all rows on a weighted mean, shape (n,).

        Parameters
        ----------
        influence : ndarray, shape (m,)
            Of the rows at hand, were the law known.
        """
        errors = self.errors
        if errors is None:
            errors = self.pulls @ (influence @ self.follows / len(influence))
        total = errors.copy()
        total[self.row] += influence * (len(total) / len(influence))
        return total


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
    together : SharedInfluence or None
        Dependence of the rows beyond their parts.
    """

    samples: int
    are_samples: bool
    together: SharedInfluence | None

    def __new__(
        cls,
        part: ArrayLike,
        samples: int,
        are_samples: bool = True,
        together: SharedInfluence | None = None,
    ) -> Self:
        """Mark the part of each row, shape (n,)."""
        marked = np.asarray(part, dtype=np.int64).view(cls)
        marked.samples, marked.are_samples, marked.together = samples, are_samples, together
        return marked

    def __array_finalize__(self, other: Any) -> None:
        """Keep the number of samples in a subset of the rows."""
        self.samples = getattr(other, "samples", 0)
        self.are_samples = getattr(other, "are_samples", True)
        self.together = None

    def with_together(self, together: SharedInfluence) -> Self:
        """Return the same parts with this dependence between them."""
        parts = self.copy()
        parts.together = together
        return parts

    def __getitem__(self, rows: Any) -> Any:
        """Return the parts of a subset of the rows."""
        parts = super().__getitem__(rows)
        if self.together is not None and isinstance(parts, Clusters):
            parts.together = self.together.subset(rows)
        return parts


def linearised_means(values: NDArray[Any], part: NDArray[np.integer]) -> Floats:
    """Return the linearised mean of each independent part, shape (parts,).

    Parameters
    ----------
    values : ndarray, shape (n,)
    part : ndarray of int, shape (n,)
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
    counts = np.bincount(part)
    occupied = counts > 0
    mean = float(values.mean())
    pull = np.bincount(part, weights=values.astype(float)) - counts * mean
    return mean + np.count_nonzero(occupied) * pull[occupied] / len(values)


def dealt(part: NDArray[np.integer]) -> NDArray[np.integer]:
    """Deal rows into at most 32 groups of independent parts, for estimates other than means.

    Parameters
    ----------
    part : ndarray of int, shape (n,)
        The part of each row.

    Returns
    -------
    ndarray of int, shape (n,)
        `part` itself unless it is a `Clusters`.
    """
    if not isinstance(part, Clusters):
        return part
    _, place = np.unique(np.asarray(part), return_inverse=True)
    parts = int(place.max(initial=-1)) + 1
    groups = min(parts, max(ENOUGH_SAMPLES, min(MOST_GROUPS, parts // ENOUGH_SAMPLES)))
    return place * groups // max(parts, 1)
