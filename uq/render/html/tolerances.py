"""Other tolerances: weights of rows at each stop of a slider, and the estimates there."""

import shlex
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import partial
from math import isfinite, isnan, nan
from types import MappingProxyType
from typing import Any

import numpy as np

from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.answer.wording import called, unit_of_input
from uq.assess.integrated_inputs import elements_with_laws
from uq.assess.row_inputs import Inputs, inputs_of
from uq.assess.statistic import Context, Statistic
from uq.assess.statistics.quantiles import quantiles, thresholds
from uq.assess.what_if import weighting_of
from uq.errors import InputError, RunError
from uq.render.figures.words import meaning_of, symbol_beside
from uq.render.html.embedded_columns import IMPOSSIBLE, log_bytes, parts_of
from uq.render.html.moved_laws import Arguments, can_move, shifts, widths
from uq.result.element import Element
from uq.result.result import Result
from uq.sampling.law import Law
from uq.sampling.listed_values import IntegerRange
from uq.stats.estimate import Estimate
from uq.study.file import AnalysisTable
from uq.text.literals import plain, toml
from uq.text.numbers import capitalized, grouped, percent, percent_interval, printed
from uq.text.units import beside, readable

LISTED = "its values are listed and have neither width nor place"

FEWEST = 100
"""Minimum effective sample size for which a page shows numbers for combined changes."""

Statistics = Mapping[tuple[str, ...], Statistic]
"""Element name and key of a statistic -> statistic."""


def tolerances(
    rows: Result, elements: Sequence[Element], tolerance_bounds: Mapping[str, ToleranceBound]
) -> dict[str, Any] | None:
    """Return the sliders of inputs, with weights and estimates at each stop.

    Parameters
    ----------
    rows : Result
        Rows embedded in the page.
    elements : sequence of Element
        Of these rows.
    tolerance_bounds : dict of str to ToleranceBound
        Tolerance bounds of elements.

    Returns
    -------
    dict or None
        None if no input has a slider.
    """
    if rows.design.imported:
        return None
    inputs = inputs_of(rows)
    without = {name: why for name in inputs.laws if (why := _why_without(name, inputs))}
    context = Context(rows, _analysis(rows, elements, tolerance_bounds))
    outputs = rows.shown_outputs(context.analysis)
    studied = _statistics(elements_with_laws(rows, outputs), context, tolerance_bounds)
    count, parts_name = _independent(rows)

    def estimates(law_name: str, arguments: Arguments) -> dict[str, Any] | None:
        """Return weights and estimates for other arguments of a law; None if these are invalid."""
        changes = {f"uncertain.{law_name}.{key}": value for key, value in arguments.items()}
        options = (f"--set {shlex.quote(f'{key}={toml(value)}')}" for key, value in changes.items())
        stop = {"options": " ".join(options)}
        try:
            weighting = weighting_of(rows, changes, inputs)
            then = _statistics(weighting.elements(outputs), context, tolerance_bounds)
            weighting.refuse_if_unused()
        except RunError as refusal:
            return stop | {"quality": plain(printed(f"{capitalized(str(refusal))}."))}
        except InputError:
            return None
        weights = weighting.all_inputs
        embedded = {} if weights.refusal else {"weights": log_bytes(weights.weights)}
        bounds = {
            name: _bounds_then(then, studied, name, tolerance_bounds[name])
            for name in tolerance_bounds
        }
        refused = {name: weights.refusal for name, weights in weighting.refused.items()}
        return (
            stop
            | embedded
            | {"quality": _quality(*weighting.quality, count, parts_name)}
            | {"events": _events(then, elements, context, refused), "promised": bounds}
        )

    sliders = [
        slider
        for name, law in inputs.laws.items()
        if name not in without and (slider := _slider(rows, name, law, partial(estimates, name)))
    ]
    if not sliders:
        return None
    return {
        "sliders": sliders,
        "without": [[plain(readable(called(name))), why] for name, why in without.items()],
        "correlated": list(inputs.correlated),
        "studied": {
            "quality": "The laws of the study.",
            "events": _events(studied, elements, context),
            "promised": {name: _bounds_now(bound) for name, bound in tolerance_bounds.items()},
        },
        "fewest": FEWEST,
        "parts": count,
        "partsName": parts_name,
        "impossible": IMPOSSIBLE,
    }


