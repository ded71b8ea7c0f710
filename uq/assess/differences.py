"""Differences between the statistics of two results."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import chain
from math import isnan

from uq.assess.estimators import SelectedRows, in_categories, whole
from uq.assess.pairing import Pair
from uq.assess.statistic import Reader, Statistic
from uq.assess.summary import REGIME, Shares, Summary
from uq.contract import Output
from uq.result.element import Element
from uq.stats import two_samples
from uq.stats.estimate import NOTHING, Estimate


@dataclass(frozen=True)
class ComparedStatistic:
    """A statistic of two results.

    Attributes
    ----------
    first, second : Statistic
    difference : Estimate
        The second less the first.
    identical : bool
        Whether the rows are paired and both rows of each pair agree: then there is no interval.
    no_row_changes_sides : bool
        Whether the rows are paired and differ, but none is a hit in one result alone.
    ratio : Estimate, optional
        The second over the first, for a scale.
    """

    first: Statistic
    second: Statistic
    difference: Estimate
    identical: bool = False
    no_row_changes_sides: bool = False
    ratio: Estimate | None = None


@dataclass(frozen=True)
class ComparedOutput:
    """An element of an output: name in the table of statistics -> what is compared of it."""

    declared: Output
    parts: Mapping[str, tuple[ComparedStatistic, ...]]

    @property
    def units(self) -> str:
        """CF unit string."""
        return self.declared.unit

    @property
    def statistics(self) -> tuple[ComparedStatistic, ...]:
        """All of them in order."""
        return tuple(chain.from_iterable(self.parts.values()))


def compared_shares(
    pair: Pair, summaries: list[Summary]
) -> dict[str, dict[str, ComparedStatistic]]:
    """Return category -> label -> what is compared: all regimes, else what occurs."""
    names = [name for name in summaries[0].shares if name in summaries[1].shares]
    return {
        name: dict(_shares(pair, [summary.shares[name] for summary in summaries], name))
        for name in names
    }


def _shares(pair: Pair, shares: list[Shares], name: str) -> Iterator[tuple[str, ComparedStatistic]]:
    members = [in_categories(rows, name) for rows in pair.rows]
    for label in shares[0]:
        both = [of_labels[label] for of_labels in shares if label in of_labels]
        occurs = name == REGIME or any(statistic.facts["count"] for statistic in both)
        if len(both) > 1 and occurs:
            samples = [members_of_side[label] for members_of_side in members]
            yield label, _compared(pair, both, samples, pair.have_equal_outputs)


def compared_output(
    pair: Pair, elements: list[Element], summaries: list[Summary]
) -> ComparedOutput:
    """Compare all statistics of the same element of two results."""
    described = [summary.outputs[elements[0].name] for summary in summaries]
    parts = {
        name: tuple(
            _of_elements(pair, elements, [statistic, other])
            for statistic in statistics
            if statistic.is_read_by(Reader.COMPARED)
            and (other := described[1].find(*statistic.key)) is not None
        )
        for name, statistics in described[0].parts.items()
    }
    return ComparedOutput(elements[0].declared, parts)


def _of_elements(pair: Pair, elements: list[Element], both: list[Statistic]) -> ComparedStatistic:
    """Compare a statistic of the same element of two results."""
    estimator = both[0].estimator
    samples = [] if estimator is None else [estimator.sample(element) for element in elements]
    present = [sample for sample in samples if sample is not None]
    are_equal = pair.are_equal([whole(element) for element in elements])
    return _compared(pair, [statistic.best for statistic in both], present, are_equal)


def _compared(
    pair: Pair, both: list[Statistic], samples: list[SelectedRows], are_equal: bool
) -> ComparedStatistic:
    """Compare two statistics of paired rows that are equal in both results, or of others."""
    estimator = both[0].estimator
    is_scale = estimator is not None and estimator.is_scale
    estimates = [statistic.estimate.finite for statistic in both]
    if any(isnan(estimate.value) for estimate in estimates):
        return ComparedStatistic(both[0], both[1], NOTHING, ratio=NOTHING if is_scale else None)
    if are_equal:
        ratio = Estimate(1.0) if is_scale else None
        return ComparedStatistic(both[0], both[1], Estimate(0.0), identical=True, ratio=ratio)
    if estimator is not None and estimator.counts_hits and pair.are_equal(samples):
        most = pair.most_that_change_sides(samples[0])
        apart = Estimate(0.0, -most, most)
        return ComparedStatistic(both[0], both[1], apart, no_row_changes_sides=True)
    if estimator is None or any(statistic.estimate.assumes for statistic in both):
        apart = two_samples.difference(estimates[0], estimates[1], pair.unpaired)
    else:
        apart = pair.difference(estimator, samples, estimates)
    times = pair.ratio(samples, estimates) if is_scale else None
    if any(
        estimate.reason for estimate in estimates
    ):  # without an interval its difference has none
        apart, times = Estimate(apart.value), times and Estimate(times.value)
    return ComparedStatistic(both[0], both[1], apart.finite, ratio=times and times.finite)
