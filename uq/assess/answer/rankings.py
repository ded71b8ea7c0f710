"""Ranking of inputs for a target; indistinguishable inputs are grouped."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from math import expm1, isfinite, log1p, nan

from uq.assess.answer.contributions import (
    EXPANSION,
    SMALL,
    AverageEffect,
    Contribution,
    Ranking,
)
from uq.assess.answer.measured_indices import Measured, measured_inputs
from uq.assess.answer.repeat_interval import AGAIN
from uq.assess.answer.wording import DisplayUnit, called, twin_of, unit_of_input
from uq.assess.chosen_targets import chosen
from uq.assess.effects import Effect, effects
from uq.assess.findings import Findings
from uq.assess.row_inputs import independent_inputs, why_dependent
from uq.assess.targets import FORMS, IndexTarget, split_name
from uq.errors import choices
from uq.indices.index import S1, ST, IndexKind, Indices
from uq.indices.methods import fed_by
from uq.result.result import Result
from uq.stats.estimate import Estimate
from uq.study.file import Tied

GOAL = 0.1
"""Half-width at which an index is settled; relative to the largest index if it has a unit."""

MOST_TIED = 3
"""With more indistinguishable inputs than this, there is no ranking."""

ALIKE = 0.5
"""Twins are listed together if the ratio of the smaller index to the larger is at least this."""

LEAST = 0.01
"""A smaller index is not listed."""

_STEPS = (0.1, 0.01, 0.001)
_WITHIN = 4.0  # standard deviations that a step may span


def ranking_of(findings: Findings, name: str, method: str, verbs: tuple[str, str]) -> Ranking:
    """Return the ranking of the inputs of a target.

    Parameters
    ----------
    findings : Findings
        Of a result; its `ranked` rows decide.
    name : str
        Of a target.
    method : str
    verbs : tuple of str
        Verbs for a fall and a rise of the target.

    Returns
    -------
    Ranking
    """
    ranking = _ranking(findings.ranked, name, method, verbs)
    by = findings.result.ranked_in_words
    if not by:
        return ranking
    reason = f"{ranking.reason} ({by})" if ranking.reason else ""
    return replace(
        ranking, index_meaning=f"{ranking.index_meaning}, {by}", reason=reason, rows_factor=nan
    )


def _ranking(findings: Findings, name: str, method: str, verbs: tuple[str, str]) -> Ranking:
    target_indices = findings.indices(method, name)
    if target_indices.refused:
        why = f"no ranking of the inputs: {target_indices.refused}"
        return Ranking(name, method, reason=why, rows_factor=target_indices.rows_factor)
    kinds = target_indices.kinds()
    kind = list(kinds)[-1]
    measured = list(measured_inputs(findings.result, method, name, kind, target_indices))
    form = FORMS.get(split_name(name)[0])
    of_form = f" of the {form}" if form else ""
    share = f"share of the variance{of_form}, " if kind.unit == "variance" else ""
    by = "" if method in kind.words.lower() else f", by {method}"
    meaning = f"{share}{kind.words}{'' if share else of_form}{by}"
    if not measured[0].counts:
        reason, factor, is_flat = _unsettled(measured[0], kind, split_name(name)[0] == "P")
        needed = target_indices.indices.rows_factors.get(measured[0].name, 1.0)
        if needed > 1:
            factor = max(factor, needed)
        return Ranking(name, method, kind.key, meaning, (), reason, factor, is_flat)
    # An index that does not exceed the limit without effect may still equal the first.
    weighed = [
        candidate for candidate in measured if candidate.counts or _are_tied(measured[0], candidate)
    ]
    groups = list(_groups(findings.result, weighed))
    if len({twin_of(member.name) for member in groups[0]}) > MOST_TIED:
        names = choices((called(member.name) for member in groups[0]), MOST_TIED + 1)
        first, second = groups[0][0], groups[0][MOST_TIED]
        apart = max(first.index.value - second.index.value, GOAL * _scale(first, kind) / 2)
        factor = (first.apart(second) / apart) ** 2
        reason, is_flat = f"the order of {names} is not settled", False
        if factor <= 1:  # the rows distinguish larger differences
            is_flat = kind.unit == "variance" and first.index.value < SMALL
            reason, factor = _alike(names, first, kind, is_flat), nan
        return Ranking(name, method, kind.key, meaning, (), reason, factor, is_flat)
    least = LEAST * _scale(measured[0], kind)
    listed = [group for group in groups if group[0].index.value >= least]
    moved = _effects(findings, method, name, [member.name for group in listed for member in group])
    units = {label: unit_of_input(findings.result, label) for label in moved}
    contributions = tuple(_contribution(group, kind, name, moved, verbs, units) for group in listed)
    is_share = kind.unit == "variance" and split_name(name)[0] != "P"
    of_what = (f"the variance of the {form}" if form else "the variance") if is_share else ""
    rivals = _rivals(measured)
    ranking = Ranking(
        name, method, kind.key, meaning, contributions, rivals=rivals, share_of=of_what
    )
    if kind != S1 or len(kinds) > 1:
        return ranking
    behind = (candidate.index.value for candidate in measured if candidate not in groups[0])
    ranking = replace(
        ranking,
        unexplained=unexplained(target_indices.indices),
        runner_up=max(behind, default=0.0),
        remedy="a 'saltelli' design shows them",
    )
    if ranking.may_be_overturned and not ranking.of_event:
        ranking = replace(ranking, totals=_totals(findings, name))
    return ranking


def unexplained(indices: Indices) -> Estimate:
    """Return the share of the variance that no single input explains.

    Parameters
    ----------
    indices : Indices
        With first-order indices of all inputs.
    """
    if indices.unexplained.has_interval:
        return indices.unexplained
    return Estimate(1 - sum(index.value for index in indices.values[S1].values()))


def _totals(findings: Findings, name: str) -> dict[str, float]:
    """Return the total indices, the largest first, of an expansion that represents the rows."""
    dependent = bool(why_dependent(findings.result))
    if EXPANSION not in fed_by(findings.result.design, dependent):
        return {}
    expansion = findings.indices(EXPANSION, name)
    values = {} if expansion.refused else expansion.indices.values[ST]
    return {label: values[label].value for label in sorted(values, key=lambda x: -values[x].value)}


def _scale(first: Measured, kind: IndexKind) -> float:
    """Return the reference of an index: the largest, if in the unit of the output, else 1."""
    return abs(first.index.value) if kind.unit == "output" else 1.0


def _rivals(measured: Sequence[Measured]) -> tuple[str, ...]:
    """Return the inputs that may rank first in a repeat with another seed, at 95 % confidence.

    None without another input, or if errors are unknown.
    """
    first = measured[0]
    if len(measured) == 1 or not all(isfinite(candidate.half) for candidate in measured):
        return ()
    return tuple(candidate.name for candidate in measured if _are_tied(first, candidate, AGAIN))


def _unsettled(first: Measured, kind: IndexKind, of_event: bool) -> tuple[str, float, bool]:
    """Return the reason why no index counts, the factor on the rows, and whether none is large."""
    text = f"{kind.key} of {called(first.name)} is {first.index.value:z.2f}"
    which = f"the {'main driver' if of_event else 'ranking of the inputs'} is not settled"
    if not isfinite(first.half):
        return f"{which}: {text}, without an interval", nan, False
    goal = GOAL * _scale(first, kind)
    if first.index.reason:
        return f"{which}: {text}, and {first.index.reason}", (first.half / goal) ** 2, False
    if first.half > goal:
        ends = f"{first.index.low:z.2f} to {first.index.high:z.2f}"
        interval = f" ({ends})" if first.index.has_interval else ""
        return f"{which}: {text}{interval}", (first.half / goal) ** 2, False
    largest = f"the largest {kind.key} is {first.index.value:z.2f} ({called(first.name)})"
    return f"no single input contributes measurably: {largest}", nan, True


def _alike(names: str, first: Measured, kind: IndexKind, is_flat: bool) -> str:
    """Return a clause: inputs contribute about equally, or none contributes much."""
    most = f"at most {first.index.value:.2f}"
    if is_flat:
        return f"no single input explains much: {kind.key} of {names} is {most}"
    return f"{names} contribute about equally: {kind.key} is {most}"


def _groups(result: Result, measured: list[Measured]) -> Iterator[list[Measured]]:
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
        tied = [other for other in others if _are_tied(first, other)]
        group = [first, *tied]
        group += [
            other
            for other in others
            if other not in group and any(are_twins(other, member) for member in group)
        ]
        yield group
        left = [candidate for candidate in left if candidate not in group]


def _are_tied(first: Measured, other: Measured, times: float = 1.0) -> bool:
    """Return whether another input may have as large an index, errors multiplied by `times`."""
    return first.index.value - other.index.value <= times * first.apart(other)


def _effects(
    findings: Findings, method: str, name: str, inputs: Sequence[str]
) -> dict[str, Effect]:
    """Return the effects that have an interval; without one, no direction is clear."""
    rows = findings.rows
    targets: list[IndexTarget] = list(chosen(rows, method, [name]))
    if len(targets) != 1:
        return {}
    columns, part = independent_inputs(rows), rows.replicates
    by_input = effects(targets[0].values, columns, part, inputs)
    return {name: effect for name, effect in by_input.items() if effect.slope.has_interval}


def _contribution(
    group: Sequence[Measured],
    kind: IndexKind,
    target: str,
    moved: Mapping[str, Effect],
    verbs: tuple[str, str],
    units: Mapping[str, DisplayUnit],
) -> Contribution:
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
        size = next((s for s in _STEPS if log1p(s) <= _WITHIN * effect.sd), _STEPS[-1])
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
