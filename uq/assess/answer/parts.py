"""Events and quantities of an answer, with their sentences."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import isnan
from typing import Any

from uq.assess.answer.contributions import Ranking
from uq.assess.answer.earliest import Earliest
from uq.assess.answer.limits import CURVE_FUNCTIONS, Limit, limit_of
from uq.assess.answer.repeat_interval import repeated_quantile, repeated_share
from uq.assess.answer.tolerance_bound import Range, ToleranceBound
from uq.assess.answer.wording import DisplayUnit, called_together, sentence, share_text
from uq.assess.effects import EventCurve
from uq.assess.fact import Fact, Functions
from uq.assess.statistic import Statistic
from uq.result.result import Result
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.text.numbers import capitalized, percent, percent_range

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
            text += f"; with failed rows at best and worst, {ends}"
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


@dataclass(frozen=True)
class Quantity:
    """The answer for one element of an output.

    Attributes
    ----------
    name, words, meaning : str
        Of the element; in words, with and without its place within the output.
    promise : ToleranceBound or None
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
        Effect of the numerical errors of the rows on the promise.
    b_lives : tuple of Statistic
        Of a life.
    """

    name: str
    words: str
    meaning: str
    promise: ToleranceBound | None = None
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
            "promise": self.promise and self.promise.fact,
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
        return self.promise is not None and self.promise.is_life

    @property
    def is_success(self) -> bool:
        """Return whether the quantity is a life that ends with a success."""
        return self.promise is not None and self.promise.ends == "succeed"

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
        """The event that comes first, if nothing can be promised."""
        if self.promise is not None and self.promise.sentence:
            return None
        return next((event for event in self.events if event.sentence), None)

    @property
    def repeated(self) -> Fact:
        """Prediction interval for another seed."""
        if self.first is None:
            return repeated_quantile(self.promise, self.range, self.ranking)
        first = self.first
        return repeated_share(first.predicate, first.share, self.ranking, first.by)

    @property
    def others(self) -> list[Event]:
        """The events after the first."""
        return [event for event in self.events if event is not self.first]

    @property
    def head(self) -> list[str]:
        """Sentences on promise, subject, error and likely range, as far as known."""
        sentences = [] if self.promise is None else [self.promise.sentence]
        if self.first is not None:
            sentences += [self.first.sentence, self.first.decided_by, self.first.limited]
        sentences.append(self.subject)
        sentences += [] if self.promise is None else [self.promise.basis]
        sentences += [] if self.own_error is None else [self.own_error.sentence]
        sentences += [] if self.range is None else [self.range.sentence]
        return [*filter(None, sentences)]

    @property
    def lines(self) -> list[str]:
        """The sentences of `head`, then each other event with its main driver."""
        return [*self.head, *(event.with_cause for event in self.others)]
