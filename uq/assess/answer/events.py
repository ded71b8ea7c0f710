"""Probabilities of the events that a study asks about, with their drivers and sentences."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import isnan
from typing import Any

from uq.assess.answer.bound_choice import (
    end_verb,
)
from uq.assess.answer.compared_indices import method_for
from uq.assess.answer.limits import CURVE_FUNCTIONS, Limit, limit_of
from uq.assess.answer.rankings import Ranking, ranking_of
from uq.assess.answer.wording import (
    DisplayUnit,
    called_together,
    share_text,
    unit_of_input,
)
from uq.assess.chosen_targets import chosen
from uq.assess.effects import EventCurve, event_curve
from uq.assess.fact import Fact, Functions
from uq.assess.findings import Findings
from uq.assess.row_inputs import independent_inputs
from uq.assess.statistic import Statistic
from uq.assess.summary import Described
from uq.assess.targets import split_name
from uq.errors import InputError
from uq.result.elements import Element
from uq.result.result import Result
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.text.numbers import capitalized, percent, percent_range, threshold

MINOR = 0.25
"""Below this share, state that the leading input explains little alone."""


@dataclass(frozen=True)
class Event:
    """The probability of an event that the study asks about.

    Attributes
    ----------
    name : str
        The target, such as ``P(life<86400.0)``.
    predicate : str
        The event in words: ``fail within 24 hours``, ``exceed 12 degrees in magnitude``.
    share : Estimate
    failed : Estimate or None
        Bounds with the failed rows at best and at worst, where rows failed.
    ranking : Ranking or None
        Its main drivers.
    over : str
        The leading input; "" if not settled.
    curve : EventCurve or None
        The probability over that input.
    over_unit : DisplayUnit
        Of that input.
    undefined : float
        Share of the rows in which the output is undefined, on neither side of the threshold.
    is_of_single : bool
        Whether a level without the leading input explains more than it.
    limit : Limit or None
        Range of that input in which the unwanted side is rare on average; None if no side is
        unwanted.
    by : tuple of callable
        The functions that compute the probability.
    """

    name: str
    predicate: str
    share: Estimate
    failed: Estimate | None = None
    ranking: Ranking | None = None
    over: str = ""
    curve: EventCurve | None = None
    over_unit: DisplayUnit = field(default_factory=DisplayUnit)
    undefined: float = 0.0
    is_of_single: bool = False
    limit: Limit | None = None
    by: Functions = ()

    def fact(self, result: Result | None = None) -> Fact:
        """Return the event with its numbers; its sentence names the main driver."""
        share = {"sentence": self.sentence} | estimate_json.whole(self.share)
        share |= estimate_json.failed(self.failed) | {"undefined": self.undefined}
        rows = None if result is None else result.independent
        decided_by: dict[str, Any] = {"sentence": self.decided_by}
        members: dict[str, Any] = {
            "said": self.predicate,
            "share": Fact(share, self.by, rows=rows),
            "decided_by": Fact(decided_by),
        }
        if self.curve is not None:
            parts = [*_parts(self.curve)]
            for name, place in (("least", self.curve.least), ("most", self.curve.most)):
                low, high = self.curve.around(place)
                ends = {f"{name}_above": low, f"{name}_below": high}
                decided_by |= {name: parts[place]["value"]} | ends
            members |= {"over": self.over, "parts": parts}
        if self.limit is not None:
            members["limit"] = self.limit.fact
        if self.ranking is not None:
            members["ranking"] = self.ranking.fact(result)
        mention = ("ranking", "rows_factor") if self.curve is None else ("decided_by",)
        return Fact(members, CURVE_FUNCTIONS, words=self.decided_by, mentions=(mention,))

    @property
    def sentence(self) -> str:
        """Its probability, or the reason why it is unknown."""
        if isnan(self.share.value):
            why = self.share.reason
            return f"The share that {self.clause} cannot be estimated: {why}." if why else ""
        text = f"{share_text(self.share)} {self.predicate}"
        if self.failed is not None and self.failed.has_interval:
            ends = percent_range(self.failed.low, self.failed.high)
            text += f"; with invalid rows at best and worst, {ends}"
        if self.undefined > 0:
            text += f"; {percent(self.undefined)} are undefined"
        return f"{text}."

    @property
    def clause(self) -> str:
        """The predicate with its verb: ``exceed 5``, ``are chaotic``."""
        return f"are {self.predicate}" if self.name.startswith("P(regime=") else self.predicate

    @property
    def with_cause(self) -> str:
        """Its probability, main driver, and the range in which it is rare."""
        return " ".join(filter(None, (self.sentence, self.decided_by, self.limited)))

    @property
    def named_cause(self) -> str:
        """Its name and its main driver."""
        cause = self.decided_by
        after = ", " if cause.startswith("Main ") else ": "
        words = capitalized(self.predicate)
        return f"{words}{after}{cause[:1].lower()}{cause[1:]}" if cause else ""

    @property
    def limited(self) -> str:
        """The range of the leading input in which the unwanted side is rare on average."""
        return "" if self.limit is None else self.limit.sentence

    def with_limit(self, more_is_better: bool) -> "Event":
        """Return the event with the limit of its leading input, if there is only one."""
        leader = None if self.ranking is None else self.ranking.leader
        if self.curve is None or leader is None or len(leader.inputs) > 1:
            return self
        limit = limit_of(self.curve, self.over, self.over_unit, self.predicate, not more_is_better)
        return replace(self, limit=limit)

    @property
    def decided_by(self) -> str:
        """Its main driver, with the probability at either end of the leading input."""
        if self.ranking is None:
            return ""
        leader = self.ranking.leader
        if leader is None:
            return self.ranking.sentence if self.ranking.reason else ""
        single = " single input" * (self.is_of_single or self.ranking.may_be_overturned)
        plural = "s" * (len(leader.inputs) > 1)
        text = f"Main{single or ' driver'}{plural}: {leader.words}"
        if leader.share_of_variance and len(leader.inputs) == 1 and leader.value < MINOR:
            text += f", although it alone explains only {leader.size}"
        if self.curve is None:
            return f"{text}."
        least, most = (
            f"{percent(self.curve.shares[i].value)} {self.part(i)}"
            for i in (self.curve.least, self.curve.most)
        )
        over = called_together([self.over])
        return f"{text}. Over {over}, the share ranges from {least} to {most}."

    def part(self, i: int) -> str:
        """Return a part of the input that the curve is over, with neighbours alike, in words."""
        assert self.curve is not None
        low, high = self.curve.around(i)
        if low == self.curve.edges[0]:
            return f"below {self.over_unit.text(high)}"
        if high == self.curve.edges[-1]:
            return f"above {self.over_unit.text(low)}"
        return f"between {self.over_unit.between(low, high, ' and ')}"


def _parts(curve: EventCurve) -> Iterator[dict[str, Any]]:
    """Yield the parts of an input, each with the probability of the event there."""
    edges = [float(edge) for edge in curve.edges]
    for low, high, share in zip(edges[:-1], edges[1:], curve.shares, strict=True):
        yield {"above": low, "below": high} | estimate_json.numbers(share)


def events_of(
    findings: Findings, element: Element, described: Described | None = None
) -> Iterator[Event]:
    """Yield the events at the thresholds of an element, by default from its summary."""
    described = described or findings.summary.outputs[element.name]
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
            why = f"no ranking of the inputs: none of the ranked rows is {predicate}"
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
    return event_curve(hits, independent_inputs(rows)[over], rows.dependence)
