"""Quantities of an answer: promises, likely ranges, and probabilities."""

from collections.abc import Iterator
from dataclasses import replace
from math import isfinite, nan

import numpy as np

from uq.assess.answer.contributions import Ranking
from uq.assess.answer.earliest import earliest
from uq.assess.answer.measured_indices import method_for
from uq.assess.answer.parts import Event, Quantity
from uq.assess.answer.promised_bounds import (
    CONFIDENCE,
    COVERAGE,
    MIDDLE,
    best_quantile,
    end_verb,
    functions_of,
    own_error_of,
    promise_of,
    quantile_of,
    without_value,
)
from uq.assess.answer.rankings import ranking_of
from uq.assess.answer.tolerance_bound import Range
from uq.assess.answer.wording import (
    ASSUMED,
    DisplayUnit,
    element_called,
    mark_of,
    unit_for,
    unit_of_input,
)
from uq.assess.chosen_targets import chosen
from uq.assess.effects import EventCurve, event_curve
from uq.assess.findings import Findings
from uq.assess.row_inputs import independent_inputs
from uq.assess.statistic import Context, Statistic
from uq.assess.statistics.counts import never_ending
from uq.assess.statistics.quantiles import B_LIVES, quantiles
from uq.assess.statistics.tolerance import tolerance
from uq.assess.summary import Described, resolution_of, summarise
from uq.assess.targets import lightened, number_of, split_name
from uq.errors import InputError
from uq.indices.methods import METHODS
from uq.result.elements import Element
from uq.result.result import Result
from uq.stats.estimate import NOTHING
from uq.study.file import AnalysisTable
from uq.text.numbers import threshold
from uq.text.units import readable

LOW, HIGH = 0.05, 0.95
"""Probabilities of the ends of the likely range."""

_RANGE = {"low": LOW, "median": MIDDLE, "high": HIGH}

_NARROW = 0.003  # range over values below which three digits show few steps


def quantities(findings: Findings, only: str | None = None) -> list[Quantity]:
    """Return the answer for each element that the study asks for, its subject first.

    Parameters
    ----------
    findings : Findings
    only : str, optional
        The name of an element: the answer for no other.

    Returns
    -------
    list of Quantity
    """
    result = findings.result
    asked = result.analysis_of(only and only.partition("[")[0])
    wanted = with_bounds(asked, findings)
    summary = summarise(result, asked) if only else findings.summary
    parts = [part for part in ("quantiles", "tolerance") if _asks(wanted, asked, part)]
    more = summarise(result, wanted, parts=parts).outputs if parts else {}
    context = Context(findings.rows, wanted, findings.rows.weights)
    return [
        _quantity(
            findings,
            _merged(summary.outputs[element.name], more.get(element.name)),
            context,
            element,
        )
        for element in findings.rows.elements(
            by_importance(result, asked)
        )  # one at a time in memory
        if element.present.any() and only in (None, element.name)
    ]


def only_ranked(findings: Findings) -> list[Quantity]:
    """Return rankings alone, of rows that have indices but no statistics."""
    result = findings.result
    ranked = []
    for element in result.elements(by_importance(result, result.analysis)):
        values = np.abs(element.values[np.isfinite(element.values)])
        if not len(values):
            continue
        ranking = _ranking(findings, element, unit_for(element.units, float(np.median(values))))
        words, meaning = element_called(result, element), readable(element.meaning)
        ranked.append(Quantity(element.name, words, meaning, ranking=ranking))
    return ranked


def by_importance(result: Result, asked: AnalysisTable) -> list[str]:
    """Return the outputs that a study asks for, its subject first."""
    declared = result.outputs
    return sorted(
        result.shown_outputs(asked),
        key=lambda name: (name not in asked.thresholds, not declared[name].is_lifetime),
    )


def _asks(wanted: AnalysisTable, asked: AnalysisTable, part: str) -> bool:
    """Return whether a part of the table asks for more than the study."""
    return bool(getattr(wanted, part) != getattr(asked, part))


