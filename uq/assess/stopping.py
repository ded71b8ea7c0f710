"""When a run with `until` stops: interim estimates at fixed sizes, with valid intervals.

An interval that is recomputed often enough is narrow by chance at some point. A run therefore
estimates at a few sizes fixed beforehand, each half of the next, at a confidence that makes up for
it (`uq.stats.group_sequential`).
"""

from collections.abc import Iterator
from dataclasses import replace
from math import inf, isfinite, isnan
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from uq.assess.chosen_targets import wholes
from uq.assess.design_sample import sample_of
from uq.assess.integrated_inputs import elements_with_laws
from uq.assess.sensitivities import indices_of_target
from uq.assess.targets import IndexTarget, number_of, transformed_if_heavy
from uq.assess.weighted_mixture import as_sample
from uq.indices.methods import METHODS, kinds_with_intervals
from uq.result.element import Element
from uq.result.result import Result
from uq.sampling.designs import DESIGNS, PATHS
from uq.stats import group_sequential
from uq.stats.dependent_rows import Dependence
from uq.stats.estimate import NOTHING, Estimate, rounded_text
from uq.stats.moments import corrected_mean_interval
from uq.stats.weighted_means import EXACT
from uq.text.element_names import is_whole
from uq.text.numbers import counted, grouped, in_unit, rows_in_words, threshold
from uq.text.quantities import Written
from uq.text.units import ReadableUnit, beside, unit_of

if TYPE_CHECKING:
    from uq.study.file import DesignTable, Until


_FIRST = 200  # samples at least of the first interim estimate
_FIRST_OF_REPLICATES = 32


class InterimEstimate(NamedTuple):
    """An estimate during a run, which may end it.

    Attributes
    ----------
    what : str
        The element, or the index, with the widest interval.
    estimate : Estimate
        At the confidence of one interim estimate.
    required : float
        Half-width.
    lost : str
        How many rows, or groups of rows, lack a value; "" if none.
    units : str
        CF unit of the estimate.
    """

    what: str
    estimate: Estimate
    required: float
    lost: str
    units: str = "1"

    @property
    def half_width(self) -> float:
        """Half the width of the interval; infinite without one, 0 where the estimate is exact."""
        if self.estimate.reason == EXACT:
            return 0.0
        half = (self.estimate.high - self.estimate.low) / 2
        return inf if isnan(half) else half

    @property
    def rows_factor(self) -> float:
        """Return the sufficient factor on the sample size; intervals narrow as one over root n."""
        return (self.half_width / self.required) ** 2

    @property
    def reached(self) -> bool:
        """Return whether the widest interval is narrow enough for the run to end."""
        return self.half_width <= self.required


