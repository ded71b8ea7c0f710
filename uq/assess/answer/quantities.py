"""The answer for each element of an output: bound, likely range, events, ranking."""

from dataclasses import dataclass, replace
from math import isfinite, nan

import numpy as np

from uq.assess.answer.bound_choice import (
    CONFIDENCE,
    COVERAGE,
    MIDDLE,
    best_quantile,
    end_verb,
    functions_of,
    own_error_of,
    quantile_of,
    tolerance_bound_of,
    without_value,
)
from uq.assess.answer.earliest import Earliest, earliest
from uq.assess.answer.events import Event, events_of
from uq.assess.answer.rankings import Ranking, ranking_of_element
from uq.assess.answer.repeat_interval import repeated_quantile, repeated_share
from uq.assess.answer.tolerance_bound import Range, ToleranceBound
from uq.assess.answer.wording import (
    ASSUMED,
    called_together,
    element_called,
    mark_of,
    sentence,
    unit_for,
)
from uq.assess.fact import Fact
from uq.assess.findings import Findings
from uq.assess.statistic import Context, Statistic
from uq.assess.statistics.counts import never_ending
from uq.assess.statistics.quantiles import B_LIVES, quantiles
from uq.assess.statistics.tolerance import tolerance
from uq.assess.summary import Described, middle_of, resolution, summarise
from uq.result.elements import Element
from uq.result.result import Result
from uq.stats import estimate_json
from uq.stats.estimate import NOTHING
from uq.study.file import AnalysisTable
from uq.text.numbers import capitalized
from uq.text.units import readable

LOW, HIGH = 0.05, 0.95
"""Probabilities of the ends of the likely range."""

_RANGE = {"low": LOW, "median": MIDDLE, "high": HIGH}

_NARROW = 0.003  # range over values below which three digits show few steps


