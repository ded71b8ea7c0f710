"""Value of the next inspection: expected reduction of the shared standard deviation."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import inf, nan

import numpy as np

from uq.contract import Floats
from uq.errors import InputError, choices
from uq.learning.inspections import Inspection, InspectionKind
from uq.learning.observables import Observable, observable_of, observables_of
from uq.learning.remaining_life import check_times
from uq.result.elements import Element
from uq.result.nesting import Nesting
from uq.result.result import AnyResult, Result
from uq.result.weights import OF_UNIT
from uq.text.numbers import number, percent
from uq.text.units import beside

_ANY = 1e-300  # below every positive depth
_FEW, _MOST = 0.01, 0.5
"""Shares of rows without a determined depth: above, estimates are rough, or not given."""


@dataclass(frozen=True)
class InspectionValue:
    """Value of inspections of a number of units at given times.

    Attributes
    ----------
    life : str
        The life whose uncertainty is to be reduced.
    output : str
        The observable to inspect.
    spread : float
        Standard deviation of the logarithm of the life due to shared inputs, before inspection.
    narrowing : dict of (float or None, int) to float
        Time, number of units -> expected relative reduction of `spread`; NaN where the rows do not
        determine it.
    time_unit : str
        CF unit of the times.
    notes : list of str
        Which estimates are rough, and why.
    """

    life: str
    output: str
    spread: float
    narrowing: dict[tuple[float | None, int], float]
    time_unit: str
    notes: list[str]


def worth(
    result: AnyResult,
    output: str,
    times: Sequence[float] = (),
    units: Sequence[int] = (1,),
    cv: float = 0.1,
    life: str | None = None,
) -> InspectionValue:
    """Estimate the value of inspecting more units (preposterior, Bayes linear).

    Parameters
    ----------
    result : Result, xarray.Dataset or path
        A result, or a posterior, with several units in each sample.
    output : str
        Observable to inspect, named as in `uq.update`: for example ``depth[site=left]``, or a life.
    times : sequence of float, optional
        Inspection times, in the unit of the life; required for a depth, not allowed otherwise.
    units : sequence of int
        Numbers of additional units to inspect, at least 1 each.
    cv : float
        Coefficient of variation of the measurement.
    life : str, optional
        The life of interest; required if the study shows several.

    Returns
    -------
    InspectionValue

    Raises
    ------
    InputError
        When samples have a single unit, there is no such output or life, the output is negative
        in some rows, or more than half of the rows do not determine a depth by one of the times.

    Notes
    -----
    The reduction is 1 - sqrt(1 - R^2): it applies to the standard deviation between samples of the
    logarithm of the life, estimated by the best linear estimator from the mean of the measured
    logarithms [1]_. Variance components between samples are the covariances of sample means, less
    the contribution of the scatter between units.

    References
    ----------
    .. [1] M. Goldstein, D. Wooff, "Bayes Linear Statistics" (2007).
    """
    result = Result.of(result)
    if why := result.why_no_statistics:
        raise InputError(f"uq next-inspection: the rows of a '{result.design_name}' design {why}")
    if label := result.dataset.attrs.get(OF_UNIT):
        raise InputError(f"uq next-inspection: the rows are those of unit {label}, not of more")
    rows = result.independent
    rows = rows.take(rows.nesting.repeat == 0)  # a unit has one life
    place = rows.nesting
    if place.units < 2:
        raise InputError(
            "uq next-inspection: samples have a single unit: set [design] units = 2 or more"
        )
    check_times(times, "uq next-inspection")
    if wrong := [count for count in units if count < 1]:
        raise InputError(f"uq next-inspection: units = {wrong[0]}: must be 1 or more")
    if not 0 <= cv < inf:
        raise InputError(f"uq next-inspection: cv = {cv:g}: must be finite, and 0 or more")
    element = _the_life(rows, life)
    weights = rows.weights
    worth_of_rows = np.ones(len(element.values)) if weights is None else weights.weights
    target = _logarithm(np.where(element.censored, np.nan, element.values))
    observables, narrowing, notes = observables_of(rows), {}, list[str]()
    for time in times or (None,):
        observable = _observable(observables, output, time)
        notes += _rough(observable, time, worth_of_rows)
        truth = observable.truth(time, np.arange(len(target)), np.ones((len(target), 1)))[:, 0]
        if negative := np.mean(truth < 0):
            raise InputError(
                f"uq next-inspection: {output} is negative in {100 * negative:.2g} % of the rows: a"
                " coefficient of variation cannot describe the error of such a measurement"
            )
        seen = _logarithm(truth)
        between, within = _variance_components((target, seen), worth_of_rows, place)
        for count in units:
            narrowing[time, count] = _narrowing(between, within, count, float(np.log1p(cv**2)))
    spread = _variance_components((target, target), worth_of_rows, place)[0][0, 0]
    spread = max(spread, 0.0) ** 0.5
    return InspectionValue(element.name, output, spread, narrowing, observable.time_unit, notes)


def unit_of_time(result: Result, output: str) -> str:
    """Return the CF unit of the inspection time of an observable, or ""."""
    observable = observables_of(result.independent).get(output)
    return observable.time_unit if observable and observable.depths is not None else ""


def _observable(
    observables: Mapping[str, Observable], output: str, time: float | None
) -> Observable:
    """Return the observable to inspect."""
    if output in observables and observables[output].depths is None and time is not None:
        raise InputError(f"uq next-inspection: {output} is not a depth: leave out when")
    return observable_of(observables, Inspection("", output, InspectionKind.MEASURED, time, _ANY))


def _rough(observable: Observable, time: float | None, weights: Floats) -> Iterator[str]:
    """Yield a note if some rows do not determine a depth at a time; refuse if most do not."""
    if observable.depths is None or time is None:
        return
    everyone, last = np.arange(len(weights)), observable.depths.depths[-1]
    life_factor = np.ones((len(weights), 1))
    unknown = observable.truth(time, everyone, life_factor) > last
    unknown |= observable.open_depth(time, everyone, life_factor)
    share = float(np.average(unknown[:, 0], weights=weights))
    why = (
        f"by {beside(number(time), observable.time_unit)}, {percent(share)} of the rows have worn"
        f" beyond the last depth of the result, {last:g} {observable.unit}, or were censored before"
    )
    if share > _MOST:
        raise InputError(f"uq next-inspection: {why}")
    if share > _FEW:
        yield f"Rough: {why}; depths are continued straight."


def _variance_components(
    pair: tuple[Floats, Floats], weights: Floats, place: Nesting
) -> tuple[Floats, Floats]:
    """Return the covariance components between and within samples, each of shape (2, 2)."""
    kept = np.isfinite(pair[0]) & np.isfinite(pair[1])
    means = [place.means(np.where(kept, values, np.nan)) for values in pair]
    whole = np.isfinite(means[0])
    size = np.bincount(place.sample[kept], minlength=place.samples)[whole]
    worth = place.means(weights)[whole]
    inside = [
        values[kept] - mean[place.sample[kept]] for values, mean in zip(pair, means, strict=True)
    ]
    spare = max(int(kept.sum()) - int(whole.sum()), 1)
    within = np.array([[a @ b for b in inside] for a in inside]) / spare
    if whole.sum() <= 2:
        return np.full((2, 2), nan), within
    of_means = np.cov(np.stack([mean[whole] for mean in means]), aweights=worth)
    return of_means - within * np.average(1 / size, weights=worth), within


def _narrowing(between: Floats, within: Floats, units: int, error: float) -> float:
    """Return the expected relative reduction of the standard deviation of the life."""
    variance = between[1, 1] + (within[1, 1] + error) / units
    if not (between[0, 0] > 0 and variance > 0):
        return nan
    explained = min(between[0, 1] ** 2 / (between[0, 0] * variance), 1.0)
    return float(1 - (1 - explained) ** 0.5)


def _logarithm(values: Floats) -> Floats:
    with np.errstate(divide="ignore", invalid="ignore"):
        logarithm = np.log(values)
    return np.where(np.isfinite(logarithm), logarithm, np.nan)


def _the_life(rows: Result, life: str | None) -> Element:
    shown = rows.elements(rows.shown_outputs(rows.analysis))
    lives = rows.lifetimes(life) if life else [element for element in shown if element.is_lifetime]
    if len(lives) != 1:
        names = choices([element.name for element in lives])
        raise InputError(f"uq next-inspection: name one life with --life ({names})")
    return lives[0]
