"""Contributions of inputs: shares, directions and sizes, and their sentences."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import partial
from math import isnan
from typing import Any

from uq.assess.answer.wording import DisplayUnit, called, called_together, joined, sentence
from uq.assess.effects import effects
from uq.assess.fact import Fact
from uq.indices.index import ST
from uq.indices.methods import indices_of
from uq.result.result import Result
from uq.stats import estimate_json
from uq.stats.estimate import NOTHING, Estimate
from uq.text.numbers import capitalized, grouped

SMALL = 0.05
"""A smaller share of the variance does not lead."""

EXPANSION = "hdmr"
"""The method that estimates total indices from a plain sample."""


@dataclass(frozen=True)
class AverageEffect:
    """Average change of a target with one input.

    Attributes
    ----------
    direction : int
        1 if it rises with the input, -1 if it falls, 0 if unclear.
    step : str
        The change of the input: ``10 %``; "" if only the direction is known.
    amount : str
        The step in the unit of the input, if it is not relative.
    by : Estimate
        The change of the target.
    unit : DisplayUnit
        Of `by`: ``%`` for relative changes, ``percentage points`` for probabilities.
    verbs : tuple of str
        Verbs for a fall and a rise of the target.
    """

    direction: int = 0
    step: str = ""
    by: Estimate = NOTHING
    unit: DisplayUnit = field(default_factory=DisplayUnit)
    verbs: tuple[str, str] = ("lowers it", "raises it")
    amount: str = ""

    def fact(self, name: str) -> Fact:
        """Return the change with its sentence, of an input with this name."""
        members = {
            "sentence": self.sentence(name),
            "direction": self.direction,
            "step": self.step,
            "unit": self.unit.name if self.step and self.unit.per == 1.0 else "",
        }
        return Fact(members | estimate_json.numbers(self.by))

    def sentence(self, name: str = "") -> str:
        """Return direction and size in words, of an input with this name."""
        if self.direction == 0:
            return f"{name} has no clear direction" if name else "no clear direction"
        verb, of_input = self.verbs[self.direction > 0], f" {name}" if name else ""
        if not self.step or not self.by.has_interval:
            return f"more{of_input} {verb}"
        low, high = sorted(map(abs, (self.by.low, self.by.high)))
        step = f"{self.step} ({self.amount})" if self.amount else self.step
        text = f"{step} more{of_input} {verb} by {self.unit.text(abs(self.by.value))}"
        if self.unit.number(low) == self.unit.number(high):  # exact to the digits shown
            return text
        return f"{text} ({self.unit.bare_between(low, high)})"


def whole_percent(share: Estimate) -> str:
    """Return a share of the variance with its interval, in whole per cent, within 0 and 100."""
    value, low, high = (100 * min(max(end, 0.0), 1.0) for end in share.numbers)
    return f"{value:.0f} %" + (f" ({low:.0f} to {high:.0f} %)" if share.has_interval else "")


@dataclass(frozen=True)
class Contribution:
    """Inputs that contribute alike to the scatter of a target, or to an event.

    Attributes
    ----------
    inputs : tuple of str
        One input, or several that are twins or have indistinguishable indices.
    indices : tuple of Estimate
        Index of each input.
    share_of_variance : bool
        Whether an index is a share of the variance.
    changes : tuple of AverageEffect
        Effect of each input; empty if not estimated.
    unit : DisplayUnit
        Of an index in the unit of the output.
    doubtful : tuple of str
        Inputs whose effect is not significant.
    """

    inputs: tuple[str, ...]
    indices: tuple[Estimate, ...]
    share_of_variance: bool
    changes: tuple[AverageEffect, ...] = ()
    unit: DisplayUnit = field(default_factory=DisplayUnit)
    doubtful: tuple[str, ...] = ()

    @property
    def fact(self) -> Fact:
        """Indices and effects of the inputs."""
        pairs = zip(self.inputs, self.indices, strict=True)
        indices = {name: estimate_json.numbers(index) for name, index in pairs}
        changes = zip(self.inputs, self.changes, strict=False)
        moved = {name: change.fact(name) for name, change in changes}
        each = tuple((name,) for name in self.inputs)
        return Fact(
            {
                "inputs": Fact(indices, words=self.size, mentions=each),
                "effects": Fact(moved, (effects,), words=self.effect, mentions=each),
            },
            more={"share_of_variance": self.share_of_variance, "doubtful": list(self.doubtful)},
        )

    @property
    def words(self) -> str:
        """The inputs by their names."""
        if not self.doubtful:
            return called_together(self.inputs)
        return joined([called_together(self.sure), *map(called, self.doubtful)], "or")

    @property
    def sure(self) -> tuple[str, ...]:
        """The inputs with a significant effect."""
        return tuple(name for name in self.inputs if name not in self.doubtful)

    @property
    def value(self) -> float:
        """The largest index."""
        return max(index.value for index in self.indices)

    @property
    def size(self) -> str:
        """The indices with their intervals; shares in per cent, not beyond 0 and 100."""
        texts = [self.size_of(index) for index in self.indices]
        return " and ".join(texts) if len(texts) < 3 else f"at most {texts[0]} each"

    def size_of(self, index: Estimate) -> str:
        """Return an index with its interval."""
        if self.share_of_variance:
            return whole_percent(index)
        text, ends = f"{index.value:.2f}", f"{index.low:.2f} to {index.high:.2f}"
        if self.unit.name:
            text, ends = self.unit.text(index.value), self.unit.bare_between(index.low, index.high)
        return text + (f" ({ends})" if index.has_interval else "")

    @property
    def effect(self) -> str:
        """Direction and size in words."""
        if not self.changes:
            return ""
        if len(self.changes) == 1:
            return self.changes[0].sentence()
        names = (called_together([name]) for name in self.inputs)
        changes_by_name = zip(self.changes, names, strict=True)
        return "; ".join(effect.sentence(name) for effect, name in changes_by_name)


@dataclass(frozen=True)
class Ranking:
    """Ranking of the inputs by their contribution to a target.

    Attributes
    ----------
    target, method : str
    kind : str
        Key of the index that ranks.
    index_meaning : str
        Meaning of the index, such as a share of the variance.
    contributions : tuple of Contribution
        The largest first; only inputs whose index exceeds that of inputs without effect.
    reason : str
        Reason for a missing ranking: no index, or none settled; "" otherwise.
    rows_factor : float
        Factor on the sample size that would settle it; NaN if not applicable.
    is_flat : bool
        Whether it is settled that no input contributes measurably.
    rivals : tuple of str
        Inputs that may lead in a repeat with another seed, at 95 % confidence; none if unknown.
    share_of : str
        The variance that an index is a share of: ``the variance``; "" of other indices and of
        events.
    unexplained : Estimate
        Share of the variance that no single input explains, where inputs are ranked by first-order
        indices.
    runner_up : float
        The largest index of the inputs ranked after the leader.
    totals : dict of str to float
        Input -> total index, the largest first, where an expansion of these rows gives it.
    remedy : str
        Way to show interactions if `totals` are unknown.
    """

    target: str
    method: str
    kind: str = ""
    index_meaning: str = ""
    contributions: tuple[Contribution, ...] = ()
    reason: str = ""
    rows_factor: float = float("nan")
    is_flat: bool = False
    rivals: tuple[str, ...] = ()
    share_of: str = ""
    unexplained: Estimate = NOTHING
    runner_up: float = 0.0
    totals: Mapping[str, float] = field(default_factory=dict)
    remedy: str = ""

    def fact(self, result: Result | None = None) -> Fact:
        """Return the ranking with its sentence; `result` is the ranked one."""
        notes: tuple[str, ...] = ()
        if result is not None and result.is_nested:
            used = grouped(len(result.first_rows))
            notes = (f"the index uses {used} of these rows, the first of each sample",)
        members: dict[str, Any] = {
            "sentence": self.sentence,
            "target": self.target,
            "method": self.method,
            "index": self.kind,
            "reason": self.reason,
            "rows_factor": estimate_json.number(self.rows_factor),
            "contributions": [contribution.fact for contribution in self.contributions],
        }
        if not isnan(self.unexplained.value):
            members["unexplained"] = estimate_json.numbers(self.unexplained)
            members["totals"] = dict(self.totals)
        mentions: list[tuple[str, ...]] = [("rows_factor",)]
        leader = self.leader
        if leader is not None:
            mentions = [("contributions", "0", "inputs", name) for name in leader.inputs]
            mentions += [("unexplained",)] * bool(self.beyond_single)
        return Fact(
            members,
            (partial(indices_of, self.method, self.kind),),
            {"totals": (partial(indices_of, EXPANSION, ST.key),)},
            mentions=tuple(mentions),
            notes=notes,
        )

    @property
    def leader(self) -> Contribution | None:
        """The largest contribution, if settled."""
        return self.contributions[0] if self.contributions and not self.reason else None

    @property
    def leads(self) -> bool:
        """Return whether the largest contribution is large."""
        leader = self.leader
        if leader is None or (leader.share_of_variance and leader.value < SMALL):
            return False
        return self.of_event or not self.may_be_overturned

    @property
    def of_event(self) -> bool:
        """Return whether the target is an event."""
        return self.target.startswith("P(")

    @property
    def may_be_overturned(self) -> bool:
        """Return whether another input may contribute more, with interactions, than the leader.

        A total index is at most the first-order index plus the variance that no single input
        explains.
        """
        if self.leader is None or isnan(self.unexplained.value):
            return False
        if self.totals:
            return next(iter(self.totals)) not in self.leader.sure
        most = self.unexplained.high if self.unexplained.has_interval else self.unexplained.value
        return most > max(self.leader.value - self.runner_up, 0.0) and most > SMALL

    @property
    def denies_a_leader(self) -> bool:
        """Return whether, with confidence, no single input contributes much."""
        return self.is_flat or (self.leader is not None and not self.leads)

    @property
    def sentence(self) -> str:
        """The leading contribution, or the reason why it is unknown."""
        if self.reason:
            return sentence(self.reason)
        leader = self.leader
        if leader is None:
            return ""
        if leader.share_of_variance and leader.value < SMALL:
            text = f"No single input explains much: {leader.words} {leader.size}{self._of}."
            return " ".join(filter(None, (text, self.beyond_single)))
        verb = "contribute" if len(leader.inputs) > 1 else "contributes"
        if leader.doubtful:
            verb = "may contribute"
        alone = " alone" * self.may_be_overturned
        text = f"{capitalized(leader.words)}{alone} {verb} most: {leader.size}{self._of}."
        return " ".join(filter(None, (text, self.beyond_single)))

    @property
    def beyond_single(self) -> str:
        """Share that no single input explains, if it could change the order; else ""."""
        if not self.may_be_overturned or self.of_event:
            return ""
        text = f"Single inputs leave {whole_percent(self.unexplained)} unexplained"
        if not self.totals:
            return f"{text}: interactions could change the order; {self.remedy}."
        first = [(name, total) for name, total in self.totals.items()][:2]
        named = joined([f"{called(name)} {100 * min(total, 1.0):.0f} %" for name, total in first])
        return f"{text}; the largest total contributions, with interactions, are {named} (HDMR)."

    @property
    def _of(self) -> str:
        return f" of {self.share_of}" if self.share_of else ""

    @property
    def with_effect(self) -> str:
        """The leading contribution, with direction and size."""
        effect = self.leader.effect if self.leader is not None and self.leads else ""
        return " ".join(filter(None, (self.sentence, effect and sentence(effect))))
