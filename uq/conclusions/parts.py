"""What the answer consists of: numbers, and the sentence that each part writes from its own."""

from dataclasses import dataclass, field
from math import inf, isfinite, isnan

from uq.analysis.event_curve import EventCurve
from uq.conclusions.words import Unit, called_together
from uq.estimate import NOTHING, Estimate
from uq.wording import percent, percent_interval

RARE = 0.01
MOST_REGIMES = 3
"""Rarer regimes, and more of them, are left to the table."""

SMALL = 0.05
"""A smaller share of the variance does not lead."""

_PER_CENT = 100.0


def sentence(text: str) -> str:
    """Return text as a sentence."""
    return f"{text[:1].upper()}{text[1:]}."


def share_text(one: Estimate) -> str:
    """Return a share in per cent, with its interval."""
    interval = f" ({percent_interval(one.low, one.high)})" if one.has_interval else ""
    return percent(one.value) + interval


@dataclass(frozen=True)
class Promise:
    """A value that can be promised.

    Attributes
    ----------
    coverage, confidence : float
        At least this share of all lies on the right side of the bound, with this confidence.
    lower, upper : float
        Bounds; NaN where there is none, or it is not asked for.
    quantiles : tuple of Estimate
        Where there is no tolerance bound: quantiles of one less the coverage and of the coverage,
        those that are asked for (else without numbers).
    reason : str
        Why there is no tolerance bound, or "".
    unit : Unit
    is_life, of_magnitude : bool
        Whether it is a life that ends; whether it is the magnitude of an angle.
    """

    coverage: float
    confidence: float
    lower: float
    upper: float
    unit: Unit
    quantiles: tuple[Estimate, Estimate] = (NOTHING, NOTHING)
    reason: str = ""
    is_life: bool = False
    of_magnitude: bool = False

    @property
    def sentence(self) -> str:
        """What can be promised; "" where nothing can."""
        share = f"{_PER_CENT * self.coverage:g} %"
        bounds = [
            f"{self._side(i)} {self.unit.text(bound, (-inf, inf)[i])}"
            for i, bound in enumerate((self.lower, self.upper))
            if isfinite(bound)
        ]
        if bounds:
            sure = f"With {_PER_CENT * self.confidence:g} % confidence"
            each = ", each" if len(bounds) > 1 else ""
            return f"{sure}{each}, at least {share} {f', and at least {share} '.join(bounds)}."
        cautious = []
        for i, one in enumerate(self.quantiles):
            end = (one.low, one.high)[i]
            if not isfinite(one.value):
                continue
            text = f"{share} {self._side(i)} {self.unit.text(one.value)}"
            if isfinite(end):
                text += f", cautiously {self.unit.text(end, (-inf, inf)[i])}"
            cautious.append(text)
        return f"{'; '.join(cautious)}." if cautious else ""

    @property
    def why(self) -> str:
        """Why there is no tolerance bound; "" where there is one."""
        if not self.reason:
            return ""
        end = " Cautiously: the end of the 95 % interval." if self._is_cautious else ""
        return f"No tolerance bound: {self.reason}.{end}"

    @property
    def _is_cautious(self) -> bool:
        ends = (self.quantiles[0].low, self.quantiles[1].high)
        return any(isfinite(end) for end in ends)

    def _side(self, upper: int) -> str:
        if self.of_magnitude:
            return "stay within"
        if self.is_life:
            return "end within" if upper else "last longer than"
        return "stay below" if upper else "stay above"


@dataclass(frozen=True)
class Range:
    """The likely range: quantiles of 5, 50 and 95 %."""

    low: Estimate
    median: Estimate
    high: Estimate
    unit: Unit
    of_magnitude: bool = False

    @property
    def sentence(self) -> str:
        """Range and median, as far as they are known."""
        parts = []
        what = "of the magnitudes " if self.of_magnitude else ""
        if isfinite(self.low.value) and isfinite(self.high.value):
            ends = self.unit.between(self.low.value, self.high.value, " and ")
            parts.append(f"90 % {what}lie between {ends}")
        elif isfinite(self.low.value) and self.high.value == inf:
            most = "never end" if "value" not in self.high.beyond else "exceed the horizon"
            parts.append(f"5 % end within {self.unit.text(self.low.value)}; more than 5 % {most}")
        if isfinite(self.median.value):
            parts.append(f"median {self.unit.text(self.median.value)}")
        elif self.median.value == inf and "value" not in self.median.beyond:
            parts.append("at least half never end")
        return sentence("; ".join(parts)) if parts else ""


