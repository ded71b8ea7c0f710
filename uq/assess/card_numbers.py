"""The numbers of a card: bounds, quantiles and probabilities, each with a label and a key."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import inf, isfinite, isnan, nan
from typing import Any

from uq.assess.answer.answer_sentences import Answer
from uq.assess.answer.events import Event
from uq.assess.answer.quantities import Quantity
from uq.assess.answer.tolerance_bound import ToleranceBound, noun_of
from uq.assess.answer.wording import DisplayUnit
from uq.assess.findings import Findings
from uq.result.result import Result
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.text.keys import key_of
from uq.text.numbers import percent

MOST_REGIMES = 4
WITH_ERRORS = " with numerical errors"
"""Ends the label of a bound that includes the numerical errors of the rows."""


@dataclass(frozen=True)
class Headline:
    """A number of a card.

    Attributes
    ----------
    key : str
        For ``uq trace``; of a range, that of its lower end.
    label : str
    estimate : Estimate
        In the unit of the output; a bound has no interval, a range no value.
    unit : str
        CF unit of the estimate; ``1`` of a probability.
    shown : DisplayUnit or None
        Unit in which it is shown; None for a probability in per cent.
    towards : float
        Infinite for a bound: it is rounded to its safe side.
    note : str
        Meaning of a bound, shown instead of an interval.
    leads : bool
        Whether it answers the question of the study.
    """

    key: str
    label: str
    estimate: Estimate
    unit: str
    shown: DisplayUnit | None
    towards: float = 0.0
    note: str = ""
    leads: bool = False

    @property
    def is_range(self) -> bool:
        """Whether it is a range of values, not an estimate."""
        return self.shown is not None and isnan(self.estimate.value)

    @property
    def is_open(self) -> bool:
        """Whether it is a probability known to lie in a range alone."""
        return self.shown is None and isnan(self.estimate.value)

    @property
    def json(self) -> dict[str, Any]:
        """Key, label, numbers and unit."""
        numbers = estimate_json.numbers(self.estimate)
        return {"key": self.key, "label": self.label} | numbers | {"unit": self.unit}


def headlines(findings: Findings, answer: Answer) -> Iterator[Headline]:
    """Yield the numbers of a card, in the order in which they are shown.

    Parameters
    ----------
    findings : Findings
    answer : Answer
    """
    if answer.regimes_first:
        for regime in answer.main_regimes[:MOST_REGIMES]:
            key = key_of("regimes", regime.predicate, "share", verb="answer")
            yield Headline(key, regime.predicate, regime.share, "1", None, leads=True)
    lead = answer.lead
    if lead is None:
        return
    events = [_of_event(lead, event) for event in lead.events if isfinite(event.share.value)]
    bounds = [*_of_bounds(findings, lead)]
    others = [*_of_range(findings, lead)]
    leads = bool(bounds) or not events
    if lead.is_life and not leads:  # neither a bound nor its quantile: the events answer
        events = [replace(line, leads=True) for line in events]
    first = [*bounds, *others, *events] if lead.is_life and leads else [*events, *bounds, *others]
    for line in first:
        yield replace(line, leads=line.leads and not answer.regimes_first)


def _of_event(quantity: Quantity, event: Event) -> Headline:
    key = key_of("quantities", quantity.name, "events", event.name, "share", verb="answer")
    label = event.predicate.replace("exceed", "beyond")
    if label.endswith(" in magnitude"):
        label = label.removesuffix(" in magnitude").replace("beyond ", "beyond ±")
    share = with_failed(event.share, event.failed)
    return Headline(key, label, share, "1", None, leads=not quantity.is_life)


def with_failed(estimate: Estimate, failed: Estimate | None) -> Estimate:
    """Return an estimate whose interval allows for invalid rows at best and at worst."""
    if failed is None or not estimate.has_interval:
        return estimate
    return replace(estimate, low=failed.low, high=failed.high)


def _of_bounds(findings: Findings, quantity: Quantity) -> Iterator[Headline]:
    """Yield the tolerance bounds, or the quantiles where there is none."""
    tolerance_bound = quantity.tolerance_bound
    if tolerance_bound is None:
        return
    unit = findings.result.outputs[quantity.output].unit

    def key(name: str) -> str:
        return key_of("quantities", quantity.name, "promise", name, verb="answer")

    covered, confidence = 100 * tolerance_bound.coverage, 100 * tolerance_bound.confidence
    name = bound_name(findings.result, quantity, tolerance_bound)
    bounds = {"lower": (tolerance_bound.lower, -inf), "upper": (tolerance_bound.upper, inf)}
    both = isfinite(tolerance_bound.lower) and isfinite(tolerance_bound.upper)
    for side, (bound, towards) in bounds.items():
        if isfinite(bound):
            label = name.replace(" ", f" {side} ") if both else name
            does = _does(tolerance_bound, side)
            note = f"{covered:g} % {does}; {confidence:g} % confidence (sampling)"
            estimate, leads = Estimate(bound), quantity.is_life or not quantity.events
            line = Headline(
                key(side), label, estimate, unit, tolerance_bound.unit, towards, note, leads
            )
            yield line
            yield from _with_errors(quantity, line, side)
    if isfinite(tolerance_bound.lower) or isfinite(tolerance_bound.upper):
        return
    quantiles = zip(tolerance_bound.probabilities, tolerance_bound.quantiles, bounds, strict=True)
    for (p, estimate, side), failed in zip(quantiles, tolerance_bound.failed, strict=True):
        estimate = with_failed(estimate, failed)
        if isfinite(estimate.value):
            line = Headline(
                key(f"{side}_quantile"),
                f"{100 * p:g} % quantile",
                estimate,
                unit,
                tolerance_bound.unit,
                leads=quantity.is_life or not quantity.events,
            )
            yield line
            yield from _with_errors(quantity, line, side)


def bound_name(result: Result, quantity: Quantity, tolerance_bound: ToleranceBound) -> str:
    """Return the name of a bound: ``95/95 life``."""
    covered, confidence = 100 * tolerance_bound.coverage, 100 * tolerance_bound.confidence
    is_life = quantity.is_life and not result.outputs[quantity.output].success
    return f"{covered:g}/{confidence:g} {'life' if is_life else 'bound'}"


def _with_errors(quantity: Quantity, line: Headline, side: str) -> Iterator[Headline]:
    """Yield a bound or quantile of values that all err to its unsafe side, if it differs."""
    error, tolerance_bound = quantity.own_error, quantity.tolerance_bound
    if error is None or tolerance_bound is None or line.shown is None:
        return
    moved, towards = error.members[side], -inf if side == "lower" else inf
    now = line.shown.text(line.estimate.value, line.towards)
    if moved is None or line.shown.text(moved, line.towards) == now:
        return
    by = "minus" if side == "lower" else "plus"
    yield replace(
        line,
        key=key_of("quantities", quantity.name, "own_error", side, verb="answer"),
        label=line.label + WITH_ERRORS,
        estimate=Estimate(moved),
        towards=towards,
        note=f"{noun_of(tolerance_bound)} {by} their numerical errors",
    )


def _undecided(findings: Findings, quantity: Quantity) -> str:
    """Return the share of rows that may still end after the time studied."""
    described = findings.summary.outputs.get(quantity.name)
    censored = None if described is None else described.find("censored")
    if censored is None or not len(findings.rows):
        return ""
    return f"{percent(censored.estimate.value / len(findings.rows))} undecided: either way"


def _failed_of_median(findings: Findings, quantity: Quantity) -> Estimate | None:
    """Return the bounds of the median with invalid rows at best and at worst; None without any."""
    described = findings.summary.outputs.get(quantity.name)
    statistic = None if described is None else described.find("quantiles", "0.5")
    return None if statistic is None else statistic.best.failed


def _does(tolerance_bound: ToleranceBound, side: str) -> str:
    """Return what values do that are on the right side of a bound."""
    if tolerance_bound.of_magnitude:
        return "within it"
    if tolerance_bound.is_life:
        return f"{tolerance_bound.ends} by then" if side == "upper" else "outlast it"
    return "below it" if side == "upper" else "exceed it"


def _of_range(findings: Findings, quantity: Quantity) -> Iterator[Headline]:
    likely = quantity.range
    if likely is None:
        return
    unit, shown = findings.result.outputs[quantity.output].unit, likely.unit

    def key(name: str) -> str:
        return key_of("quantities", quantity.name, "range", name, verb="answer")

    if isfinite(likely.median.value):
        label = "median magnitude" if likely.of_magnitude else "median"
        if findings.result.outputs[quantity.output].success:
            label = "50 % succeed by"
        middle = with_failed(likely.median, _failed_of_median(findings, quantity))
        yield Headline(key("median"), label, middle, unit, shown)
    for life in quantity.b_lives:
        if life.key[-1] == "B10" and isfinite(life.estimate.value):
            path = key_of("outputs", quantity.name, *life.key)
            label = "10 % succeed by" if findings.result.outputs[quantity.output].success else "B10"
            yield Headline(path, label, with_failed(life.estimate, life.failed), unit, shown)
    low, high = likely.low.value, likely.high.value
    if isfinite(low) and isfinite(high):
        yield Headline(key("low"), "90 % between", Estimate(nan, low, high), unit, shown)
    if likely.never.value > 0 or likely.never.low > 0:
        ended = Headline(key("never"), f"never {likely.ends}", likely.never, "1", None)
        yield replace(ended, note=_undecided(findings, quantity) if ended.is_open else "")
    described = findings.summary.outputs.get(quantity.name) if likely.of_magnitude else None
    mean = None if described is None else described.find("mean")
    if mean is not None:
        path = key_of("outputs", quantity.name, "mean")
        yield Headline(path, "signed mean", mean.estimate, unit, shown)
