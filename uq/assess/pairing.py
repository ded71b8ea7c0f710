"""Pair the rows of two results, and correlate their estimates.

Two studies with the same seed draw the same numbers. Where this pairs their rows or replicates,
and the pairs are independent of each other, the difference is known better than from independent
samples. Where the numbers are shared but not paired, the correlation is unknown, and intervals
are conservative.
"""

from enum import Enum
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from uq.assess.sample import MEAN, SD, Estimator, SelectedRows
from uq.contract import Floats
from uq.result.result import Result
from uq.stats import intervals
from uq.stats.estimate import Estimate, difference, ratio
from uq.stats.intervals import OUTLYING_ROWS, exact_interval
from uq.stats.jumps import widened_for_jumps
from uq.stats.moments import OUTLYING_SQUARES
from uq.stats.weighted_means import share_to_compare
from uq.study.file import Tied

_ROUNDING = 1e-6  # an interval so much narrower than the plain ones is zero but for rounding

WORST = -1.0
"""The correlation at which a difference is least certain."""


class Pairing(Enum):
    """Relation between the rows of two results; the value is the sentence that reports it."""

    RECORD = "The lives from the field are independent of the other rows."
    INDEPENDENT = "The seeds differ: the two samples are independent."
    ROWS = "The studies share a seed: rows with the same number are paired."
    ROWS_SAME = "Both results have the same rows."
    REPLICATES = "The studies share a seed: replicates with the same number are paired."
    ROWS_IMPORTED = "The imported rows are the same: rows with the same number are paired."
    WEIGHTED = "The rows have weights, so these intervals are conservative."
    UNKNOWN_IMPORTED = (
        "How the imported rows were drawn is unknown, so these intervals are conservative."
    )
    UNKNOWN = (
        "The studies share a seed but are not paired, so these intervals are conservative. Use"
        " different seeds."
    )


def pairing(first: Result, second: Result) -> Pairing:
    """Return how the rows of two results are related.

    Parameters
    ----------
    first, second : Result
        Results of one model.

    Returns
    -------
    Pairing
    """
    both = (first, second)
    if any(result.has_weights for result in both):
        return Pairing.WEIGHTED
    if any(result.is_field_record for result in both):
        return Pairing.ROWS_SAME if _same_rows(first, second) else Pairing.RECORD
    if any(result.design.imported for result in both):
        return _pairing_of_imported(first, second)
    if first.dataset.attrs["seed"] != second.dataset.attrs["seed"]:
        return Pairing.INDEPENDENT
    independent = [result.has_independent_samples for result in both]
    if any(independent) and any(result.is_nested for result in both):
        return Pairing.ROWS_SAME if _same_rows(first, second) else Pairing.UNKNOWN
    if all(independent):
        same = _columns(first) == _columns(second)
        return Pairing.ROWS if same else Pairing.UNKNOWN
    if (
        not any(independent)
        and first.dataset.attrs["replicates"] == second.dataset.attrs["replicates"]
    ):
        return Pairing.REPLICATES
    return Pairing.UNKNOWN


def _same_rows(first: Result, second: Result) -> bool:
    """Return whether two results are of one study, with the same number in every place."""
    if first.dataset.attrs["study_identity"] != second.dataset.attrs["study_identity"]:
        return False
    return first.dataset.drop_attrs().equals(second.dataset.drop_attrs())


def _pairing_of_imported(first: Result, second: Result) -> Pairing:
    """Return how two results are related if one is imported, so that seeds do not matter."""
    files = [result.study for result in (first, second)]
    same = files[0].data == files[1].data and files[0].design.method == files[1].design.method
    if same and all(result.has_independent_rows for result in (first, second)):
        return Pairing.ROWS_IMPORTED
    return Pairing.UNKNOWN_IMPORTED


def _columns(result: Result) -> int:
    return sum(not isinstance(entry, Tied) for entry in result.study.uncertain.values())


Places = tuple[NDArray[np.intp], NDArray[np.intp]]