@dataclass(frozen=True)
class Change:
    """How a target changes with one input, on average.

    Attributes
    ----------
    direction : int
        1 if it rises with the input, -1 if it falls, 0 where that is not clear.
    step : str
        The change of the input: ``10 %``; "" where only the direction is known.
    by : Estimate
        The change of the target.
    unit : Unit
        Of `by`: ``%`` for relative changes, ``percentage points`` for probabilities.
    verbs : tuple of str
        What a fall and a rise of the target is called.
    """

    direction: int = 0
    step: str = ""
    by: Estimate = NOTHING
    unit: Unit = field(default_factory=Unit)
    verbs: tuple[str, str] = ("lowers it", "raises it")

    def sentence(self, name: str = "") -> str:
        """Return direction and size in words, of an input with this name."""
        if self.direction == 0:
            return f"{name} has no clear direction" if name else "no clear direction"
        verb, of = self.verbs[self.direction > 0], f" {name}" if name else ""
        if not self.step or not self.by.has_interval:
            return f"more{of} {verb}"
        low, high = sorted(map(abs, (self.by.low, self.by.high)))
        by = self.unit.text(abs(self.by.value))
        return f"{self.step} more{of} {verb} by {by} ({self.unit.bare_between(low, high)})"


@dataclass(frozen=True)
class Contribution:
    """Inputs that contribute alike to the scatter of a target, or to an event.

    Attributes
    ----------
    inputs : tuple of str
        One; or several that the indices do not tell apart, or twins.
    indices : tuple of Estimate
        Of each.
    share_of_variance : bool
        Whether an index is one.
    changes : tuple of Change
        Of each; empty where they are not known.
    """

    inputs: tuple[str, ...]
    indices: tuple[Estimate, ...]
    share_of_variance: bool
    changes: tuple[Change, ...] = ()

    @property
    def words(self) -> str:
        """The inputs by their names."""
        return called_together(self.inputs)

    @property
    def value(self) -> float:
        """The largest index."""
        return max(one.value for one in self.indices)

    @property
    def size(self) -> str:
        """The indices with their intervals; shares in per cent, not beyond 0 and 100."""
        texts = [self._size(one) for one in self.indices]
        return " and ".join(texts) if len(texts) < 3 else f"at most {texts[0]} each"

    def _size(self, one: Estimate) -> str:
        if self.share_of_variance:
            value, low, high = (min(max(end, 0.0), 1.0) for end in one.numbers)
            text = f"{_PER_CENT * value:.0f} %"
            ends = f"{_PER_CENT * low:.0f} to {_PER_CENT * high:.0f} %"
        else:
            text, ends = f"{one.value:.2f}", f"{one.low:.2f} to {one.high:.2f}"
        return text + (f" ({ends})" if one.has_interval else "")

    @property
    def effect(self) -> str:
        """Direction and size in words."""
        if not self.changes:
            return ""
        if len(self.changes) == 1:
            return self.changes[0].sentence()
        names = (called_together([name]) for name in self.inputs)
        each = zip(self.changes, names, strict=True)
        return "; ".join(one.sentence(name) for one, name in each)


@dataclass(frozen=True)
class Ranking:
    """Which inputs contribute to a target.

    Attributes
    ----------
    target, method : str
    kind : str
        Key of the index that ranks.
    what : str
        What the index is, such as a share of the variance.
    contributions : tuple of Contribution
        The largest first; only those that exceed inputs without effect.
    reason : str
        Why there is no ranking: no index, or nothing settled; "" where there is one.
    rows_factor : float
        How many times the rows would settle it; NaN where that does not apply.
    """

    target: str
    method: str
    kind: str = ""
    what: str = ""
    contributions: tuple[Contribution, ...] = ()
    reason: str = ""
    rows_factor: float = float("nan")

    @property
    def leader(self) -> Contribution | None:
        """What contributes most, where that is settled."""
        return self.contributions[0] if self.contributions and not self.reason else None

    @property
    def leads(self) -> bool:
        """Whether what contributes most contributes much."""
        one = self.leader
        return one is not None and not (one.share_of_variance and one.value < SMALL)

    @property
    def sentence(self) -> str:
        """What contributes most, or why that is not known."""
        if self.reason:
            return sentence(self.reason)
        leader = self.leader
        if leader is None:
            return ""
        if not self.leads:
            return f"No single input explains much: {leader.words} {leader.size}."
        verb = "contribute" if len(leader.inputs) > 1 else "contributes"
        return f"{leader.words[:1].upper()}{leader.words[1:]} {verb} most: {leader.size}."

    @property
    def with_effect(self) -> str:
        """What contributes most, with direction and size."""
        effect = self.leader.effect if self.leader is not None and self.leads else ""
        return " ".join(filter(None, (self.sentence, effect and sentence(effect))))


