"""Status of a run that may stop: its reason to end, or its distance from the goal."""

from math import inf, isfinite, isnan
from typing import TYPE_CHECKING

from uq.assess.stopping import InterimEstimate, confidence, interim_estimate, interim_sizes
from uq.result.result import Result
from uq.stats.estimate import Estimate
from uq.stats.estimate_text import rounded_text
from uq.stats.weighted_means import EXACT
from uq.text.numbers import in_unit, rows_in_words, threshold
from uq.text.quantities import Written
from uq.text.units import ReadableUnit, beside, unit_of

if TYPE_CHECKING:
    from uq.study.file import DesignTable

HOPELESS = 4.0
"""So many times the budget is out of reach; a width is known to a factor of two."""


def why_ended(design: "DesignTable", result: Result) -> str:
    """State why a run ended, and the estimate at that point.

    Parameters
    ----------
    design : DesignTable
        With `until`.
    result : Result
        Its result.
    """
    until, samples = design.until, int(result.dataset.attrs["samples"])
    assert until is not None
    size, seen = _stop(design, result)
    estimate, unit = seen.estimate, unit_of(seen.units, seen.estimate.value)
    if _has_none(seen):
        return f"the budget of {samples} samples is spent: {_without_interval(seen)}"
    stated = f"{seen.what} {_in_words(estimate, unit)}"
    if seen.lost:
        stated += f" (without {seen.lost})"
    wanted = _wanted(until.half_width, unit)
    if not seen.reached:
        needed = _needed(seen, samples)
        more = f": by the scatter of all rows it needs about {needed} samples" * bool(needed)
        spent = f"the budget of {samples} samples is spent: {stated}"
        return f"{spent}; the {wanted} was not reached{more}"
    sizes = interim_sizes(design)
    first = "" if size == samples else f" with the first {size} of {samples} samples"
    return (
        f"{stated}: the {wanted} was reached at interim estimate {1 + sizes.index(size)} of at most"
        f" {len(sizes)}{first}. The confidence of {confidence(design):.2%} at each makes this a"
        " 95 % interval for a run that stops so; all other intervals assume a number of rows fixed"
        " beforehand"
    )


def out_of_reach(design: "DesignTable", seen: InterimEstimate, samples: int) -> str:
    """State that a run will probably spend its budget in vain; "" where it may stop before.

    Parameters
    ----------
    design : DesignTable
        With `until`.
    seen : InterimEstimate
        Interim estimate of a run that goes on.
    samples : int
        Of each replicate, so far.
    """
    assert design.until is not None
    began = f"after {samples} samples"
    if _has_none(seen) or seen.estimate.value == inf:
        rest = f"while that is so the run goes on, to its budget of {design.samples} samples"
        return f"{began} {_without_interval(seen)}; {rest}"
    if not isfinite(seen.half_width) or seen.rows_factor * samples <= HOPELESS * design.samples:
        return ""
    unit = unit_of(seen.units, seen.estimate.value)
    return (
        f"{began} {seen.what} {_in_words(seen.estimate, unit)}: by the scatter so far, the"
        f" {_wanted(design.until.half_width, unit)} needs about {_needed(seen, samples)} samples,"
        f" more than the budget of {design.samples}, which this run will spend"
    )


def _has_none(seen: InterimEstimate) -> bool:
    """Whether an estimate has no end of an interval, and is not exact either."""
    estimate = seen.estimate
    return isnan(estimate.low) and isnan(estimate.high) and estimate.reason != EXACT


def _without_interval(seen: InterimEstimate) -> str:
    """State that an estimate has no interval that can become narrow, and why."""
    estimate = seen.estimate
    if estimate.value == inf:
        return f"{seen.what} is {rounded_text(estimate)[0]}, which no interval narrows"
    value = f"is {in_unit(estimate.value, unit_of(seen.units, estimate.value))} and "
    why = f" ({estimate.reason})" * bool(estimate.reason)
    return f"{seen.what} {value * isfinite(estimate.value)}has no interval{why}"


def _needed(seen: InterimEstimate, samples: int) -> str:
    """Return the samples that reach the goal if intervals narrow as one over root n."""
    return rows_in_words(seen.rows_factor * samples) if isfinite(seen.rows_factor) else ""


def _wanted(half_width: float, unit: ReadableUnit) -> str:
    """Return the goal, as written or in the unit of the estimate."""
    written = isinstance(half_width, Written)
    text = threshold(half_width, unit.name) if written else in_unit(half_width, unit)
    return f"required half-width of {text}"


def _stop(design: "DesignTable", result: Result) -> tuple[int, InterimEstimate]:
    """Return the size at which the run may end, the last where it may not, and the estimate."""
    sizes = [size for size in interim_sizes(design) if size <= result.dataset.attrs["samples"]]
    for size in sizes or [0]:
        seen = interim_estimate(design, result.first_samples(size))
        if seen.reached:
            break
    return size, seen


def _in_words(estimate: Estimate, unit: ReadableUnit) -> str:
    if isnan(estimate.value):
        sides = {"at least": estimate.low, "at most": estimate.high}
        ends = [f", {side} {in_unit(end, unit)}" for side, end in sides.items() if isfinite(end)]
        return "".join(["is not known", *ends])
    value, both = rounded_text(estimate, unit.size)
    return f"is {value}, {beside(both, unit.name)}" if both else f"is {value}"
