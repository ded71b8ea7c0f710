"""Clusters of dependent rows: several rows per independent sample, or jointly weighted rows."""

from dataclasses import dataclass, replace
from typing import Any, Self

import numpy as np
from numpy.typing import ArrayLike, NDArray

from uq.contract import Floats

ENOUGH_SAMPLES = 8
"""Preferred number of samples per group when a curve or ratio is estimated from groups."""

MOST_GROUPS = 32


@dataclass(frozen=True)
class SharedInfluence:
    """Influence of an estimated input law that all units share.

    The law is estimated from all rows and weights the values of the input in each row. Its error is
    therefore common to all rows. The density has the relative error 1 + e @ q, with terms q of mean
    0 and errors e.

    Attributes
    ----------
    pulls : ndarray, shape (n, terms)
        Influence of each of the n rows on the errors: the errors are the means of these columns.
    part : ndarray of int, shape (n,)
        Independent part of each of the n rows.
    row : ndarray of int, shape (m,)
        Indices of the selected rows among all n rows.
    follows : ndarray, shape (m, terms)
        Terms q at the input value of each selected row.
    errors : ndarray, shape (n,), optional
        Contribution of the law to the influence of each row on the estimated mean.
    """

    pulls: Floats
    part: NDArray[np.integer]
    row: NDArray[np.intp]
    follows: Floats
    errors: Floats | None = None

    def subset(self, rows: Any) -> "SharedInfluence":
        """Return the shared influence for a subset of the selected rows."""
        return replace(self, row=self.row[rows], follows=self.follows[rows])

    def going_with(self, joint: Floats) -> "SharedInfluence":
        """Return the shared influence on a mean, given its covariance with the terms.

        Parameters
        ----------
        joint : ndarray, shape (terms,)
            Weighted covariance of the terms and the numbers: the weighted mean of each term times
            the deviation of the numbers from their mean.
        """
        return replace(self, errors=self.pulls @ joint)

    def with_errors(self, influence: Floats) -> Floats:
        """Return the influence of all rows on a weighted mean, shape (n,).

        Parameters
        ----------
        influence : ndarray, shape (m,)
            Influence of the selected rows, computed as if the law were known exactly.
        """
        errors = self.errors
        if errors is None:
            errors = self.pulls @ (influence @ self.follows / len(influence))
        total = errors.copy()
        total[self.row] += influence * (len(total) / len(influence))
        return total


class Clusters(np.ndarray[Any, np.dtype[np.int64]]):
    """Cluster label of each row, where samples have several rows.

    It takes the place of the replicate of each row: the label is the sample if samples are
    independent, otherwise the replicate to which the sample belongs.

    Attributes
    ----------
    samples : int
        Number of samples: an upper limit of the number of independent clusters.
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
        """Create an array of cluster labels, shape (n,)."""
        marked = np.asarray(part, dtype=np.int64).view(cls)
        marked.samples, marked.are_samples, marked.together = samples, are_samples, together
        return marked

    def __array_finalize__(self, other: Any) -> None:
        """Keep the number of samples in a subset of the rows."""
        self.samples = getattr(other, "samples", 0)
        self.are_samples = getattr(other, "are_samples", True)
        self.together = None

    def with_together(self, together: SharedInfluence) -> Self:
        """Return the same parts with this dependence attached."""
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
        Mean of all rows plus the influence of each part on it [1]_. If all parts have the same
        number of rows, these are the means of the parts.

    References
    ----------
    .. [1] W. G. Cochran, "Sampling techniques", 3rd ed., Wiley (1977), 2.11.
    """
    counts = np.bincount(part)
    occupied = counts > 0
    mean = float(values.mean())
    pull = np.bincount(part, weights=values.astype(float)) - counts * mean
    return mean + np.count_nonzero(occupied) * pull[occupied] / len(values)


def random_groups(part: NDArray[np.integer]) -> NDArray[np.integer]:
    """Assign clusters to at most 32 groups, for variance estimates of other numbers than means.

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