@dataclass(frozen=True)
class Event:
    """The probability of an event that the study asks about.

    Attributes
    ----------
    name : str
        The target, such as ``P(life<86400.0)``.
    said : str
        What happens: ``end within 24 hours``, ``exceed 12 degrees in magnitude``.
    share : Estimate
    failed : Estimate or None
        Bounds with the failed rows at best and at worst, where rows failed.
    ranking : Ranking or None
        What decides it.
    over : str
        The input that decides most; "" if that is not settled.
    curve : EventCurve or None
        The probability over that input.
    range_unit : Unit
        Of that input.
    """

    name: str
    said: str
    share: Estimate
    failed: Estimate | None = None
    ranking: Ranking | None = None
    over: str = ""
    curve: EventCurve | None = None
    over_unit: Unit = field(default_factory=Unit)

    @property
    def sentence(self) -> str:
        """Its probability, and what decides it; "" where that is not known."""
        if isnan(self.share.value):
            return sentence(self.share.reason) if self.share.reason else ""
        text = f"{share_text(self.share)} {self.said}"
        if self.failed is not None and self.failed.has_interval:
            ends = percent_interval(self.failed.low, self.failed.high)
            text += f"; with failed rows {ends}"
        return f"{text}."

    @property
    def with_cause(self) -> str:
        """Its probability, and what decides it."""
        return " ".join(filter(None, (self.sentence, self.decided_by)))

    @property
    def decided_by(self) -> str:
        """What decides it, with the probability at either end of the leading input."""
        if self.ranking is None:
            return ""
        leader = self.ranking.leader
        if leader is None:
            return self.ranking.sentence if self.ranking.reason else ""
        text = f"decided most by {leader.words}"
        if self.curve is not None:
            places = [self.curve.least, self.curve.most]
            first, last = (
                f"{percent(self.curve.shares[i].value)} where it is {self._part(i)}" for i in places
            )
            over = f" over {called_together([self.over])}" if len(leader.inputs) > 1 else ""
            text += f":{over} from {first} to {last}"
        return sentence(text)

    def _part(self, i: int) -> str:
        """Return a part of the input in words."""
        assert self.curve is not None
        low, high = (float(end) for end in self.curve.edges[i : i + 2])
        if i == 0:
            return f"below {self.over_unit.text(high)}"
        if i == len(self.curve.shares) - 1:
            return f"above {self.over_unit.text(low)}"
        return f"between {self.over_unit.between(low, high, ' and ')}"


@dataclass(frozen=True)
class Quantity:
    """The answer for one element of an output.

    Attributes
    ----------
    name, words, meaning : str
        Of the element; in words, with and without its place within the output.
    promise : Promise or None
    range : Range or None
    events : tuple of Event
    ranking : Ranking or None
    """

    name: str
    words: str
    meaning: str
    promise: Promise | None = None
    range: Range | None = None
    events: tuple[Event, ...] = ()
    ranking: Ranking | None = None

    @property
    def output(self) -> str:
        """The output that it is an element of."""
        return self.name.partition("[")[0]

    @property
    def place(self) -> str:
        """What distinguishes it from other elements of the output."""
        return self.words.removeprefix(self.meaning).removeprefix(", ")

    @property
    def head(self) -> list[str]:
        """What can be promised, of what, and its likely range, as far as they are known."""
        found = [] if self.promise is None else [self.promise.sentence]
        found.append(sentence(self.words))
        found += [] if self.promise is None else [self.promise.why]
        found += [] if self.range is None else [self.range.sentence]
        return [*filter(None, found)]