@dataclass(frozen=True)
class Quantity:
    """The answer for one element of an output.

    Attributes
    ----------
    name, words, meaning : str
        Of the element; in words, with and without its place within the output.
    tolerance_bound : ToleranceBound or None
    range : Range or None
    events : tuple of Event
    ranking : Ranking or None
    wanted : {"above", "below", ""}
        The wanted side of its values; "" if not stated, and for lives.
    earliest : Earliest or None
        The rows that fail first and what distinguishes them, unless the life ends with a success.
    scaled_by : tuple of str
        Assumed quantities to which all its lives, or their reciprocals, are proportional.
    own_error : Fact or None
        Effect of the numerical errors of the rows on the bound.
    b_lives : tuple of Statistic
        Of a life.
    """

    name: str
    words: str
    meaning: str
    tolerance_bound: ToleranceBound | None = None
    range: Range | None = None
    events: tuple[Event, ...] = ()
    ranking: Ranking | None = None
    wanted: str = ""
    earliest: Earliest | None = None
    scaled_by: tuple[str, ...] = ()
    own_error: Fact | None = None
    b_lives: tuple[Statistic, ...] = ()

    def fact(self, result: Result | None = None) -> Fact:
        """Return everything about the quantity."""
        rows = None if result is None else result.independent
        parts = {
            "promise": self.tolerance_bound and self.tolerance_bound.fact,
            "range": self.range and self.range.fact,
            "own_error": self.own_error,
        }
        of_rows = {name: replace(part, rows=rows) for name, part in parts.items() if part}
        events = Fact({event.name: event.fact(result) for event in self.events})
        members = {"words": self.words} | of_rows | {"events": events}
        if self.earliest is not None:
            members["earliest"] = self.earliest.fact
        if (repeated := self.repeated).sentence:
            members["another_seed"] = replace(repeated, rows=rows)
        if self.ranking is not None:
            members["ranking"] = self.ranking.fact(result)
        lives = {
            life.key[-1]: Fact(estimate_json.whole(life.estimate), life.by) for life in self.b_lives
        }
        more = {"b_lives": Fact(lives, rows=rows), "scaled_by": list(self.scaled_by)}
        return Fact(members, more=more)

    @property
    def subject(self) -> str:
        """Its name, and the assumed quantities that scale it."""
        if not self.scaled_by:
            return sentence(self.words)
        are = "are" if len(self.scaled_by) > 1 else "is"
        assumed = f"{capitalized(called_together(self.scaled_by))} {are} assumed"
        return f"{sentence(self.words)} {assumed}: only relative lives are meaningful."

    @property
    def is_life(self) -> bool:
        """Return whether the quantity is a life."""
        return self.tolerance_bound is not None and self.tolerance_bound.is_life

    @property
    def is_success(self) -> bool:
        """Return whether the quantity is a life that ends with a success."""
        return self.tolerance_bound is not None and self.tolerance_bound.ends == "succeed"

    @property
    def wants_more(self) -> bool | None:
        """Return whether more of its events are better; None if unknown.

        Of successes; of lives that end, fewer; of values above a threshold, as the study states.
        """
        if self.is_life:
            return self.is_success
        return self.wanted == "above" if self.wanted else None

    def with_limits(self) -> "Quantity":
        """Return the quantity with limits of the leading inputs of its events."""
        if (more := self.wants_more) is None:
            return self
        return replace(self, events=tuple(event.with_limit(more) for event in self.events))

    @property
    def ranking_sentence(self) -> str:
        """The leading contribution; "" if there is no ranking and an event states the reason."""
        causes = [event.decided_by for event in self.events]
        if self.ranking is None or (self.ranking.reason and self.ranking.sentence in causes):
            return ""
        return self.ranking.with_effect

    @property
    def output(self) -> str:
        """The output that it is an element of."""
        return self.name.partition("[")[0]

    @property
    def place(self) -> str:
        """Its place among the elements of the output."""
        return self.words.removeprefix(self.meaning).removeprefix(", ")

    @property
    def first(self) -> Event | None:
        """The event that comes first, if there is no tolerance bound."""
        if self.tolerance_bound is not None and self.tolerance_bound.sentence:
            return None
        return next((event for event in self.events if event.sentence), None)

    @property
    def repeated(self) -> Fact:
        """Prediction interval for another seed."""
        if self.first is None:
            return repeated_quantile(self.tolerance_bound, self.range, self.ranking)
        first = self.first
        return repeated_share(first.predicate, first.share, self.ranking, first.by)

    @property
    def others(self) -> list[Event]:
        """The events after the first."""
        return [event for event in self.events if event is not self.first]

    @property
    def head(self) -> list[str]:
        """Sentences on bound, subject, error and likely range, as far as known."""
        sentences = [] if self.tolerance_bound is None else [self.tolerance_bound.sentence]
        if self.first is not None:
            sentences += [self.first.sentence, self.first.decided_by, self.first.limited]
        sentences.append(self.subject)
        sentences += [] if self.tolerance_bound is None else [self.tolerance_bound.basis]
        sentences += [] if self.own_error is None else [self.own_error.sentence]
        sentences += [] if self.range is None else [self.range.sentence]
        return [*filter(None, sentences)]

    @property
    def lines(self) -> list[str]:
        """The sentences of `head`, then each other event with its main driver."""
        return [*self.head, *(event.with_cause for event in self.others)]


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
    beside = wanted, [p for p in ("quantiles", "tolerance") if _asks(wanted, asked, p)]
    if only:
        summary = summarise(result, asked, beside=beside)
        more = summary.beside
    else:
        more = findings.beside(*beside)
        summary = findings.summary
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
        ranking = ranking_of_element(
            findings, element, unit_for(element.units, float(np.median(values)))
        )
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
    context.samples.clear()
    folded = element
    if element.is_angle:  # its sign is only a direction
        folded = replace(element, values=element.for_thresholds)
        of_magnitude = {
            "quantiles": tuple(quantiles(folded, context)),
            "tolerance": tuple(tolerance(folded, context)),
        }
        described = replace(described, parts={**described.parts, **of_magnitude}, fits={})
    middle = quantile_of(described, MIDDLE)
    wanted = context.analysis.wanted.get(element.output, "below" if element.is_angle else "")
    others = (quantile_of(described, p).value for p in (LOW, HIGH))
    least = element.at_least[np.isfinite(element.at_least)]  # of lives, also those of censored rows
    shortest = float(least.min()) if len(least) else nan
    typical = next(filter(isfinite, (middle.value, *others, shortest)), nan)
    unit = unit_for(element.units, abs(typical))
    middle_values = middle_of(folded) if element.is_angle else described.middle
    fine = unit._replace(resolution=resolution(middle_values, _NARROW))
    tolerance_bound = tolerance_bound_of(
        findings.result, described, element, context.analysis, wanted, fine
    )
    by = {name: functions_of(best_quantile(described, p)) for name, p in _RANGE.items()}
    by["never"] = (never_ending, *context.sample(element).by["never_ending"])
    return Quantity(
        element.name,
        element_called(findings.result, element),
        readable(element.meaning),
        tolerance_bound,
        Range(
            quantile_of(described, LOW),
            middle,
            quantile_of(described, HIGH),
            fine,
            element.is_angle,
            end_verb(element),
            never_ending(element, context.rows.dependence) if element.is_lifetime else NOTHING,
            **without_value(element),
            is_life=element.is_lifetime,
            by=by,
        ),
        tuple(events_of(findings, element, described)),
        _as_computed(ranking_of_element(findings, element, unit), described),
        wanted,
        earliest(findings, element, unit, context.rows.dependence)
        if _may_end_badly(findings.result, element)
        else None,
        assumed_scales(findings.result, element),
        own_error_of(tolerance_bound, described, folded, context),
        tuple(life for life in described.parts["b_lives"] if life.key[-1] in B_LIVES),
    ).with_limits()


def assumed_scales(result: Result, element: Element) -> tuple[str, ...]:
    """Return the assumed quantities that all lives scale with, or with the reciprocal of."""
    scales = (name for name in element.declared.exponents if name in result.dataset)
    return tuple(name for name in scales if mark_of(result, name) == ASSUMED)


def _may_end_badly(result: Result, element: Element) -> bool:
    """Return whether the rows that end first are of interest and have equal weight."""
    return element.is_lifetime and not element.declared.success and not result.has_weights


def _as_computed(ranking: Ranking | None, described: Described) -> Ranking | None:
    """Return a ranking, marked if it is of lives as computed while other numbers integrate."""
    facts = [statistic.facts.get("integrated") for statistic in described.parts["integrated"]]
    if ranking is None or not ranking.index_meaning or not any(facts):
        return ranking
    return replace(ranking, index_meaning=f"{ranking.index_meaning}, of lives as computed")