def interim_sizes(design: "DesignTable") -> tuple[int, ...]:
    """Return the numbers of samples at which a run estimates; the last is all of them."""
    size = design.samples
    sizes = [size]
    # Where samples are independent, those of all replicates count.
    all_first = -(-_FIRST // design.replicates)
    first = _FIRST_OF_REPLICATES if _rests_on_replicates(design) else all_first
    while (size := -(-size // 2)) >= first:
        sizes.append(size)
    return tuple(reversed(sizes))


def confidence(design: "DesignTable") -> float:
    """Return the confidence of one interim interval."""
    checks = len(interim_sizes(design))
    if _rests_on_replicates(design):
        return group_sequential.of_replicates(design.replicates, checks)
    return group_sequential.of_independent_rows(checks)


def _rests_on_replicates(design: "DesignTable") -> bool:
    """Return whether the interval comes from the scatter of replicates."""
    paths = DESIGNS[design.method].layout is PATHS and design.until and design.until.index
    return not (design.has_independent_samples or paths)


def interim_estimate(design: "DesignTable", result: Result) -> InterimEstimate:
    """Estimate from the rows of a run so far.

    Parameters
    ----------
    design : DesignTable
        With `until`.
    result : Result
        Its rows.

    Returns
    -------
    InterimEstimate
        That with the widest interval, of the elements and inputs that the study means.
    """
    assert design.until is not None
    estimates = _indices if design.until.index else _statistics
    widest = max(estimates(design, result), key=lambda estimate: estimate.half_width)
    return widest._replace(estimate=_explained(widest.estimate, design))


def _explained(estimate: Estimate, design: "DesignTable") -> Estimate:
    """Return an estimate with the reason if it has no interval because nothing scatters."""
    if estimate.reason or not (
        isfinite(estimate.value) and isnan(estimate.low) and isnan(estimate.high)
    ):
        return estimate
    if _rests_on_replicates(design):
        part = "replicate"
    else:
        part = "path" if DESIGNS[design.method].layout is PATHS else "row"
    return replace(estimate, reason=f"the same in each {part}")


def ended(design: "DesignTable", result: Result) -> bool:
    """Return whether a run ends at this result although its budget is not spent."""
    sizes = [] if design.until is None else _sizes_so_far(design, result)
    return bool(sizes) and interim_estimate(design, result.first_samples(sizes[-1])).reached


def _sizes_so_far(design: "DesignTable", result: Result) -> list[int]:
    """Return the sizes of the interim estimates up to now, ascending; none before the first.

    The result may be larger than the last, if it was extended.
    """
    return [size for size in interim_sizes(design) if size <= result.dataset.attrs["samples"]]


def _statistics(design: "DesignTable", result: Result) -> Iterator[InterimEstimate]:
    """Yield the estimate of each element, as a summary has it."""
    until, level = design.until, confidence(design)
    assert until is not None
    rows = result.independent
    names = {element.name for element in rows.named_elements(until.output)}
    for element in elements_with_laws(rows, [until.output.partition("[")[0]]):
        if element.name in names:
            estimate = statistic(element, until, rows.dependence, level)
            units = "1" if until.threshold is not None else element.units
            lost = _lost(element)
            what = f"{until.estimate} of {element.name}"
            yield InterimEstimate(what, estimate, until.half_width, lost, units)


def _lost(element: Element) -> str:
    """Return the number of failed and undefined rows of an element, in words."""
    failed, undefined = int(element.failed.sum()), int(element.undefined.sum())
    return " and ".join(
        [counted(failed, "invalid row")] * (failed > 0)
        + [counted(undefined, "undefined row")] * (undefined > 0)
    )


def statistic(element: Element, until: "Until", dependence: Dependence, level: float) -> Estimate:
    """Estimate the statistic that a study monitors, for an element of independent rows.

    Parameters
    ----------
    element : Element
    until : Until
        Not of an index.
    dependence : Dependence
    level : float
        Confidence of the interval.

    Returns
    -------
    Estimate
    """
    sample = as_sample(element, dependence, level)
    if until.threshold is not None:
        is_above = until.above is not None
        return (sample.probability_above if is_above else sample.probability_below)(until.threshold)
    if until.quantile is not None:
        return sample.quantile(until.quantile)
    if until.probability is not None:
        return sample.life_quantile(until.probability)
    if not np.isfinite(element.at_most).all():
        return Estimate(reason="some rows never end, or are censored")
    mean = sample.moments().mean
    if dependence.has_independent_parts or not mean.has_interval:
        return mean
    # A few replicates show little of the skewness of their means.
    low, high = corrected_mean_interval(element.at_least, dependence[element.present], level)
    return replace(mean, low=low, high=high)


def _indices(design: "DesignTable", result: Result) -> Iterator[InterimEstimate]:
    """Yield the index of each input, or the difference between two, as `uq sensitivity` has it.

    An input that has no effect in any row has no interval, and does not count beside others.
    """
    until = design.until
    assert until is not None and until.index is not None
    kind, method = kinds_with_intervals(DESIGNS[design.method])[until.index]
    sample = replace(sample_of(result), confidence=confidence(design), difference=until.difference)
    for target in _targets(result, until.output):
        target_sample = replace(sample, values=target.values)
        indices = indices_of_target(result, METHODS[method], target, target_sample)
        dropped = indices.groups_dropped
        lost = f"{counted(dropped, 'group')} with missing values" if dropped else ""
        values = indices.kinds().get(kind, {})
        label = until.label
        asked = {label: values.get(label, NOTHING)} if label else dict(values)
        alive = {
            name: estimate
            for name, estimate in asked.items()
            if estimate.value != 0 or estimate.has_interval
        }
        if not alive:
            why = indices.refused or "no row shows an effect"
            value = next((estimate.value for estimate in asked.values()), np.nan)
            alive = {label: Estimate(value, reason=why)}
        for name, estimate in alive.items():
            what = " ".join(filter(None, (until.index, name, "of", target.name)))
            yield InterimEstimate(what, estimate, until.half_width, lost)


def _targets(result: Result, output: str) -> Iterator[IndexTarget]:
    """Yield the targets with an index: each selected element, or all of them together."""
    elements = result.named_elements(output)
    if is_whole(output):
        yield next(wholes(elements))
    else:
        yield from (transformed_if_heavy(number_of(element)) for element in elements)


HOPELESS = 4.0
"""So many times the budget is out of reach; a width is known to a factor of two."""


def why_ended(design: "DesignTable", result: Result) -> tuple[str, str]:
    """State why a run ended, in a few words, and with the estimate at that point.

    Parameters
    ----------
    design : DesignTable
        With `until`.
    result : Result
        Its result.
    """
    assert design.until is not None
    samples, (size, seen) = int(result.dataset.attrs["samples"]), _stop(design, result)
    unit = unit_of(seen.units, seen.estimate.value)
    wanted = _wanted(design.until.half_width, unit)
    brief = f"{grouped(samples)} samples spent: {wanted} not reached"
    if seen.reached:
        brief = (
            f"ended at {grouped(samples)} of {grouped(design.samples)} samples: {wanted} reached"
        )
    return brief, _estimate_at_end(design, samples, size, seen)


def _estimate_at_end(design: "DesignTable", samples: int, size: int, seen: InterimEstimate) -> str:
    """State the estimate at the end of a run, and whether it was the goal that ended it."""
    assert design.until is not None
    if _has_none(seen):
        return f"the budget of {samples} samples is spent: {_without_interval(seen)}"
    unit = unit_of(seen.units, seen.estimate.value)
    stated = f"{seen.what} {_in_words(seen.estimate, unit)}"
    if seen.lost:
        stated += f" (without {seen.lost})"
    wanted = _wanted(design.until.half_width, unit)
    if not seen.reached:
        needed = _needed(seen, samples)
        more = f": from the scatter of all rows, about {needed} samples are required" * bool(needed)
        spent = f"the budget of {samples} samples is spent: {stated}"
        return f"{spent}; the {wanted} was not reached{more}"
    sizes = interim_sizes(design)
    first = "" if size == samples else f" with the first {size} of {samples} samples"
    return (
        f"{stated}: the {wanted} was reached at interim estimate {1 + sizes.index(size)} of at most"
        f" {len(sizes)}{first}. A confidence of {confidence(design):.2%} at each preserves an"
        " overall confidence of 95 % (group-sequential); all other intervals assume a fixed sample"
        " size"
    )


def out_of_reach(design: "DesignTable", seen: InterimEstimate, samples: int) -> str:
    """State that a run will probably exhaust its budget; "" if it may stop before.

    Parameters
    ----------
    design : DesignTable
        With `until`.
    seen : InterimEstimate
        Interim estimate of a run that continues.
    samples : int
        Of each replicate, so far.
    """
    assert design.until is not None
    began = f"after {samples} samples"
    if _has_none(seen) or seen.estimate.value == inf:
        rest = f"the run then continues up to its budget of {design.samples} samples"
        return f"{began} {_without_interval(seen)}; {rest}"
    if not isfinite(seen.half_width) or seen.rows_factor * samples <= HOPELESS * design.samples:
        return ""
    unit = unit_of(seen.units, seen.estimate.value)
    return (
        f"{began} {seen.what} {_in_words(seen.estimate, unit)}: from the scatter so far, the"
        f" {_wanted(design.until.half_width, unit)} needs about {_needed(seen, samples)} samples,"
        f" more than the budget of {design.samples}, which this run will spend"
    )


def _has_none(seen: InterimEstimate) -> bool:
    """Return whether an estimate lacks an end of its interval and is not exact either."""
    estimate = seen.estimate
    return isnan(estimate.low) and isnan(estimate.high) and estimate.reason != EXACT


def _without_interval(seen: InterimEstimate) -> str:
    """State that an estimate has no interval that can become narrow, and why."""
    estimate = seen.estimate
    if estimate.value == inf:
        return f"{seen.what} is {rounded_text(estimate)[0]}, which has no interval"
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
    for size in _sizes_so_far(design, result) or [0]:
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