def shared_rows(first: Result, second: Result) -> Places:
    """Return the positions in each result of the rows that both have."""
    most = max(result.dataset.attrs["replicates"] for result in (first, second))
    mine, other = (
        result.dataset["group"].values * most + result.dataset["replicate"].values
        for result in (first, second)
    )
    _, here, there = np.intersect1d(mine, other, assume_unique=True, return_indices=True)
    return here, there


def correlation(first: Floats, second: Floats, shared: Places, *, is_share: bool) -> float:
    """Return the correlation of two estimates from the influence of each pair of rows.

    Parameters
    ----------
    first, second : ndarray, shape (n,) and (m,)
        Influence of each row on its estimate; they sum to zero.
    shared : tuple of ndarray of int
        As from `shared_rows`.
    is_share : bool
        Whether the estimates are shares: then a continuity correction of half a row is applied,
        since few rows overstate the agreement [1]_.

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
    """The independent rows of two results of one model, and how their estimates are correlated.

    Parameters
    ----------
    first, second : Result
    """

    def __init__(self, first: Result, second: Result) -> None:
        self.rows = (first.independent, second.independent)
        self.pairing = pairing(first, second)
        self._dependence = [rows.dependence for rows in self.rows]
        rows = self.pairing in (Pairing.ROWS, Pairing.ROWS_IMPORTED)
        self._shared = shared_rows(*self.rows) if rows else None
        self._paired = rows or self.pairing in (Pairing.REPLICATES, Pairing.ROWS_SAME)

    def difference(
        self, estimator: Estimator, samples: list[SelectedRows], estimates: list[Estimate]
    ) -> Estimate:
        """Return an estimate from the second result less that from the first."""
        if self.pairing is Pairing.REPLICATES and not estimator.is_share:
            value = estimates[1].value - estimates[0].value
            by_replicate = [
                self._by_replicate(estimator, i, rows) for i, rows in enumerate(samples)
            ]
            if not np.isfinite(by_replicate).all():
                return Estimate(value)
            apart = by_replicate[1] - by_replicate[0]
            if intervals.is_constant(
                apart + np.abs(by_replicate).max()
            ):  # they differ only by rounding
                return Estimate(value)
            ends = intervals.scatter_interval(value, apart)
            return Estimate(value, *self._widened_for_jumps(value, ends, estimator, samples))
        if self.pairing is Pairing.WEIGHTED:
            return difference(estimates[0], estimates[1], self.unpaired)
        if estimator.counts_hits and all(rows.is_none for rows in self._dependence):
            estimates = [_newcombe(sample) for sample in samples]
        elif estimator.averages:
            estimates = [self._averaged(i, sample) for i, sample in enumerate(samples)]
        elif self._shared is not None and not estimator.is_share:
            return self._difference_of_moments(estimator, samples, estimates)
        between = difference(estimates[0], estimates[1], self._correlation(estimator, samples))
        return self._without_rounding(between, estimates)

    def _difference_of_moments(
        self, estimator: Estimator, samples: list[SelectedRows], estimates: list[Estimate]
    ) -> Estimate:
        """Return the difference of two means or standard deviations of paired rows.

        From Student's intervals, widened for outliers that the pairs lack; of standard deviations,
        which a few rows may decide, together with the one from their separate intervals.
        """
        correlation = self._correlation(estimator, samples)
        students = [_students(estimator, *pair) for pair in zip(samples, estimates, strict=True)]
        between = difference(students[0], students[1], correlation)
        if between.has_interval:
            shift = self._outlier_shift(estimator, samples)
            low, high = between.low + min(shift, 0.0), between.high + max(shift, 0.0)
            between = Estimate(between.value, low, high, between.reason)
        if estimator.is_scale:
            separate = difference(estimates[0], estimates[1], correlation)
            between = _envelope(between, separate)
        return self._without_rounding(between, estimates)

    def _without_rounding(self, between: Estimate, estimates: list[Estimate]) -> Estimate:
        """Return a difference without interval if each pair is equal but for rounding."""
        wide = sum(estimate.high - estimate.low for estimate in estimates)
        if self._paired and between.high - between.low <= _ROUNDING * wide < np.inf:
            return Estimate(between.value)  # equal in each pair, but for rounding
        return between

    def are_equal(self, samples: list[SelectedRows]) -> bool:
        """Return whether the rows are paired and both rows of each pair have the same numbers."""
        if not self._paired or len(samples) < 2:
            return False
        first, second = samples
        return np.array_equal(first.kept, second.kept) and np.array_equal(
            first.numbers, second.numbers, equal_nan=True
        )

    @cached_property
    def have_equal_outputs(self) -> bool:
        """Return whether the rows are paired and both rows of each pair agree in all outputs."""
        first, second = self.rows
        names = [name for name in first.outputs if name in second.dataset]
        return self._paired and first.dataset[names].drop_attrs().equals(
            second.dataset[names].drop_attrs()
        )

    def most_that_change_sides(self, sample: SelectedRows) -> float:
        """Return the exact upper confidence limit of a share without an observed case.

        A share that has no hit among all rows in 2.5 % of samples: the upper end of the exact 95 %
        interval [1]_. Rows of a design that spreads evenly hit such a share more often.

        References
        ----------
        .. [1] C. J. Clopper, E. S. Pearson, "The use of confidence or fiducial limits illustrated
           in the case of the binomial", Biometrika 26, 404-413 (1934).
        """
        rows = int(np.count_nonzero(sample.kept))
        return float(exact_interval(0.0, rows, intervals.CONFIDENCE)[1])

    def ratio(self, samples: list[SelectedRows], estimates: list[Estimate]) -> Estimate:
        """Return the second standard deviation over the first."""
        if self.pairing is Pairing.REPLICATES and all(estimate.value > 0 for estimate in estimates):
            by_replicate = [self._by_replicate(SD, i, sample) for i, sample in enumerate(samples)]
            return _factor(
                estimates[1].value / estimates[0].value, by_replicate[1], by_replicate[0]
            )
        correlation = self._correlation(SD, samples)
        separate = ratio(estimates[0], estimates[1], correlation)
        if self._shared is None:
            return separate
        students = [_students(SD, *pair) for pair in zip(samples, estimates, strict=True)]
        factor = ratio(students[0], students[1], correlation)
        if factor.has_interval:
            shift = self._outlier_shift(SD, samples, relative=True)
            low, high = (float(np.exp(end)) for end in (min(shift, 0.0), max(shift, 0.0)))
            factor = Estimate(factor.value, factor.low * low, factor.high * high, factor.reason)
        return _envelope(factor, separate)

    def _outlier_shift(
        self, estimator: Estimator, samples: list[SelectedRows], *, relative: bool = False
    ) -> float:
        """Return the shift of a difference of moments by further outliers among the pairs.

        Outliers of rows that differ little between the results cancel; those of a law with another
        scatter do not.
        """
        assert self._shared is not None, "rows are paired"
        first, second = (_contributions(estimator, sample, relative) for sample in samples)
        apart = second[self._shared[1]] - first[self._shared[0]]
        more = OUTLYING_SQUARES if estimator.is_scale else OUTLYING_ROWS
        return intervals.outlier_shift(0.0, apart, more)

    @property
    def unpaired(self) -> float:
        """The correlation to assume where rows are not paired."""
        return 0.0 if self.pairing in (Pairing.INDEPENDENT, Pairing.RECORD) else WORST

    def _correlation(self, estimator: Estimator, samples: list[SelectedRows]) -> float:
        """Return the correlation of influences of paired rows, or of means in paired replicates.

        The second is NaN where a replicate has no rows. Together with Woodruff's intervals it gives
        Student's t interval of the linearised differences between replicates, whose own quantiles
        are poor estimates.
        """
        if self._shared is None and self.pairing is not Pairing.REPLICATES:
            return self.unpaired
        influences = [_influence(estimator, sample) for sample in samples]
        if self._shared is not None:
            first, second = (influence.numbers for influence in influences)
            return correlation(first, second, self._shared, is_share=estimator.is_share)
        means = [self._by_replicate(MEAN, i, rows) for i, rows in enumerate(influences)]
        if not all(np.isfinite(mean).all() and not intervals.is_constant(mean) for mean in means):
            return np.nan
        return float(np.asarray(np.corrcoef(means))[0, 1])

    def _widened_for_jumps(
        self, value: float, ends: intervals.Ends, estimator: Estimator, samples: list[SelectedRows]
    ) -> intervals.Ends:
        """Return the interval of a difference, with the error of jumps that replicates hide.

        Of the difference row by row where both results have the same ones: most jumps cancel.
        """
        (first, second), kept = self.rows, [sample.kept for sample in samples]
        influence = [estimator.influence(sample.numbers[sample.kept]) for sample in samples]
        dependence = [of[k] for of, k in zip(self._dependence, kept, strict=True)]
        if np.array_equal(kept[0], kept[1]) and all(
            np.array_equal(first.dataset[name].values, second.dataset[name].values)
            for name in ("replicate", "group", "block")
        ):
            influence, dependence = [influence[1] - influence[0]], dependence[:1]
        for of_rows, rows in zip(influence, dependence, strict=True):
            ends = widened_for_jumps(value, ends, of_rows, rows.neighbours, intervals.CONFIDENCE)
        return ends

    def _averaged(self, i: int, sample: SelectedRows) -> Estimate:
        """Return a mean of probabilities with the interval from which a difference is built."""
        return share_to_compare(sample.numbers[sample.kept], self._dependence[i][sample.kept])

    def _by_replicate(self, estimator: Estimator, i: int, sample: SelectedRows) -> Floats:
        labels, count = self._dependence[i].labels, int(self.rows[i].dataset.attrs["replicates"])
        assert labels is not None, "independent rows have no replicates"
        estimates = np.full(count, np.nan)
        for r in range(count):
            values = sample.numbers[sample.kept & (labels == r)]
            if len(values):
                estimates[r] = estimator.of(values)
        return estimates


def _influence(estimator: Estimator, sample: SelectedRows) -> SelectedRows:
    """Return the influence of each row, 0 of those that take no part."""
    influence = np.zeros(len(sample.numbers))
    if sample.kept.any():
        influence[sample.kept] = estimator.relative_influence(sample.numbers[sample.kept])
    return SelectedRows(sample.kept, influence)


def _envelope(first: Estimate, second: Estimate) -> Estimate:
    """Return an estimate with the interval that holds both; without one if either has none."""
    if not (first.has_interval and second.has_interval):
        return first if not first.has_interval else second
    low, high = min(first.low, second.low), max(first.high, second.high)
    return Estimate(first.value, low, high, first.reason)


def _contributions(estimator: Estimator, sample: SelectedRows, relative: bool) -> Floats:
    """Return the influence of each row on a moment, over the moment if `relative`."""
    numbers, kept = np.zeros(len(sample.numbers)), sample.numbers[sample.kept]
    numbers[sample.kept] = estimator.influence(kept) / (estimator.of(kept) if relative else 1.0)
    return numbers


def _students(estimator: Estimator, sample: SelectedRows, estimate: Estimate) -> Estimate:
    """Return a moment with Student's interval, from which the difference of paired rows is built.

    The interval of a single moment allows for outliers that its rows do not show; those of pairs
    are allowed for in the difference.
    """
    if not estimate.has_interval:
        return estimate
    low, high = intervals.scatter_interval(0.0, estimator.influence(sample.numbers[sample.kept]))
    if (
        estimator.is_scale and estimate.value > 0
    ):  # by the logarithm, so that both ends are positive
        low, high = estimate.value * np.expm1(np.array([low, high]) / estimate.value)
    return Estimate(estimate.value, estimate.value + float(low), estimate.value + float(high))


def _newcombe(sample: SelectedRows) -> Estimate:
    """Return a share with Wilson's interval, for Newcombe's interval of a difference.

    For few hits the interval of a single share is exact; the difference of two such intervals would
    be too wide.
    """
    hits = sample.numbers[sample.kept]
    return Estimate(float(hits.mean()), *intervals.wilson_interval(hits.mean(), len(hits)))


def _factor(value: float, above: Floats, below: Floats) -> Estimate:
    """Return a ratio with the interval from the logarithms of the replicates' ratios."""
    if not (value > 0 and (above > 0).all() and (below > 0).all()):  # nor where one is unknown
        return Estimate(value)
    ends = intervals.scatter_interval(float(np.log(value)), np.log(above / below))
    return Estimate(value, *np.exp(ends).tolist())
