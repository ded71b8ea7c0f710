"""Dependence between rows: replicates of a design, several rows per sample, a shared law."""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.stats.jumps import Neighbours

ENOUGH_SAMPLES = 8
"""Preferred number of samples per group when a curve or ratio is estimated from groups."""

MOST_GROUPS = 32


@dataclass(frozen=True, eq=False)
class SharedInfluence:
    """Influence of an estimated input law that all units share.

    The law is estimated from all rows and weights the values of the input in each row. Its error is
    therefore common to all rows. The density has the relative error 1 + e @ q, with terms q of mean
    0 and errors e.

    Attributes
    ----------
    influence : ndarray, shape (n, terms)
        Influence of each of the n rows on the errors: the errors are the means of these columns.
    labels : ndarray of int, shape (n,)
        Independent part of each of the n rows.
    row : ndarray of int, shape (m,)
        Indices of the selected rows among all n rows.
    terms : ndarray, shape (m, terms)
        Terms q at the input value of each selected row.
    on_mean : ndarray, shape (n,), optional
        Contribution of the law to the influence of each row on the estimated mean.
    """

    influence: Floats
    labels: NDArray[np.integer]
    row: NDArray[np.intp]
    terms: Floats
    on_mean: Floats | None = None

    def subset(self, rows: Any) -> "SharedInfluence":
        """Return the shared influence for a subset of the selected rows."""
        return replace(self, row=self.row[rows], terms=self.terms[rows])

    def with_covariance(self, covariance: Floats) -> "SharedInfluence":
        """Return the shared influence on a mean, given its covariance with the terms.

        Parameters
        ----------
        covariance : ndarray, shape (terms,)
            Weighted covariance of the terms and the numbers: the weighted mean of each term times
            the deviation of the numbers from their mean.
        """
        return replace(self, on_mean=self.influence @ covariance)

    def added_to(self, influence: Floats) -> Floats:
        """Return the influence of all rows on a weighted mean, shape (n,).

        Parameters
        ----------
        influence : ndarray, shape (m,)
            Influence of the selected rows, computed as if the law were known exactly.
        """
        on_mean = self.on_mean
        if on_mean is None:
            on_mean = self.influence @ (influence @ self.terms / len(influence))
        total = on_mean.copy()
        total[self.row] += influence * (len(total) / len(influence))
        return total


@dataclass(frozen=True, eq=False)
class Dependence:
    """Dependence between the rows of a sample: rows with different labels are independent.

    Attributes
    ----------
    labels : ndarray of int, shape (n,), optional
        Independent part to which each row belongs: a replicate of a stratified design, or a sample
        of several rows. None if all rows are independent.
    inputs : ndarray, shape (n, d), optional
        Inputs of the rows of a stratified design, whose replicates may all hide the same jump.
    samples : int, optional
        Number of samples, if these have several rows or share a law: an upper limit of the number
        of independent rows.
    are_samples : bool
        Whether the parts are these samples, not replicates to which they belong.
    shared : SharedInfluence or None
        Dependence of the rows beyond their parts.
    """

    labels: NDArray[np.integer] | None = None
    inputs: Floats | None = None
    samples: int | None = None
    are_samples: bool = False
    shared: SharedInfluence | None = None

    @property
    def is_none(self) -> bool:
        """Whether all rows are independent."""
        return self.labels is None

    @property
    def has_independent_parts(self) -> bool:
        """Whether rows, or samples of several rows, are independent, not only replicates."""
        return self.labels is None or self.are_samples

    @cached_property
    def neighbours(self) -> Neighbours | None:
        """Order of the rows along each input, if replicates of a design may hide jumps."""
        if self.labels is None or self.inputs is None or not self.inputs.size:
            return None
        return Neighbours(self.labels, self.inputs)

    def __getitem__(self, rows: Any) -> "Dependence":
        """Return the dependence of a subset of the rows."""
        if self.labels is None:
            return self
        if isinstance(rows, np.ndarray) and rows.dtype == bool and rows.all():
            return self  # with its neighbours
        return replace(
            self,
            labels=self.labels[rows],
            inputs=None if self.inputs is None else self.inputs[rows],
            shared=None if self.shared is None else self.shared.subset(rows),
        )

    def part_means(self, values: NDArray[np.generic]) -> Floats:
        """Return the mean of each replicate that has rows; of samples `linearised_means`.

        Independent rows are returned as they are.
        """
        if self.labels is None:
            return np.asarray(values)
        if self.samples is not None:
            return linearised_means(values, self.labels)
        counts = np.bincount(self.labels)
        sums = np.bincount(self.labels, weights=values.astype(float, copy=False))
        return sums[counts > 0] / counts[counts > 0]

    def sums_of_samples(self, numbers: Floats) -> Floats:
        """Return the sum over each independent sample of several rows, else the numbers."""
        if self.labels is None or not self.are_samples:
            return numbers
        _, place = np.unique(self.labels, return_inverse=True)
        return np.bincount(place, weights=numbers).astype(float)

    def groups(self) -> NDArray[np.integer]:
        """Return the replicate of each row, or one of at most 32 groups of samples, shape (n,).

        For variance estimates of numbers other than means. Not for independent rows.
        """
        assert self.labels is not None, "independent rows have no groups"
        if self.samples is None:
            return self.labels
        _, place = np.unique(self.labels, return_inverse=True)
        parts = int(place.max(initial=-1)) + 1
        groups = min(parts, max(ENOUGH_SAMPLES, min(MOST_GROUPS, parts // ENOUGH_SAMPLES)))
        return place * groups // max(parts, 1)


INDEPENDENT = Dependence()
"""All rows are independent."""


def linearised_means(values: NDArray[Any], labels: NDArray[np.integer]) -> Floats:
    """Return the linearised mean of each independent part, shape (parts,).

    Parameters
    ----------
    values : ndarray, shape (n,)
    labels : ndarray of int, shape (n,)
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
    counts = np.bincount(labels)
    occupied = counts > 0
    mean = float(values.mean())
    influence = np.bincount(labels, weights=values.astype(float)) - counts * mean
    return mean + np.count_nonzero(occupied) * influence[occupied] / len(values)