def _merged(described: Described, more: Described | None) -> Described:
    """Return an element with more statistics."""
    if more is None:
        return described
    return replace(described, parts={**described.parts, **more.parts})


def with_bounds(asked: AnalysisTable, findings: Findings) -> AnalysisTable:
    """Return the [analysis] of a study with the bounds and quantiles that the answer needs."""
    coverage = asked.tolerance.coverage if asked.tolerance else COVERAGE
    needed = {LOW, MIDDLE, HIGH, coverage, round(1 - coverage, 12)}
    missing = tuple(sorted(needed - set(asked.quantiles)))
    changes: dict[str, object] = {}
    if missing:
        changes["quantiles"] = (*asked.quantiles, *missing)
    if asked.tolerance is None and findings.rows.has_independent_rows:
        tolerances = type(asked).model_validate(
            {"tolerance": {"coverage": COVERAGE, "confidence": CONFIDENCE}}
        )
        changes["tolerance"] = tolerances.tolerance
    return asked.model_copy(update=changes) if changes else asked


def _quantity(
    findings: Findings, described: Described, context: Context, element: Element
) -> Quantity:
    folded = element
    if element.is_angle:  # its sign is only a direction
        folded = replace(element, values=element.for_thresholds)
        of_magnitude = {
            "quantiles": tuple(quantiles(folded, context)),
            "tolerance": tuple(tolerance(folded, context)),
        }
        described = Described(described.units, {**described.parts, **of_magnitude})
    middle = quantile_of(described, MIDDLE)
    wanted = context.analysis.wanted.get(element.output, "below" if element.is_angle else "")
    others = (quantile_of(described, p).value for p in (LOW, HIGH))
    least = element.at_least[np.isfinite(element.at_least)]  # of lives, also those of censored rows
    shortest = float(least.min()) if len(least) else nan
    typical = next(filter(isfinite, (middle.value, *others, shortest)), nan)
    unit = unit_for(element.units, abs(typical))
    fine = unit._replace(resolution=resolution_of(folded, _NARROW))
    promise = promise_of(findings.result, described, element, context.analysis, wanted, fine)
    by = {name: functions_of(best_quantile(described, p)) for name, p in _RANGE.items()}
    by["never"] = (never_ending, *context.sample(element).by["never_ending"])
    return Quantity(
        element.name,
        element_called(findings.result, element),
        readable(element.meaning),
        promise,
        Range(
            quantile_of(described, LOW),
            middle,
            quantile_of(described, HIGH),
            fine,
            element.is_angle,
            end_verb(element),
            never_ending(element, context.replicate) if element.is_lifetime else NOTHING,
            **without_value(element),
            is_life=element.is_lifetime,
            by=by,
        ),
        tuple(_events(findings, described, element)),
        _as_computed(_ranking(findings, element, unit), described),
        wanted,
        earliest(findings, element, unit, context.replicate)
        if _may_end_badly(findings.result, element)
        else None,
        assumed_scales(findings.result, element),
        own_error_of(promise, described, folded, context),
        tuple(life for life in described.parts["b_lives"] if life.key[-1] in B_LIVES),
    ).with_limits()


def assumed_scales(result: Result, element: Element) -> tuple[str, ...]:
    """Return the assumed quantities that all lives scale with, or with the reciprocal of."""
    scales = (name for name in element.declared.scales if name in result.dataset)
    return tuple(name for name in scales if mark_of(result, name) == ASSUMED)


def _may_end_badly(result: Result, element: Element) -> bool:
    """Return whether the rows that end first are of interest and have equal weight."""
    return element.is_lifetime and not element.declared.success and not result.has_weights