def _why_without(name: str, inputs: Inputs) -> str:
    """Return the reason why an input has no slider, or ""."""
    law = inputs.laws[name]
    if not can_move(law):
        return LISTED
    if isinstance(law, IntegerRange) and law.upper - law.lower < 2:
        return "it has two values only"
    if 0 in getattr(law, "counts", ()):
        return "its histogram has empty bins, in which there are no rows"
    if name in inputs.correlated:
        for other in inputs.correlated:
            if inputs.laws[other].discrete:
                return f"it depends on listed values of {other}"
    return ""


def _analysis(
    rows: Result, elements: Sequence[Element], tolerance_bounds: Mapping[str, ToleranceBound]
) -> AnalysisTable:
    """Return the thresholds of the study, and the quantiles behind the tolerance bounds."""
    analysis = rows.analysis
    shown = {
        element.output: None
        for element in elements
        if element.output in analysis.thresholds or element.name in tolerance_bounds
    }
    bounds = tolerance_bounds.values()
    quantiles = {p: None for bound in bounds for p in bound.probabilities if bound.of_quantile(p)}
    changed = {"quantiles": tuple(quantiles), "outputs": tuple(shown)}
    return analysis.model_copy(update=changed)


def _statistics(
    elements: Iterable[Element], context: Context, tolerance_bounds: Mapping[str, ToleranceBound]
) -> Statistics:
    """Return the probabilities of events, and the quantiles behind the tolerance bounds."""
    return {
        (element.name, *statistic.key): statistic
        for element in elements
        for makers in [
            (thresholds, quantiles) if element.name in tolerance_bounds else (thresholds,)
        ]
        for make in makers
        for statistic in make(element, context)
    }


def _slider(
    rows: Result, name: str, law: Law, estimates: Callable[[Arguments], dict[str, Any] | None]
) -> dict[str, Any] | None:
    """Return the slider of an input with its stops; None if no stop is possible."""

    def stops(moved: Iterator[tuple[float, Arguments]], studied: float) -> list[dict[str, Any]]:
        moves = [
            {"at": at, "words": _words(rows, name, law, arguments)} | stop
            for at, arguments in moved
            if arguments and (stop := estimates(arguments))
        ]
        neutral = {"at": studied, "words": _words(rows, name, law, vars(law))}
        return sorted([*moves, neutral], key=lambda stop: stop["at"]) if moves else []

    tracks = {"width": stops(widths(law), 1.0), "shift": stops(shifts(law), 0.0)}
    variable = rows.dataset[name]
    slider = {
        "name": name,
        "label": plain(printed(readable(called(name)))),
        "symbol": parts_of(symbol_beside(called(name), variable)),
        "meaning": plain(readable(meaning_of(variable))),
        "more": f", as a multiple of {called(law.times)}" if law.times else "",
        "tracks": [
            {"name": track, "stops": places, "studied": _place_of_study(places)}
            for track, places in tracks.items()
            if places
        ],
    }
    return slider if slider["tracks"] else None


def _place_of_study(stops: Sequence[Mapping[str, Any]]) -> int:
    """Return the index of the stop with the law of the study."""
    return next(place for place, stop in enumerate(stops) if "options" not in stop)


def _quality(effective_rows: float, pareto_k: float, count: int, name: str) -> str:
    """Return the effective sample size of the weights in words."""
    tail = f" (Pareto k = {pareto_k:.2g})" if isfinite(pareto_k) else ""
    digits = f"{effective_rows:.3g}"
    worth = grouped(int(float(digits))) if effective_rows >= 1000 else digits
    return printed(f"These weights are worth {worth} of {grouped(count)} {name}{tail}.")


def _independent(rows: Result) -> tuple[int, str]:
    """Return the number of independent samples, or of rows if each sample is one row."""
    labels = rows.dependence.labels
    if labels is not None and rows.dependence.are_samples:
        return len(np.unique(labels)), "samples"
    return len(rows), "rows"


