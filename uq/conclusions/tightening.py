"""What half the scatter of an input would change, from the rows that exist: they are weighted."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isfinite

import xarray as xr

from uq.analysis.what_if import answer as weighted
from uq.conclusions.halving import halvings, halvings_in_words
from uq.conclusions.parts import Quantity
from uq.conclusions.promises import Promise
from uq.conclusions.remedies import SHARE_OF, Tightened
from uq.conclusions.words import Unit
from uq.errors import InputError, RunError
from uq.estimate import Estimate
from uq.indices.targets import split_name
from uq.keys import key_of
from uq.rows.elements import analysis_of
from uq.study.file import AnalysisTable

_PARTS = ("quantiles", "thresholds")
_UNKNOWN = "the rows cannot show what it would change"


def tightened(ds: xr.Dataset, quantity: Quantity, inputs: Sequence[str]) -> Iterator[Tightened]:
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
    what = Tightened(names, "", law=halvings_in_words(ds, laws))
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


def _bounding(quantity: Quantity, key: Sequence[str]) -> Promise | None:
    if quantity.promise is None or key[0] != "quantiles":
        return None
    return quantity.promise.of_quantile(float(key[1]))


def _promised(
    quantity: Quantity,
) -> Iterator[tuple[tuple[str, ...], str, Estimate, Unit, bool | None]]:
    """Yield the numbers that matter: key, words, number, unit, and whether more is better.

    No input is said to move the probability of an event that no single input decides.
    """
    for event in quantity.events:
        if event.ranking is not None and event.ranking.denies_a_leader:
            continue
        side = "below" if "<" in event.name else "above"
        key = ("thresholds", split_name(event.name)[2], side)
        words = SHARE_OF + event.said
        yield key, words, event.share, Unit(), quantity.wants_more
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