def _ranking(findings: Findings, element: Element, unit: DisplayUnit) -> Ranking | None:
    method = method_for(findings.result, event=False)
    if method is None:
        return None
    target = number_of(element)
    name = (target if METHODS[method].scale_free else lightened(target)).name
    verb = ("shortens it", "lengthens it") if element.is_lifetime else ("lowers it", "raises it")
    if element.is_angle:  # only the ranking refers to the signed value
        verb = ("lowers its signed value", "raises its signed value")
    try:
        ranking = ranking_of(findings, name, method, verb)
    except InputError as refused:
        return Ranking(name, method, reason=f"no ranking of the inputs: {refused}")
    if element.is_angle and ranking.index_meaning:
        ranking = replace(
            ranking, index_meaning=f"{ranking.index_meaning}, of the angle with its sign"
        )
    if split_name(name)[0]:
        return ranking
    # Changes of the output itself are in its unit, as are indices that are not relative.
    kind = next((kind for kind in METHODS[method].kinds if kind.key == ranking.kind), None)
    of_index = unit if kind is not None and kind.unit == "output" else DisplayUnit()
    contributions = tuple(
        replace(
            contribution,
            changes=tuple(replace(change, unit=unit) for change in contribution.changes),
            unit=of_index,
        )
        for contribution in ranking.contributions
    )
    return replace(ranking, contributions=contributions)


def _as_computed(ranking: Ranking | None, described: Described) -> Ranking | None:
    """Return a ranking, marked if it is of lives as computed while other numbers integrate."""
    facts = [statistic.facts.get("integrated") for statistic in described.parts["integrated"]]
    if ranking is None or not ranking.index_meaning or not any(facts):
        return ranking
    return replace(ranking, index_meaning=f"{ranking.index_meaning}, of lives as computed")


def events_of(findings: Findings, element: Element) -> Iterator[Event]:
    """Yield the events that the thresholds of a study define for an element."""
    return _events(findings, findings.summary.outputs[element.name], element)


def _events(findings: Findings, described: Described, element: Element) -> Iterator[Event]:
    side, sign = ("below", "<") if element.is_lifetime else ("above", ">")
    for statistic in described.parts["thresholds"]:
        if statistic.key[-1] != side or statistic.at is None:
            continue
        at = threshold(statistic.at, element.units)
        predicate = f"exceed {at}"
        if element.is_lifetime:  # an end at the threshold itself does not count
            ended = element.values[~element.censored]
            at_it = element.law is None and (ended == statistic.at).any()
            predicate = f"{end_verb(element)} {'before' if at_it else 'within'} {at}"
        predicate += " in magnitude" * element.is_angle
        target = f"P({element.name}{sign}{statistic.at!r})"
        undefined = statistic.facts.get("undefined") or 0.0
        yield replace(event(findings, target, predicate, statistic), undefined=undefined)


def event(findings: Findings, target: str, predicate: str, statistic: Statistic) -> Event:
    """Return an event: its probability, ranking, and probability over the leading input.

    Parameters
    ----------
    findings : Findings
    target : str
        Its name as a target of indices.
    predicate : str
        The event, in words.
    statistic : Statistic
        Its probability.
    """
    best = statistic.best
    outcome = Event(target, predicate, best.estimate, statistic.failed, by=best.by)
    method = method_for(findings.result, event=True)
    if method is None or best.estimate.value in (0.0, 1.0):
        return outcome
    verb = ("lowers the probability", "raises the probability")
    try:
        ranking = ranking_of(findings, target, method, verb)
    except InputError as refused:
        why = str(refused)
        if not split_name(target)[2]:  # a regime that does not occur in the ranked rows
            why = f"no ranking of the inputs: no row that it could rest on is {predicate}"
        return replace(outcome, ranking=Ranking(target, method, reason=why))
    outcome = replace(outcome, ranking=ranking)
    if ranking.leader is None:
        return outcome
    over, rows = ranking.leader.inputs[0], findings.ranked.rows
    curve = curve_over(rows, target, method, over)
    return replace(outcome, over=over, curve=curve, over_unit=unit_of_input(findings.result, over))


def curve_over(rows: Result, target: str, method: str, over: str) -> EventCurve | None:
    """Return the probability of an event over an input."""
    hits = next(chosen(rows, method, [target])).values
    return event_curve(hits, independent_inputs(rows)[over], rows.replicates)
