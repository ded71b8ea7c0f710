"""Shares of single inputs and groups, with directions, sizes and sentences."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from math import expm1, log1p

from uq.assess.answer.compared_indices import Measured, are_tied
from uq.assess.answer.wording import (
    DisplayUnit,
    called,
    called_together,
    joined,
    twin_of,
)
from uq.assess.chosen_targets import chosen
from uq.assess.effects import Effect, effects
from uq.assess.fact import Fact
from uq.assess.findings import Findings
from uq.assess.targets import IndexTarget, split_name
from uq.indices.index import IndexKind
from uq.result.result import Result
from uq.stats import estimate_json
from uq.stats.estimate import NOTHING, Estimate
from uq.study.file import Tied

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


ALIKE = 0.5
"""Twins are listed together if the ratio of the smaller index to the larger is at least this."""


_STEPS = (0.1, 0.01, 0.001)


_SMALL_CHANGE = 0.1  # of a probability
_WITHIN = 2.0  # standard deviations that a step may span: a change within the scatter of the input


def groups_of(result: Result, measured: list[Measured]) -> Iterator[list[Measured]]:
    """Yield groups of inputs that are twins or have indistinguishable indices."""
    laws = {
        name: None if isinstance(law, Tied) else law.model_dump(exclude={"source"})
        for name, law in result.study.uncertain.items()
    }

    def are_twins(candidate: Measured, other: Measured) -> bool:
        less, more = sorted((candidate.index.value, other.index.value))
        same = twin_of(candidate.name) == twin_of(other.name) and less >= ALIKE * more
        return (
            same and laws[candidate.name] is not None and laws[candidate.name] == laws[other.name]
        )

    left = list(measured)
    while left:
        first, others = left[0], left[1:]
        tied = [other for other in others if are_tied(first, other)]
        group = [first, *tied]
        group += [
            other
            for other in others
            if other not in group and any(are_twins(other, member) for member in group)
        ]
        yield group
        left = [candidate for candidate in left if candidate not in group]


def effects_of(
    findings: Findings, method: str, name: str, inputs: Sequence[str]
) -> dict[str, Effect]:
    """Return the effects that have an interval; without one, no direction is clear."""
    rows = findings.rows
    targets: list[IndexTarget] = list(chosen(rows, method, [name]))
    if len(targets) != 1:
        return {}
    by_input = effects(targets[0].values, findings.regressors, rows.dependence, inputs)
    return {name: effect for name, effect in by_input.items() if effect.slope.has_interval}


def contribution_of(
    group: Sequence[Measured],
    kind: IndexKind,
    target: str,
    moved: Mapping[str, Effect],
    verbs: tuple[str, str],
    units: Mapping[str, DisplayUnit],
) -> Contribution:
    """Return the contribution of a group of inputs, with directions where all are known."""
    names = tuple(member.name for member in group)
    form = split_name(target)[0]
    changes = tuple(
        _change(moved[name], form, verbs, units[name]) for name in names if name in moved
    )
    return Contribution(
        names,
        tuple(member.index for member in group),
        kind.unit == "variance",
        changes if len(changes) == len(names) else (),
        doubtful=tuple(member.name for member in group if not member.counts),
    )


def _change(
    effect: Effect, form: str, verbs: tuple[str, str], of_input: DisplayUnit
) -> AverageEffect:
    """Return the change of a target with a usual step of an input."""
    if effect.direction == 0 or effect.of_values or form == "rank":
        return AverageEffect(effect.direction, verbs=verbs)
    amount = ""
    if effect.logarithmic:
        most = _WITHIN * effect.sd
        if form == "P":  # a slope holds for small changes of a probability alone
            most = min(most, _SMALL_CHANGE / max(abs(effect.slope.value), _SMALL_CHANGE))
        size = next((s for s in _STEPS if log1p(s) <= most), _STEPS[-1])
        step, by = f"{100 * size:g} %", log1p(size)
    else:
        step, by, amount = "one standard deviation", effect.sd, of_input.text(effect.sd)
    value, low, high = (by * end for end in effect.slope.numbers)
    unit = DisplayUnit()
    if form == "log":
        value, low, high = (100 * expm1(end) for end in (value, low, high))
        unit = DisplayUnit("%")
    elif form == "P":
        value, low, high = 100 * value, 100 * low, 100 * high
        unit = DisplayUnit("percentage points")
    return AverageEffect(effect.direction, step, Estimate(value, low, high), unit, verbs, amount)