@dataclass(frozen=True)
class Tightened:
    """What half the scatter of an input would change.

    Attributes
    ----------
    inputs : tuple of str
    what : str
        The number that changes: ``the 5 % quantile``.
    before, after : Estimate
    is_share : bool
    unit : Unit
    reason : str
        Why the rows do not tell, or "".
    effective_rows : float
    """

    inputs: tuple[str, ...]
    what: str
    before: Estimate = NOTHING
    after: Estimate = NOTHING
    is_share: bool = False
    unit: Unit = field(default_factory=Unit)
    reason: str = ""
    effective_rows: float = float("nan")

    @property
    def lengthens(self) -> bool:
        """Whether lives are longer: fewer have ended, or a quantile is later."""
        return (self.after.value < self.before.value) == self.is_share

    @property
    def sentence(self) -> str:
        """What would change, or why the rows do not tell."""
        words = called_together(self.inputs)
        if self.reason:
            return f"Tightening {words}: {self.reason}."
        text = percent if self.is_share else self.unit.text
        first, then = text(self.before.value), text(self.after.value)
        ends = ""
        if self.after.has_interval:
            low, high = self.after.low, self.after.high
            both = percent_interval(low, high) if self.is_share else self.unit.between(low, high)
            ends = f" ({both})"
        return f"Half the scatter of {words} would move {self.what} from {first} to {then}{ends}."


@dataclass(frozen=True)
class Advice:
    """One thing to do.

    Attributes
    ----------
    rule : {"rows", "measure", "tighten", "nothing", "failed"}
    text : str
        The sentence.
    inputs : tuple of str
    rows : int or None
        To be added to, or reached, where more rows help.
    tightened : Tightened or None
    """

    rule: str
    text: str
    inputs: tuple[str, ...] = ()
    rows: int | None = None
    tightened: Tightened | None = None


@dataclass(frozen=True, repr=False)
class Answer:
    """The answer of a study.

    Attributes
    ----------
    title : str
    rows, failed : int
    quantities : tuple of Quantity
        The one that the study is about first.
    regimes : tuple of Event
        Shares of the regimes, the most frequent first.
    advice : tuple of Advice
    notes : tuple of str
        What could not be said, and why.
    """

    title: str
    rows: int
    failed: int
    quantities: tuple[Quantity, ...]
    regimes: tuple[Event, ...]
    advice: tuple[Advice, ...]
    notes: tuple[str, ...] = ()

    @property
    def rows_sentence(self) -> str:
        """How many rows were computed."""
        if self.failed:
            return f"{self.failed} of {self.rows} rows failed."
        return f"All {self.rows} rows were computed." if self.rows else "There are no rows."

    @property
    def main_regimes(self) -> tuple[Event, ...]:
        """The regimes that are not rare."""
        return tuple(one for one in self.regimes if one.share.value >= RARE)[:MOST_REGIMES]

    @property
    def events(self) -> list[Event]:
        """All events, those of the regimes last."""
        return [one for own in self.quantities for one in own.events] + [*self.regimes]

    @property
    def regimes_sentence(self) -> str:
        """The shares of the main regimes; "" where there is one at most."""
        shares = [f"{share_text(one.share)} {one.said}" for one in self.main_regimes]
        return f"{', '.join(shares)}." if shares else ""

    @property
    def lines(self) -> list[str]:
        """The answer in a few sentences."""
        lead = self.lead
        found = [] if not self.failed and lead else [self.rows_sentence]
        found += [] if lead is None else lead.head
        events = (() if lead is None else lead.events) + self.main_regimes
        found += [one.with_cause for one in events]
        found += [lead.ranking.with_effect] if lead is not None and lead.ranking else []
        return [*filter(None, found), *(one.text for one in self.advice)]

    def __repr__(self) -> str:
        """Return the answer in sentences, one a line."""
        return "\n".join([self.title, *self.lines])

    def _repr_html_(self) -> str:
        """Return the answer as a notebook shows it."""
        from uq.conclusions.page import notebook

        return notebook(self)

    @property
    def lead(self) -> Quantity | None:
        """The quantity that the study is about."""
        return self.quantities[0] if self.quantities else None
