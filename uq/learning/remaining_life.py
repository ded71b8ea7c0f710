"""Remaining lives of units still running and of units never inspected."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import inf

import numpy as np

from uq.assess.integrated_inputs import elements_with_laws, inputs_of
from uq.assess.scale_laws import ConditionalLaw
from uq.assess.weighted_mixture import WeightedMixture
from uq.contract import Floats, Output
from uq.errors import InputError, choices
from uq.learning.inspections import Inspection, InspectionKind
from uq.learning.integrated_input import free_scales
from uq.learning.observables import Observable, observed
from uq.learning.posterior_inputs import quantiles
from uq.learning.posterior_result import as_unit, inspections_of, prior_of
from uq.result.elements import Element
from uq.result.result import Result
from uq.result.weights import INSPECTED, INTEGRATED, ONLY_INSPECTED, WEIGHT, WORLDS
from uq.sampling.levels import SHARED
from uq.stats.dependent_rows import Dependence
from uq.stats.estimate import Estimate
from uq.stats.importance_weights import effective_rows
from uq.text.quantities import read_threshold

ENDS = (0.025, 0.975)

PROBABILITIES = (0.05, 0.5, 0.95)
ANY = ""
"""Label of units never inspected."""

_GONE = "hardly any row agrees with its inspections and still runs"
_LEAST = 1e-3


def over_shared(result: Result, element: Element, seen: float, time: float) -> dict[float, float]:
    """Return the 95 % band of P(T < time | T > `seen`) over the shared inputs, for a new unit.

    Parameters
    ----------
    result : Result
        A result of `uq.update`.
    element : Element
        A life of its rows.
    seen, time : float
        In the unit of the life.

    Returns
    -------
    dict of float to float
        Probability -> quantile over the shared inputs. Empty unless one integrated input is shared,
        scales this life, and no row is censored too early: only then is the probability at each of
        its values free of the sampling noise of a few units.
    """
    name = result.dataset.attrs[INTEGRATED]
    if not name or result.dataset.attrs[WORLDS] > 1 or result.levels[name] != SHARED:
        return {}
    exponent = free_scales(inputs_of(result), element.declared).get(name)
    if exponent is None:
        return {}
    shared, weights = result.dataset[name].values, result.dataset[WEIGHT].values
    life_factor = shared**exponent
    latest = time * life_factor / life_factor.min()
    if (element.censored & (element.values < latest)).any():
        return {}
    present = element.present
    lives = element.values[present] / life_factor[present]  # with a shared input of 1
    before, by = (_below(lives, weights[present], at / life_factor) for at in (seen, time))
    with np.errstate(divide="ignore", invalid="ignore"):
        ended = (by - before) / (1 - before)
    runs = before < 1
    return quantiles(ended[runs], weights[runs] * (1 - before[runs]), ENDS)


def _below(values: Floats, weights: Floats, at: Floats) -> Floats:
    """Return the weighted empirical distribution function of `values` at other values."""
    order = np.argsort(values)
    share = np.append(0.0, np.cumsum(weights[order]) / weights.sum())
    return np.asarray(share[np.searchsorted(values[order], at, side="left")])


def shown_lives(result: Result) -> Iterator[tuple[str, Output]]:
    """Yield the shown lives that end in failure, not in success."""
    declared = result.outputs
    for name in result.shown_outputs(result.analysis):
        if declared[name].is_lifetime and not declared[name].success:
            yield name, declared[name]


def read_times(option: str, texts: Sequence[str], result: Result) -> list[float]:
    """Parse times from a command-line option, with or without a unit.

    Parameters
    ----------
    option : str
        Such as ``--by``.
    texts : sequence of str
    result : Result
        The result whose lives the times refer to.

    Raises
    ------
    InputError
        When a time is invalid, its unit does not fit, or lives have different units.
    """
    if not texts:
        return []
    units = list({output.unit: None for _, output in shown_lives(result)})
    if len(units) != 1:
        problem = f"lives are in several units ({choices(units)})" if units else "no life is shown"
        raise InputError(f"{option} {texts[0]}: {problem}; name one life in [analysis] outputs")
    times = [read_threshold(option, text, "a life", units[0]) for text in texts]
    check_times(times, option)
    return times


def check_times(times: Sequence[float], asked_by: str) -> None:
    """Refuse times that are negative or not finite."""
    if wrong := [time for time in times if not 0 <= time < inf]:
        raise InputError(f"{asked_by}: time = {wrong[0]:g}: must be finite, and 0 or more")


@dataclass(frozen=True)
class Remaining:
    """Remaining life of a unit, conditional on survival until now.

    Attributes
    ----------
    unit : str
        Its label; `ANY` for units never inspected.
    output : str
        Which life.
    units : str
        CF unit of that life and of all times here.
    seen : float
        Time when it was last seen running; for units never inspected, of the latest inspection.
    runs : Estimate
        Posterior probability that the unit survives this time.
    life : dict of float to Estimate
        Probability -> quantile of the remaining life, counted from `seen`.
    by : dict of float to Estimate
        Time since the start of the life -> probability of failure by then.
    effective_rows : float
    over_shared : dict of float to dict of float to float
        For units never inspected: time -> 2.5 and 97.5 % quantiles of that probability over the
        shared inputs (`over_shared`).
    """

    unit: str
    output: str
    units: str
    seen: float
    runs: Estimate
    life: dict[float, Estimate]
    by: dict[float, Estimate]
    effective_rows: float
    over_shared: dict[float, dict[float, float]] = field(default_factory=dict)


def remaining(result: Result, by: Sequence[float] = ()) -> Iterator[Remaining]:
    """Yield the remaining lives of units not observed to have failed.

    Parameters
    ----------
    result : Result
        A result of `uq.update`.
    by : sequence of float
        Times from the beginning of the life, in its unit; by default the thresholds of the study.

    Raises
    ------
    InputError
        When a time is negative or not finite.
    """
    check_times(by, "by")
    observables = observed(prior_of(result), inspections_of(result))
    units = {inspection: observable.time_unit for inspection, observable in observables.items()}
    if ONLY_INSPECTED not in result.dataset.attrs:
        yield from _of_unit(result, ANY, _last_seen(units), by)
    for label in map(str, result.dataset[INSPECTED].values):
        inspected = {
            inspection: unit for inspection, unit in units.items() if inspection.unit == label
        }
        if not any(_has_ended(inspection, observables[inspection]) for inspection in inspected):
            yield from _of_unit(Result(as_unit(result, label)), label, _last_seen(inspected), by)


def _has_ended(inspection: Inspection, observable: Observable) -> bool:
    """Return whether an inspection states the end of a life, or its value."""
    is_measured = inspection.kind is InspectionKind.MEASURED
    return inspection.kind is InspectionKind.ENDED or (
        is_measured and observable.declared.is_lifetime
    )


def _last_seen(units: Mapping[Inspection, str]) -> dict[str, float]:
    """Return the latest time of an inspection, by unit of time."""
    latest: dict[str, float] = {}
    for inspection, unit in units.items():
        if inspection.time is not None:
            latest[unit] = max(inspection.time, latest.get(unit, 0.0))
    return latest


def _of_unit(
    rows: Result, label: str, last_seen: Mapping[str, float], by: Sequence[float]
) -> Iterator[Remaining]:
    thresholds = rows.analysis.thresholds
    counted = rows.dataset[WEIGHT].values > 0
    dependence = rows.dependence[counted]
    rows = rows.take(counted)
    for element in elements_with_laws(rows, [name for name, _ in shown_lives(rows)]):
        seen = last_seen.get(element.units, 0.0)
        times = [*by] or [t for t in thresholds.get(element.output, ()) if t > seen]
        life = _of_life(element, dependence, label, seen, times)
        later = [time for time in life.by if time > seen and label == ANY]
        ranges = {time: over_shared(rows, element, seen, time) for time in later}
        yield replace(life, over_shared={t: interval for t, interval in ranges.items() if interval})


def _of_life(
    element: Element, dependence: Dependence, label: str, seen: float, times: Sequence[float]
) -> Remaining:
    runs = WeightedMixture(element, dependence).outliving(seen) if seen > 0 else Estimate(1.0)
    assert element.weights is not None
    alive = np.where(element.censored & (element.values <= seen), 0.0, element.above(seen))
    weights, still = element.weights * alive, alive > 0
    nothing = Remaining(label, element.name, element.units, seen, runs, {}, {}, 0.0)
    share = float(weights.sum() / element.weights.sum())
    if not share > _LEAST:
        return replace(nothing, runs=Estimate(runs.value, reason=_GONE))
    running = replace(
        element,
        values=np.where(still, element.values, np.nan),
        censored=element.censored & still,
        failed=~still,
        law=None if element.law is None else ConditionalLaw(element.law, element.below(seen), seen),
        weights=weights,
        most=element.most * still.mean() / share,
    )
    survivors = WeightedMixture(running, dependence)
    return replace(
        nothing,
        life={p: _after(seen, survivors.quantile(p)) for p in PROBABILITIES},
        by={time: survivors.below(time) if time > seen else Estimate(0.0) for time in times},
        effective_rows=effective_rows(dependence[still].sums_of_samples(weights[still])),
    )


def _after(seen: float, life: Estimate) -> Estimate:
    """Return the estimate of a remaining life from the estimate of the life."""
    ends = {name: max(getattr(life, name) - seen, 0.0) for name in ("value", "low", "high")}
    return replace(life, **ends)
