"""Tighter tolerances: what half the scatter of each input would change, by weights of rows."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import hypot, isfinite

import xarray as xr

from uq.assess.answer.contributions import Contribution
from uq.assess.answer.halved_scatter import halvings, halvings_in_words
from uq.assess.answer.parts import Quantity
from uq.assess.answer.remedies import SHARE_OF, Advice, TighterTolerance
from uq.assess.answer.sources import CHOSEN, mark_of
from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.answer.wording import DisplayUnit, twin_of
from uq.assess.targets import split_name
from uq.assess.what_if import answer as weighted
from uq.errors import InputError, RunError
from uq.result.elements import analysis_of
from uq.stats.estimate import Estimate
from uq.study.file import AnalysisTable
from uq.text.keys import key_of

_PARTS = ("quantiles", "thresholds")
_UNKNOWN = "the rows cannot show what it would change"


def tightened(
    ds: xr.Dataset, quantity: Quantity, inputs: Sequence[str]
) -> Iterator[TighterTolerance]:
    """Yield what half the scatter of some inputs would change about a quantity.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    quantity : Quantity
    inputs : sequence of str
        All of them at once.
    """
    known = list(_promised(quantity))
    laws = halvings(ds, inputs)
    if not known or not laws:
        return
    names = tuple(inputs)
    what = TighterTolerance(names, "", law=halvings_in_words(ds, laws))
    changes = {
        f"uncertain.{name}.{key}": value
        for name, arguments in laws.items()
        for key, value in arguments.items()
    }
    try:
        found = weighted(ds, changes, _asked(ds, quantity, [key for key, *_ in known]), _PARTS)
    except (InputError, RunError) as refused:
        yield replace(what, reason=f"{_UNKNOWN} ({refused})")
        return
    described = found.summary.outputs.get(quantity.name)
    for key, words, before, unit, more in known:
        one = described.find(*key) if described is not None else None
        if one is None:
            yield replace(what, what=words, reason=_UNKNOWN)
            continue
        after = one.best.estimate
        if not isfinite(after.value):
            yield replace(what, what=words, reason=f"{_UNKNOWN} ({after.reason})")
            continue
        given = {name: repr(value) for name, value in changes.items()}
        yield replace(
            what,
            what=words,
            before=before,
            after=after,
            is_share=key[0] == "thresholds",
            unit=unit,
            effective_rows=found.effective_rows,
            key=key_of("outputs", quantity.name, *key, verb="what-if", options=given),
            wants_more=more,
            promise=_bounding(quantity, key),
            failed=one.best.failed,
        )


def _asked(ds: xr.Dataset, quantity: Quantity, keys: Sequence[Sequence[str]]) -> AnalysisTable:
    """Return what a study asks for, of this quantity and these quantiles alone."""
    asked = analysis_of(ds, quantity.output)
    wanted = {key[1] for key in keys if key[0] == "quantiles"}
    some = tuple(p for p in asked.quantiles if repr(p) in wanted)
    return asked.model_copy(update={"quantiles": some})


def _bounding(quantity: Quantity, key: Sequence[str]) -> ToleranceBound | None:
    if quantity.promise is None or key[0] != "quantiles":
        return None
    return quantity.promise.of_quantile(float(key[1]))


def _promised(
    quantity: Quantity,
) -> Iterator[tuple[tuple[str, ...], str, Estimate, DisplayUnit, bool | None]]:
    """Yield the numbers that matter: key, words, number, unit, and whether more is better.

    No input is said to move the probability of an event that no single input decides.
    """
    for event in quantity.events:
        if event.ranking is not None and event.ranking.denies_a_leader:
            continue
        side = "below" if "<" in event.name else "above"
        key = ("thresholds", split_name(event.name)[2], side)
        words = SHARE_OF + event.said
        yield key, words, event.share, DisplayUnit(), quantity.wants_more
    promise = quantity.promise
    if promise is None or promise.of_magnitude:  # the quantiles of the rows have a sign
        return
    known = quantity.wants_more
    if quantity.events and known is None:  # which quantile matters is not known
        return
    if quantity.is_life and known is not None:
        known = not known  # more ends are shorter lives
    for p, before in zip(promise.probabilities, promise.quantiles, strict=True):
        if isfinite(before.value):
            words = f"the {100 * p:g} % quantile"
            yield ("quantiles", repr(p)), words, before, promise.unit, known


MOST = 4
"""Tolerances that are compared, of the inputs that contribute most."""

ABOUT = 0.75
"""Of the gain of the best tolerance, the least that counts as about as much."""


def tighten(ds: xr.Dataset, quantity: Quantity, leader: Contribution) -> Iterator[Advice]:
    """Yield which tolerance to tighten, which would help about as much, and all that are known.

    Parameters
    ----------
    ds : xarray.Dataset
        A result.
    quantity : Quantity
        What the study is about.
    leader : Contribution
        What contributes most: its number is the one that all are compared by.
    """
    found = [_shown(ds, quantity, one) for one in _candidates(ds, quantity, leader)]
    known = [one for each in found for one in each if not one.reason]
    better = [one for one in known if one.helps and one.is_seen and not one.may_stay]
    if not better:
        unknown = [one for one in found[0] if one.reason]
        yield from (
            Advice("tighten", one.sentence, one.inputs, tightened=one) for one in unknown[:1]
        )
        return
    compared = [one for one in better if one.what == better[0].what]
    best, *others = compared[:1]
    if best.wants_more is not None:
        best, *others = sorted(compared, key=lambda one: -one.gain)
    yield Advice(
        "tighten",
        best.sentence,
        best.inputs,
        tightened=best,
        key=best.key,
        alike=tuple(one for one in others if _is_alike(best, one)),
        tolerances=tuple(known),
    )


def twins(leader: Contribution) -> tuple[str, ...]:
    """Return the first of the inputs that lead, and its twins among them."""
    return tuple(one for one in leader.sure if twin_of(one) == twin_of(leader.inputs[0]))


def _candidates(ds: xr.Dataset, quantity: Quantity, leader: Contribution) -> list[Contribution]:
    """Return what contributes and is not chosen, no input named twice, the leader first."""
    rankings = [event.ranking for event in quantity.events] + [quantity.ranking]
    every = [one for ranking in rankings if ranking is not None for one in ranking.contributions]
    found = [leader]
    for one in every:
        if any(mark_of(ds, name) == CHOSEN for name in one.inputs):
            continue
        if not any(set(one.inputs) & set(other.inputs) for other in found):
            found.append(one)
    return found[:MOST]


def _shown(ds: xr.Dataset, quantity: Quantity, of: Contribution) -> Sequence[TighterTolerance]:
    """Return what half the scatter of inputs would change, of as many as the rows can show."""
    found: list[TighterTolerance] = []
    for inputs in dict.fromkeys((of.sure, twins(of), of.inputs[:1])):
        found = list(tightened(ds, quantity, inputs))
        if any(not one.reason for one in found):
            break
    return found


def _is_alike(best: TighterTolerance, other: TighterTolerance) -> bool:
    """Return whether another tolerance helps about as much, or the rows cannot distinguish them."""
    if other.gain >= ABOUT * best.gain:
        return True
    return best.gain - other.gain <= hypot(best.half, other.half)