def _words(rows: Result, name: str, law: Law, arguments: Arguments) -> str:
    """Return the adjustable arguments of a law in words: ``mean 250 µm, sd 25 µm``."""
    unit = unit_of_input(rows, name)

    def words(key: str, value: Any) -> str:
        if isinstance(value, str):
            return f"{key} {value}"
        is_pure = law.times is not None or key in law.pure
        size, name = (1.0, "") if is_pure else (unit.per, unit.name)
        if isinstance(value, list | tuple):
            return beside(f"{value[0] / size:.5g} to {value[-1] / size:.5g}", name)
        return f"{key} {beside(f'{value / size:.5g}', name)}"

    hidden = {"distribution", "source", "times", "level", "truncate", "counts"}
    shown = {
        key: value
        for key in type(law).model_fields
        if key not in hidden and (value := arguments.get(key, getattr(law, key))) is not None
    }
    return plain(printed(", ".join(words(key, value) for key, value in shown.items())))


def _events(
    statistics: Statistics,
    elements: Sequence[Element],
    context: Context,
    refused: Mapping[str, str] = MappingProxyType({}),
) -> dict[str, dict[str, Any]]:
    """Return the probabilities of the events requested by the study."""
    return {
        event_key(element, value): _cell(
            statistics.get((element.name, "thresholds", repr(value), side)),
            refused.get(element.name, ""),
        )
        for element in elements
        for side in ["below" if element.is_lifetime else "above"]
        for value in context.analysis.thresholds.get(element.output, ())
    }


def event_key(element: Element, threshold: float) -> str:
    """Return the name of an event requested by the study."""
    return f"{element.name}/{threshold:.15g}"


def _cell(statistic: Statistic | None, refused: str) -> dict[str, Any]:
    """Return a probability with its interval, as numbers and as text."""
    if statistic is None:
        return {"value": None, "more": plain(printed(refused))}
    estimate = statistic.best.estimate
    value, low, high = estimate.numbers
    if isnan(value):
        return {"value": None, "more": plain(printed(estimate.reason))}
    ends = "" if isnan(low) or isnan(high) else percent_interval(low, high)
    return {
        "value": value,
        "low": _finite(low),
        "high": _finite(high),
        "text": printed(percent(value)),
        "ends": printed(ends),
        "more": plain(printed(estimate.assumes or estimate.reason)),
    }


def _bounds_now(tolerance_bound: ToleranceBound) -> list[str]:
    """Return the tolerance bounds that a quantile of weighted rows could replace."""
    bounds = map(tolerance_bound.of_quantile, tolerance_bound.probabilities)
    return [plain(printed(bound.sentence)) for bound in bounds if bound is not None]


def _bounds_then(
    then: Statistics, studied: Statistics, name: str, tolerance_bound: ToleranceBound
) -> list[str]:
    """Return the changed bounds of an element, beside the same estimates for the study's law."""
    return [
        _then(
            bound,
            *(_end(side.get((name, "quantiles", repr(p))), bound) for side in (then, studied)),
        )
        for p in tolerance_bound.probabilities
        if (bound := tolerance_bound.of_quantile(p)) is not None
    ]


def _then(bound: ToleranceBound, then: float, studied: float) -> str:
    if not isfinite(then) or (bound.is_life and then <= 0):
        return "No bound can be estimated: too many rows are invalid, or too few carry weight."
    return plain(printed(bound.moved_end(then, studied)))


def _end(statistic: Statistic | None, bound: ToleranceBound) -> float:
    """Return the interval end of a quantile, counting failed rows beyond it."""
    if statistic is None:
        return nan
    estimates: list[Estimate] = [statistic.best.estimate]
    if statistic.best.failed is not None:
        estimates.append(statistic.best.failed)
    if isfinite(bound.upper):
        return float(np.max([estimate.high for estimate in estimates]))
    return float(np.min([estimate.low for estimate in estimates]))


def _finite(value: float) -> float | None:
    return value if isfinite(value) else None
