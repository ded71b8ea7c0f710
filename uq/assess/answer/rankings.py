"""Ranking of inputs by their contribution to a target, with its sentences."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import isfinite, isnan, nan
from typing import Any

from uq.assess.answer.compared_indices import AGAIN, Measured, are_tied, measured_inputs, method_for
from uq.assess.answer.contributions import (
    EXPANSION,
    SMALL,
    Contribution,
    contribution_of,
    effects_of,
    groups_of,
    whole_percent,
)
from uq.assess.answer.wording import DisplayUnit, called, joined, sentence, twin_of, unit_of_input
from uq.assess.fact import Fact
from uq.assess.findings import Findings
from uq.assess.row_inputs import why_dependent
from uq.assess.targets import FORMS, number_of, split_name, transformed_if_heavy
from uq.errors import InputError, choices
from uq.indices.index import S1, ST, IndexKind, Indices
from uq.indices.methods import METHODS, fed_by, indices_of
from uq.result.elements import Element
from uq.result.result import Result
from uq.stats import estimate_json
from uq.stats.estimate import NOTHING, Estimate
from uq.text.numbers import capitalized, grouped

GOAL = 0.1
"""Half-width at which an index is settled; relative to the largest index if it has a unit."""

MOST_TIED = 3
"""With more indistinguishable inputs than this, there is no ranking."""


LEAST = 0.01
"""A smaller index is not listed."""

MOSTLY = 0.5
"""If single inputs certainly leave more unexplained, indices S1 that are alike order no inputs."""

BY_DEPENDENCE = "hsic-target"
"""Method that sees an input that moves an event from both sides."""


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
    alone = unexplained(target_indices.indices) if kind == S1 and len(kinds) == 1 else NOTHING
    interacting = None
    if alone.low > MOSTLY:
        reason, is_flat = _left_to_interactions(findings, name, measured[0], alone)
        interacting = Ranking(name, method, kind.key, meaning, (), reason, is_flat=is_flat)
    if not measured[0].counts:
        if interacting is not None:
            return interacting
        reason, factor, is_flat = _unsettled(measured[0], kind, split_name(name)[0] == "P")
        needed = target_indices.indices.rows_factors.get(measured[0].name, 1.0)
        if needed > 1:
            factor = max(factor, needed)
        return Ranking(name, method, kind.key, meaning, (), reason, factor, is_flat)
    # An index that does not exceed the limit without effect may still equal the first.
    weighed = [
        candidate for candidate in measured if candidate.counts or are_tied(measured[0], candidate)
    ]
    groups = list(groups_of(findings.result, weighed))
    if len({twin_of(member.name) for member in groups[0]}) > MOST_TIED:
        if interacting is not None:
            return interacting
        names = choices((called(member.name) for member in groups[0]), MOST_TIED + 1)
        first, second = groups[0][0], groups[0][MOST_TIED]
        apart = max(first.index.value - second.index.value, GOAL * _scale(first, kind) / 2)
        factor = (first.apart(second) / apart) ** 2
        with_shares = names
        if kind.unit == "variance":
            with_shares = choices(
                (
                    f"{called(member.name)} ({max(100 * member.index.value, 0):.0f} %)"
                    for member in groups[0]
                ),
                MOST_TIED,
            )
        reason, is_flat = f"the order of {with_shares} is not settled", False
        if factor <= 1:  # the rows distinguish larger differences
            is_flat = kind.unit == "variance" and first.index.value < SMALL
            reason, factor = _alike(names, first, kind, is_flat), nan
        return Ranking(name, method, kind.key, meaning, (), reason, factor, is_flat)
    least = LEAST * _scale(measured[0], kind)
    listed = [group for group in groups if group[0].index.value >= least]
    moved = effects_of(
        findings, method, name, [member.name for group in listed for member in group]
    )
    units = {label: unit_of_input(findings.result, label) for label in moved}
    contributions = tuple(
        contribution_of(group, kind, name, moved, verbs, units) for group in listed
    )
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
    return tuple(candidate.name for candidate in measured if are_tied(first, candidate, AGAIN))


_SHARES = {"S1": "the share (S1)", "ST": "the total share (ST)"}


def _unsettled(first: Measured, kind: IndexKind, of_event: bool) -> tuple[str, float, bool]:
    """Return the reason why no index counts, the factor on the rows, and whether none is large."""
    name = _SHARES.get(kind.key, kind.key)
    text = f"{name} of {called(first.name)} is {first.index.value:z.2f}"
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


def _left_to_interactions(
    findings: Findings, name: str, first: Measured, alone: Estimate
) -> tuple[str, bool]:
    """Return a clause: single inputs leave most unexplained; and whether that denies a leader.

    Of an event it does not: an input may raise its probability at either end of its law.
    """
    text = f"no single input explains much alone: S1 is at most {first.index.value:.2f}"
    remedy, of_event = "a 'saltelli' design shows whether inputs interact", name.startswith("P(")
    if of_event and BY_DEPENDENCE in fed_by(findings.result.design):
        remedy = f"method {BY_DEPENDENCE} shows which inputs matter"
    clause = f"{text}, and single inputs leave {whole_percent(alone)} unexplained; {remedy}"
    return clause, first.index.value < SMALL and not of_event


def _alike(names: str, first: Measured, kind: IndexKind, is_flat: bool) -> str:
    """Return a clause: inputs contribute about equally, or none contributes much."""
    most = f"at most {first.index.value:.2f}"
    if is_flat:
        return f"no single input explains much: {kind.key} of {names} is {most}"
    return f"{names} contribute about equally: {kind.key} is {most}"


def ranking_of_element(findings: Findings, element: Element, unit: DisplayUnit) -> Ranking | None:
    """Return the ranking of the inputs of an element of an output; None if no method feeds it."""
    method = method_for(findings.result, event=False)
    if method is None:
        return None
    target = number_of(element)
    name = (target if METHODS[method].scale_free else transformed_if_heavy(target)).name
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
