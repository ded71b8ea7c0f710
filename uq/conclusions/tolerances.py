"""Which tolerance to tighten: what half the scatter of each input would change, and the best."""

from collections.abc import Iterator, Sequence
from math import hypot

import xarray as xr

from uq.conclusions.contributions import Contribution
from uq.conclusions.parts import Quantity
from uq.conclusions.remedies import Advice, Tightened
from uq.conclusions.sources import CHOSEN, mark_of
from uq.conclusions.tightening import tightened
from uq.conclusions.words import twin_of

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


def _shown(ds: xr.Dataset, quantity: Quantity, of: Contribution) -> Sequence[Tightened]:
    """Return what half the scatter of inputs would change, of as many as the rows can show."""
    found: list[Tightened] = []
    for inputs in dict.fromkeys((of.sure, twins(of), of.inputs[:1])):
        found = list(tightened(ds, quantity, inputs))
        if any(not one.reason for one in found):
            break
    return found


def _is_alike(best: Tightened, other: Tightened) -> bool:
    """Return whether another tolerance helps about as much, or the rows cannot distinguish them."""
    if other.gain >= ABOUT * best.gain:
        return True
    return best.gain - other.gain <= hypot(best.half, other.half)
