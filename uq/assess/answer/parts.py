"""Events and quantities of an answer, with their sentences."""

from dataclasses import dataclass, field, replace
from math import isnan

from uq.assess.answer.contributions import Ranking
from uq.assess.answer.earliest import Earliest
from uq.assess.answer.limits import Limit, limit_of
from uq.assess.answer.repeat_interval import PredictionInterval, repeated_quantile, repeated_share
from uq.assess.answer.solver_error import OwnError
from uq.assess.answer.tolerance_bound import Range, ToleranceBound
from uq.assess.answer.wording import DisplayUnit, called_together, sentence, share_text
from uq.assess.event_curve import EventCurve
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
        What the rows do: ``end within 24 hours``, ``exceed 12 degrees in magnitude``.
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
        Share of the rows in which the output is undefined, so that neither side holds.
    is_of_single : bool
        Whether a level without the leading input decides more than it.
    limit : Limit or None
        Of that input, where its unwanted side is rare on average; None where no side is unwanted.
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

    @property
    def sentence(self) -> str:
        """Its probability, or the reason why it is unknown."""
        if isnan(self.share.value):
            why = self.share.reason
            return sentence(f"how many {self.clause} is not known: {why}") if why else ""
        text = f"{share_text(self.share)} {self.predicate}"
        if self.failed is not None and self.failed.has_interval:
            ends = percent_range(self.failed.low, self.failed.high)
            text += f"; with failed rows {ends}"
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
        """Its main driver, after its name."""
        cause = self.decided_by
        return f"{capitalized(self.predicate)}: {cause[:1].lower()}{cause[1:]}" if cause else ""

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
        text = f"decided most by {leader.words}"
        if self.is_of_single or self.ranking.may_be_overturned:
            text = f"of single inputs, decided most by {leader.words}"
        if leader.share_of_variance and len(leader.inputs) == 1 and leader.value < MINOR:
            text += f", though it alone explains only {leader.size}"
        if self.curve is not None:
            places = [self.curve.least, self.curve.most]
            first, last = (
                f"{percent(self.curve.shares[i].value)} where it is {self.part(i)}" for i in places
            )
            over = f" over {called_together([self.over])}" if len(leader.inputs) > 1 else ""
            text += f":{over} from {first} to {last}"
        return sentence(text)

    def part(self, i: int) -> str:
        """Return a part of the input that the curve is over, with neighbours alike, in words."""
        assert self.curve is not None
        low, high = self.curve.around(i)
        if low == self.curve.edges[0]:
            return f"below {self.over_unit.text(high)}"
        if high == self.curve.edges[-1]:
            return f"above {self.over_unit.text(low)}"
        return f"between {self.over_unit.between(low, high, ' and ')}"


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
        The side of its values that is wanted; "" where that is not known, and for lives.
    earliest : Earliest or None
        Of a life that does not end with a success: which rows end first, and why.
    scaled_by : tuple of str
        Quantities whose values are assumed and to which all its lives are proportional.
    own_error : OwnError or None
        Effect of the stated errors of the rows on the promise.
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
    own_error: OwnError | None = None

    @property
    def subject(self) -> str:
        """Its name, and the assumed quantities that scale it."""
        if not self.scaled_by:
            return sentence(self.words)
        are = "are" if len(self.scaled_by) > 1 else "is"
        named = called_together(self.scaled_by)
        return f"{sentence(self.words)} Its scale is that of {named}, which {are} assumed."

    @property
    def is_life(self) -> bool:
        """Whether it is a life."""
        return self.promise is not None and self.promise.is_life

    @property
    def is_success(self) -> bool:
        """Whether it is a life that ends with a success."""
        return self.promise is not None and self.promise.ends == "succeed"

    @property
    def wants_more(self) -> bool | None:
        """Whether more of its events are better; None if unknown.

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
    def repeated(self) -> PredictionInterval:
        """Prediction interval for another seed."""
        if self.first is None:
            return repeated_quantile(self.promise, self.range, self.ranking)
        return repeated_share(self.first.predicate, self.first.share, self.ranking)

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
