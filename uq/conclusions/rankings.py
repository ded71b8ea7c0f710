"""Which inputs contribute most to a target; those that cannot be distinguished stand together."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import expm1, hypot, isfinite, log1p, nan

import numpy as np
import xarray as xr

from uq.analysis.effects import Effect, effects
from uq.analysis.findings import Findings
from uq.conclusions.contributions import Change, Contribution, Ranking
from uq.conclusions.repeated import AGAIN
from uq.conclusions.words import Unit, called, twin_of
from uq.designs.layouts import PLAIN
from uq.designs.registry import DESIGNS
from uq.errors import choices
from uq.estimate import Estimate
from uq.indices.chosen import chosen
from uq.indices.independent_inputs import independent_inputs, why_dependent
from uq.indices.samples import sample_of
from uq.indices.sensitivities import TargetIndices, methods
from uq.indices.targets import FORMS, Target, split_name
from uq.intervals import scatter_interval
from uq.methods.given_data import MIN_ROWS
from uq.methods.indices import IndexKind, Null, RefusedError
from uq.methods.method import Method
from uq.methods.registry import METHODS, fed_by
from uq.rows.elements import has_independent_samples, replicates_of, study_file_of
from uq.rows.nesting import one_of_each_sample
from uq.rows.weights import has_weights
from uq.study.file import Tied
from uq.wording import rows_in_words

GOAL = 0.1
"""Half-width of the interval of an index at which it counts as known."""

MOST_TIED = 3
"""With more indistinguishable inputs than this, there is no ranking."""

ALIKE = 0.5
"""Twins stand together if the index of one is at least this part of that of the other."""

LEAST = 0.01
"""A smaller index is not listed."""

_PARTS = 8
_FEWEST_PARTS = 4
_STEPS = (0.1, 0.01, 0.001)
_WITHIN = 4.0  # standard deviations that a step may span


@dataclass(frozen=True)
class Measured:
    """The index of one input.

    Attributes
    ----------
    name : str
    index : Estimate
        With an interval where one is known.
    half : float
        Half the width of its interval, or what tells it from another.
    counts : bool
        Whether it is larger than those of inputs without effect.
    """

    name: str
    index: Estimate
    half: float
    counts: bool


def method_for(ds: xr.Dataset, event: bool) -> str | None:
    """Return the method that ranks: the first that the study asks for, or that its design feeds.

    Of an event first those whose index has a scale of its own: others, as PAWN, cannot exceed the
    probability of a rare one. None for rows with weights.
    """
    if has_weights(ds):
        return None
    fed = fed_by(DESIGNS[ds.attrs["design"]], bool(why_dependent(ds)))
    found = [name for name in (*methods(ds), *fed) if name in fed]
    known = [name for name in found if not METHODS[name].conditional]
    if not event:
        return next((name for name in known if METHODS[name].takes_numbers), None)
    of_events = [name for name in known if METHODS[name].takes_events]
    return min(of_events, key=lambda name: not _has_scale(METHODS[name]), default=None)


def _has_scale(method: Method) -> bool:
    return method.of_variance or not method.takes_numbers


def ranking_of(findings: Findings, name: str, method: str, verbs: tuple[str, str]) -> Ranking:
    """Return which inputs contribute to a target.

    Parameters
    ----------
    findings : Findings
        Of a result; its `ranked` rows decide.
    name : str
        Of a target.
    method : str
    verbs : tuple of str
        What a fall and a rise of the target is called.

    Returns
    -------
    Ranking
    """
    ranking = _ranking(findings.ranked, name, method, verbs)
    if findings.ranked is findings:
        return ranking
    by = f"by the first {rows_in_words(findings.ranked.ds.sizes['sample'])} rows"
    reason = f"{ranking.reason} ({by})" if ranking.reason else ""
    return replace(ranking, what=f"{ranking.what}, {by}", reason=reason, rows_factor=nan)


def _ranking(findings: Findings, name: str, method: str, verbs: tuple[str, str]) -> Ranking:
    found = findings.indices(method, name)
    if found.refused:
        why = f"no ranking of the inputs: {found.refused}"
        return Ranking(name, method, reason=why, rows_factor=found.rows_factor)
    kinds = found.kinds()
    kind = list(kinds)[-1]
    measured = list(_measured(findings.ds, method, name, kind, found))
    form = FORMS.get(split_name(name)[0])
    of = f" of the {form}" if form else ""
    share = f"share of the variance{of}, " if kind.unit == "variance" else ""
    what = f"{share}{kind.words}{'' if share else of}, by {method}"
    if not measured[0].counts:
        reason, factor, is_flat = _unsettled(measured[0], kind, split_name(name)[0] == "P")
        return Ranking(name, method, kind.key, what, (), reason, factor, is_flat)
    # What does not exceed inputs without effect may yet contribute as much as the first.
    weighed = [one for one in measured if one.counts or _are_tied(measured[0], one)]
    groups = list(_groups(findings.ds, weighed))
    if len({twin_of(one.name) for one in groups[0]}) > MOST_TIED:
        names = choices((called(one.name) for one in groups[0]), MOST_TIED + 1)
        first, second = groups[0][0], groups[0][MOST_TIED]
        apart = max(first.index.value - second.index.value, GOAL / 2)
        factor = (hypot(first.half, second.half) / apart) ** 2
        reason = f"the order of {names} is not settled"
        return Ranking(name, method, kind.key, what, reason=reason, rows_factor=factor)
    moved = _effects(findings, method, name)
    contributions = tuple(
        _contribution(group, kind, name, moved, verbs)
        for group in groups
        if group[0].index.value >= LEAST
    )
    return Ranking(name, method, kind.key, what, contributions, rivals=_rivals(measured))


def _rivals(measured: Sequence[Measured]) -> tuple[str, ...]:
    """Return the inputs of which one would contribute most with another seed, with 95 %.

    None where there is no other, or nothing tells them apart.
    """
    first = measured[0]
    if len(measured) == 1 or not all(isfinite(one.half) for one in measured):
        return ()
    return tuple(one.name for one in measured if _are_tied(first, one, AGAIN))


def _unsettled(first: Measured, kind: IndexKind, of_event: bool) -> tuple[str, float, bool]:
    """Return why no index counts, how many times the rows would settle it, and if none is large."""
    text = f"{kind.key} of {called(first.name)} is {first.index.value:.2f}"
    which = f"which inputs {'decide that' if of_event else 'matter'} is not settled"
    if not isfinite(first.half):
        return f"{which}: {text}, without an interval", nan, False
    if first.half > GOAL:
        ends = f"{first.index.low:.2f} to {first.index.high:.2f}"
        interval = f" ({ends})" if first.index.has_interval else ""
        return f"{which}: {text}{interval}", (first.half / GOAL) ** 2, False
    verb = "decides that" if of_event else "contributes"
    return f"no single input {verb} measurably: {text} at most", nan, True


def _measured(
    ds: xr.Dataset, method: str, name: str, kind: IndexKind, found: TargetIndices
) -> Iterator[Measured]:
    """Yield the indices of one kind, the largest first, of inputs with an effect of their own."""
    every, borrowed = found.kinds()[kind], found.indices.by_correlation
    values = {label: one for label, one in every.items() if label not in borrowed} or every
    null = found.indices.nulls.get(kind, Null(nan))
    limit = null.largest if isfinite(null.largest) else null.one
    parts = {} if any(one.has_interval for one in values.values()) else _parts(ds, method, name)
    scatter = parts.get(kind.key, {})
    known = sorted(values, key=lambda label: -_size(values[label]))
    # Where no other input has an effect in any row, it is certain without an interval.
    alone = kind.unit == "variance" and all(values[label].value == 0 for label in known[1:])
    for label in known:
        one = values[label]
        if not isfinite(one.value):
            continue
        half = (one.high - one.low) / 2 if one.has_interval else null.one
        if label in scatter:
            low, high = scatter_interval(one.value, np.array(scatter[label]))
            half = (high - low) / 2
            # Estimates from fewer rows may be biased, which only shares of the variance are not.
            one = Estimate(one.value, low, high) if kind.unit == "variance" else one
        counts = one.value > limit if isfinite(limit) else one.low > 0
        counts |= alone and one.value > 0 and not one.has_interval
        yield Measured(label, one, half, bool(counts and not one.low <= 0))


def _size(one: Estimate) -> float:
    return one.value if isfinite(one.value) else -1.0


def _parts(ds: xr.Dataset, method: str, name: str) -> dict[str, dict[str, list[float]]]:
    """Return the indices from independent parts of the rows: kind -> input -> one of each part."""
    if DESIGNS[ds.attrs["design"]].layout is not PLAIN:
        return {}
    ds = one_of_each_sample(ds)
    (target,) = chosen(ds, method, [name])
    sample = replace(sample_of(ds), values=target.values)
    rows = np.flatnonzero(sample.whole)
    if (most := METHODS[method].most_rows) and len(rows) > most:
        rows = np.sort(np.random.default_rng(0).choice(rows, most, replace=False))
    if has_independent_samples(ds):
        part = np.arange(len(rows)) % max(min(_PARTS, len(rows) // MIN_ROWS), 1)
    else:
        part = ds["replicate"].values[rows]
    found: dict[str, dict[str, list[float]]] = {}
    if len(np.unique(part)) < _FEWEST_PARTS:
        return found
    for one in np.unique(part):
        try:
            indices = METHODS[method].indices(sample.rows(rows[part == one]))
        except RefusedError:
            return {}
        for kind, values in indices.values.items():
            for label, index in values.items():
                found.setdefault(kind.key, {}).setdefault(label, []).append(index.value)
    return found


def _groups(ds: xr.Dataset, measured: list[Measured]) -> Iterator[list[Measured]]:
    """Yield inputs together that are twins or whose indices do not distinguish them."""
    laws = {
        name: None if isinstance(one, Tied) else one.model_dump(exclude={"source"})
        for name, one in study_file_of(ds).uncertain.items()
    }

    def are_twins(one: Measured, other: Measured) -> bool:
        less, more = sorted((one.index.value, other.index.value))
        same = twin_of(one.name) == twin_of(other.name) and less >= ALIKE * more
        return same and laws[one.name] is not None and laws[one.name] == laws[other.name]

    left = list(measured)
    while left:
        first, others = left[0], left[1:]
        tied = [one for one in others if _are_tied(first, one)]
        group = [first, *tied]
        group += [
            one for one in others if one not in group and any(are_twins(one, of) for of in group)
        ]
        yield group
        left = [one for one in left if one not in group]


def _are_tied(first: Measured, other: Measured, times: float = 1.0) -> bool:
    """Return whether another input may have as large an index, errors multiplied by `times`."""
    return first.index.value - other.index.value <= times * hypot(first.half, other.half)


def _effects(findings: Findings, method: str, name: str) -> dict[str, Effect]:
    """Return the effects that have an interval; without one, no direction is clear."""
    rows = findings.rows
    targets: list[Target] = list(chosen(rows, method, [name]))
    if len(targets) != 1:
        return {}
    found = effects(targets[0].values, independent_inputs(rows), replicates_of(rows))
    return {name: one for name, one in found.items() if one.slope.has_interval}


def _contribution(
    group: Sequence[Measured],
    kind: IndexKind,
    target: str,
    moved: Mapping[str, Effect],
    verbs: tuple[str, str],
) -> Contribution:
    names = tuple(one.name for one in group)
    form = split_name(target)[0]
    changes = tuple(_change(moved[name], form, verbs) for name in names if name in moved)
    return Contribution(
        names,
        tuple(one.index for one in group),
        kind.unit == "variance",
        changes if len(changes) == len(names) else (),
    )


def _change(effect: Effect, form: str, verbs: tuple[str, str]) -> Change:
    """Return the change of a target with a usual step of an input."""
    if effect.direction == 0 or form == "rank":
        return Change(effect.direction, verbs=verbs)
    if effect.logarithmic:
        size = next((s for s in _STEPS if log1p(s) <= _WITHIN * effect.sd), _STEPS[-1])
        step, by = f"{100 * size:g} %", log1p(size)
    else:
        step, by = "one standard deviation", effect.sd
    value, low, high = (by * one for one in effect.slope.numbers)
    unit = Unit()
    if form == "log":
        value, low, high = (100 * expm1(one) for one in (value, low, high))
        unit = Unit("%")
    elif form == "P":
        value, low, high = 100 * value, 100 * low, 100 * high
        unit = Unit("percentage points")
    return Change(effect.direction, step, Estimate(value, low, high), unit, verbs)
