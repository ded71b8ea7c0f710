"""When a run may stop: interim estimates at fixed sizes, with valid intervals.

An interval that is recomputed often enough is narrow by chance at some point. A run therefore
estimates at a few sizes fixed beforehand, each half of the next, and the interval at each of K
sizes has confidence 1 - 0.05/K: the chance that any of them misses is at most 5 %, whenever the
run stops.
"""

from typing import TYPE_CHECKING, NamedTuple

import numpy as np
import xarray as xr

from uq import intervals, order_statistics
from uq.estimate import NOTHING, Estimate
from uq.moments import moments
from uq.rows.elements import Element, independent_rows, named_elements, replicates_of
from uq.rows.nesting import first_samples

if TYPE_CHECKING:
    from uq.study.file import DesignTable, Until

_FIRST = 32  # samples at least of the first interim estimate


class InterimEstimate(NamedTuple):
    """An estimate during a run, which may end it.

    Attributes
    ----------
    estimate : Estimate
        Of the element with the widest interval, at the confidence of one interim estimate.
    reached : bool
        Whether every element has reached the required half-width.
    """

    estimate: Estimate
    reached: bool


def interim_sizes(design: "DesignTable") -> tuple[int, ...]:
    """Return the numbers of samples at which a run estimates; the last is all of them."""
    size = design.samples
    sizes = [size]
    while (size := -(-size // 2)) >= _FIRST:
        sizes.append(size)
    return tuple(reversed(sizes))


def confidence(design: "DesignTable") -> float:
    """Return the confidence of one interim interval (Bonferroni)."""
    return 1 - (1 - intervals.CONFIDENCE) / len(interim_sizes(design))


def interim_estimate(design: "DesignTable", ds: xr.Dataset) -> InterimEstimate:
    """Estimate from the rows of a run so far.

    Parameters
    ----------
    design : DesignTable
        With `until`.
    ds : xarray.Dataset
        Its rows.

    Returns
    -------
    InterimEstimate
    """
    until = design.until
    assert until is not None
    rows = independent_rows(ds)
    replicate = replicates_of(rows)
    seen = [
        _estimate(element, until, replicate, confidence(design))
        for element in named_elements(rows, until.output)
    ]
    halves = [(one.high - one.low) / 2 for one in seen]
    worst = int(np.argmax(np.nan_to_num(halves, nan=np.inf)))
    return InterimEstimate(seen[worst], bool(halves[worst] <= until.half_width))


def ended(design: "DesignTable", ds: xr.Dataset) -> bool:
    """Whether a run ends at this result although its budget is not spent."""
    size = _latest(design, ds)
    return size > 0 and interim_estimate(design, first_samples(ds, size)).reached


def _latest(design: "DesignTable", ds: xr.Dataset) -> int:
    """Return the size of the last interim estimate, 0 before the first or without `until`.

    The result may be larger, if it was extended.
    """
    if design.until is None:
        return 0
    return max((size for size in interim_sizes(design) if size <= ds.attrs["samples"]), default=0)


def sentence(design: "DesignTable", ds: xr.Dataset) -> str:
    """State why a run ended, and the estimate at that point."""
    until, samples = design.until, int(ds.attrs["samples"])
    assert until is not None
    size = _latest(design, ds)
    seen = interim_estimate(design, first_samples(ds, size))
    what = f"{until.estimate} of {until.output}"
    known = "{:.6g}, {:.6g} to {:.6g}".format(*seen.estimate.numbers)
    if np.isnan(seen.estimate.low) and np.isnan(seen.estimate.high):
        return f"the budget of {samples} samples is spent, and {what} has no interval"
    elements = named_elements(independent_rows(ds), until.output)
    if lost := max(int(element.failed.sum()) for element in elements):
        known += f" (without {lost} failed rows)"
    if not seen.reached:
        return (
            f"the budget of {samples} samples is spent: {what} is {known}; the required half-width"
            f" of {until.half_width:g} was not reached"
        )
    number = 1 + interim_sizes(design).index(size)
    first = "" if size == samples else f" with the first {size} of {samples} samples"
    return (
        f"{what} is {known}: the required half-width of {until.half_width:g} was reached at interim"
        f" estimate {number} of at most {len(interim_sizes(design))}{first}. The confidence of"
        f" {confidence(design):.2%} at each makes this a 95 % interval for a run that stops so;"
        " all other intervals assume a number of rows fixed beforehand"
    )


def _estimate(
    element: Element, until: "Until", replicate: intervals.Replicates, level: float
) -> Estimate:
    kept = ~element.failed
    if until.threshold is not None:
        values = element.for_thresholds
        if element.unknown_sides(until.threshold).any():
            return NOTHING
        hits = values > until.threshold if until.above is not None else values < until.threshold
        within = intervals.replicates_of_some(replicate, kept)
        value = hits[kept].mean() if kept.any() else np.nan
        return Estimate(float(value), *intervals.share_interval(hits[kept], within, level))
    within = intervals.replicates_of_some(replicate, element.present)
    values = element.at_most
    if until.quantile is not None:
        value = order_statistics.quantile(values, until.quantile)
        ends = order_statistics.quantile_interval(values, until.quantile, within, level)
        return Estimate(value, *ends)
    if not len(values) or not np.isfinite(values).all():
        return NOTHING
    return moments(values, within, level).mean
