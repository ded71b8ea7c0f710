"""Which rows of two results belong together, and how their estimates go together for that.

Two studies with the same seed draw the same numbers. Where row by row or replicate by replicate
that makes pairs, which are independent of each other, the difference of the two is known better
than from strangers. Where the same numbers are dealt out otherwise nothing is known of it, and an
interval must do for the worst.
"""

from enum import Enum

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq import intervals, two_samples
from uq.analysis.estimators import MEAN, SD, Estimator, Sample
from uq.designs.registry import DESIGNS
from uq.estimate import Estimate
from uq.rows.elements import (
    Floats,
    are_independent,
    independent_rows,
    replicates_of,
    study_file_of,
)
from uq.study.file import Tied

_ROUNDING = 1e-6  # the root of what an interval that is a difference of two may lose

WORST = -1.0
"""The correlation that makes a difference least certain."""


class Kinship(Enum):
    """What two results have in common; the value says so to a reader."""

    STRANGERS = "the seeds differ: rows of one have nothing to do with rows of the other"
    ROWS = "the seed is the same: rows of the same number are pairs"
    REPLICATES = "the seed is the same: replicates of the same number are pairs"
    ROWS_IMPORTED = "the imported rows are the same: rows of the same number are pairs"
    UNKNOWN_IMPORTED = (
        "nothing is known of how imported rows came about: intervals are wide enough for the worst"
    )
    UNKNOWN = (
        "the seed is the same but dealt out otherwise, so that rows are neither pairs nor"
        " strangers: intervals are wide enough for the worst; give one study another seed"
    )


def kinship(first: xr.Dataset, second: xr.Dataset) -> Kinship:
    """Return what two results have in common.

    Parameters
    ----------
    first, second : xarray.Dataset
        Results of one model.

    Returns
    -------
    Kinship
    """
    both = (first, second)
    if any(DESIGNS[ds.attrs["design"]].imported for ds in both):
        return _kinship_of_imported(first, second)
    if first.attrs["seed"] != second.attrs["seed"]:
        return Kinship.STRANGERS
    independent = [DESIGNS[ds.attrs["design"]].independent for ds in both]
    if all(independent):
        same = _columns(first) == _columns(second)
        return Kinship.ROWS if same else Kinship.UNKNOWN
    if not any(independent) and first.attrs["replicates"] == second.attrs["replicates"]:
        return Kinship.REPLICATES
    return Kinship.UNKNOWN


def _kinship_of_imported(first: xr.Dataset, second: xr.Dataset) -> Kinship:
    """Return what two results have in common of which one is imported: their seeds do not tell."""
    files = [study_file_of(ds) for ds in (first, second)]
    same = files[0].data == files[1].data and files[0].design.method == files[1].design.method
    if same and all(are_independent(ds) for ds in (first, second)):
        return Kinship.ROWS_IMPORTED
    return Kinship.UNKNOWN_IMPORTED


def _columns(ds: xr.Dataset) -> int:
    return sum(not isinstance(entry, Tied) for entry in study_file_of(ds).uncertain.values())


Places = tuple[NDArray[np.intp], NDArray[np.intp]]


def shared_rows(first: xr.Dataset, second: xr.Dataset) -> Places:
    """Return the places of the rows that both results have, in each of them."""
    most = max(ds.attrs["replicates"] for ds in (first, second))
    mine, other = (ds["group"].values * most + ds["replicate"].values for ds in (first, second))
    _, here, there = np.intersect1d(mine, other, assume_unique=True, return_indices=True)
    return here, there


def correlation(first: Floats, second: Floats, shared: Places, is_share: bool) -> float:
    """Return the correlation of two estimates from what each pair of rows adds to them.

    Parameters
    ----------
    first, second : ndarray, shape (n,) and (m,)
        How far each row pulls its estimate from where it is; they sum up to nothing.
    shared : tuple of ndarray of int
        As from `shared_rows`.
    is_share : bool
        Whether they are shares: then half a row counts against agreement, which few rows
        overstate [1]_.

    Returns
    -------
    float

    References
    ----------
    .. [1] R. G. Newcombe, "Improved confidence intervals for the difference between binomial
       proportions based on paired data", Stat. Med. 17, 2635-2650 (1998).
    """
    together = float(first[shared[0]] @ second[shared[1]])
    if is_share and together > 0:
        together = max(together - 0.5, 0.0)
    size = np.sqrt(float(first @ first) * float(second @ second))
    return together / size if size > 0 else 0.0


class Pair:
    """The independent rows of two results of one model, and how their estimates go together.

    Parameters
    ----------
    first, second : xarray.Dataset
    """

    def __init__(self, first: xr.Dataset, second: xr.Dataset) -> None:
        self.rows = (independent_rows(first), independent_rows(second))
        self.kinship = kinship(first, second)
        self._replicate = [replicates_of(rows) for rows in self.rows]
        paired = self.kinship in (Kinship.ROWS, Kinship.ROWS_IMPORTED)
        self._shared = shared_rows(*self.rows) if paired else None

    def difference(
        self, estimator: Estimator, samples: list[Sample], known: list[Estimate]
    ) -> Estimate:
        """Return how far an estimate of the second lies from that of the first."""
        if self.kinship is Kinship.REPLICATES and not estimator.is_share:
            value = known[1].value - known[0].value
            own = [self._by_replicate(estimator, i, one) for i, one in enumerate(samples)]
            if not np.isfinite(own).all():
                return Estimate(value)
            apart = own[1] - own[0]
            if intervals.is_constant(apart + np.abs(own).max()):  # they differ by rounding alone
                return Estimate(value)
            return Estimate(value, *intervals.scatter_interval(value, apart))
        if estimator.counts_hits and all(one is None for one in self._replicate):
            known = [_newcombe(sample) for sample in samples]
        found = two_samples.difference(known[0], known[1], self._correlation(estimator, samples))
        wide = sum(one.high - one.low for one in known)
        paired = self.kinship in (Kinship.ROWS, Kinship.REPLICATES)
        if paired and found.high - found.low <= _ROUNDING * wide < np.inf:
            return Estimate(found.value)  # as good as the same in each pair
        return found

    def identical(self, samples: list[Sample]) -> bool:
        """Whether the rows are pairs, and both of each pair say the same."""
        if self.kinship not in (Kinship.ROWS, Kinship.REPLICATES):
            return False
        first, second = samples
        return np.array_equal(first.kept, second.kept) and np.array_equal(
            first.numbers, second.numbers, equal_nan=True
        )

    def ratio(self, samples: list[Sample], known: list[Estimate]) -> Estimate:
        """Return the second standard deviation over the first."""
        if self.kinship is Kinship.REPLICATES and all(one.value > 0 for one in known):
            found = [self._by_replicate(SD, i, one) for i, one in enumerate(samples)]
            return _factor(known[1].value / known[0].value, found[1], found[0])
        return two_samples.ratio(known[0], known[1], self._correlation(SD, samples))

    @property
    def unpaired(self) -> float:
        """The correlation to reckon with where no rows can be held against each other."""
        return 0.0 if self.kinship is Kinship.STRANGERS else WORST

    def _correlation(self, estimator: Estimator, samples: list[Sample]) -> float:
        if self.kinship is Kinship.REPLICATES:
            return self._replicates_correlation(estimator, samples)
        if self._shared is None:
            return self.unpaired
        pulls = []
        for sample in samples:
            pull = np.zeros(len(sample.numbers))
            if sample.kept.any():
                pull[sample.kept] = estimator.pull(sample.numbers[sample.kept])
            pulls.append(pull)
        return correlation(pulls[0], pulls[1], self._shared, estimator.is_share)

    def _replicates_correlation(self, estimator: Estimator, samples: list[Sample]) -> float:
        """Return the correlation of the pulls of whole replicates; NaN where one has none.

        With the ends of Woodruff's intervals this makes the interval of Student's t of the
        linearised differences of the replicates, each of whose own quantiles is a poor one.
        """
        pulls = []
        for i, sample in enumerate(samples):
            pull = sample._replace(numbers=np.zeros(len(sample.numbers)))
            if sample.kept.any():
                pull.numbers[sample.kept] = estimator.pull(sample.numbers[sample.kept])
            pulls.append(self._by_replicate(MEAN, i, pull))
        if not all(np.isfinite(one).all() and not intervals.is_constant(one) for one in pulls):
            return np.nan
        return float(np.asarray(np.corrcoef(pulls))[0, 1])

    def _by_replicate(self, estimator: Estimator, i: int, sample: Sample) -> Floats:
        of, count = self._replicate[i], int(self.rows[i].attrs["replicates"])
        assert of is not None, "independent rows are not taken by replicate"
        found = np.full(count, np.nan)
        for r in range(count):
            values = sample.numbers[sample.kept & (of == r)]
            if len(values):
                found[r] = estimator.of(values)
        return found


def _newcombe(sample: Sample) -> Estimate:
    """Return a share with Wilson's interval, of which that of a difference is made.

    The interval of a single share is exact where hits are few: two of these would make one too
    wide.
    """
    hits = sample.numbers[sample.kept]
    return Estimate(float(hits.mean()), *intervals.wilson_interval(hits.mean(), len(hits)))


def _factor(value: float, above: Floats, below: Floats) -> Estimate:
    """Return a ratio with its interval from those of the replicates, in which it is logarithmic."""
    if not (value > 0 and (above > 0).all() and (below > 0).all()):  # nor are they where unknown
        return Estimate(value)
    ends = intervals.scatter_interval(float(np.log(value)), np.log(above / below))
    return Estimate(value, *np.exp(ends).tolist())
