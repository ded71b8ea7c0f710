"""What half the scatter of an input would change, from the rows that exist: they are weighted."""

from collections.abc import Iterator, Sequence
from math import isfinite, sqrt

import xarray as xr

from uq.analysis.what_if import answer as weighted
from uq.conclusions.parts import Quantity
from uq.conclusions.remedies import Tightened
from uq.conclusions.words import Unit
from uq.errors import InputError, RunError
from uq.estimate import Estimate
from uq.indices.targets import split_name
from uq.inputs.distributions import LogUniform
from uq.inputs.law import Law
from uq.keys import key_of
from uq.rows.elements import study_file_of
from uq.study.file import Tied

_WIDTHS = ("sd", "cv", "sigma")


def halved(law: Law) -> dict[str, float]:
    """Return the arguments that give a law half its scatter about its middle; none if unknown.

    Parameters
    ----------
    law : Law
    """
    for name in _WIDTHS:
        if (width := getattr(law, name, None)) is not None:
            return {name: width / 2}
    lower, upper = getattr(law, "lower", None), getattr(law, "upper", None)
    if lower is None or upper is None:
        return {}
    if isinstance(law, LogUniform):
        centre, ratio = sqrt(lower * upper), (upper / lower) ** 0.25
        return {"lower": centre / ratio, "upper": centre * ratio}
    mode: float | None = getattr(law, "mode", None)
    middle = (lower + upper) / 2 if mode is None else mode
    return {"lower": (lower + middle) / 2, "upper": (upper + middle) / 2}


def changes_of(ds: xr.Dataset, quantity: Quantity, inputs: Sequence[str]) -> dict[str, float]:
    """Return the entries of the study file that give inputs half their scatter.

    None where nothing is promised of the quantity, or a law has no middle.
    """
    laws = study_file_of(ds).uncertain
    changes: dict[str, float] = {}
    for name in inputs:
        law = laws[name]
        changed = {} if isinstance(law, Tied) else halved(law)
        if not changed:
            return {}
        changes |= {f"uncertain.{name}.{key}": value for key, value in changed.items()}
    return changes if any(_promised(quantity)) else {}


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
    changes = changes_of(ds, quantity, inputs)
    if not changes:
        return
    names = tuple(inputs)
    try:
        found = weighted(ds, changes)
    except (InputError, RunError) as refused:
        yield Tightened(names, "", reason=f"the rows cannot show what it would change ({refused})")
        return
    described = found.summary.outputs.get(quantity.name)
    for key, what, before, unit, more in _promised(quantity):
        one = described.find(*key) if described is not None else None
        if one is None:
            yield Tightened(names, what, reason="the rows cannot show what it would change")
        elif not isfinite(one.best.estimate.value):
            why = one.best.estimate.reason
            yield Tightened(
                names, what, reason=f"the rows cannot show what it would change ({why})"
            )
        else:
            is_share = key[0] == "thresholds"
            after, rows = one.best.estimate, found.effective_rows
            given = {name: repr(value) for name, value in changes.items()}
            path = key_of("outputs", quantity.name, *key, verb="what-if", options=given)
            yield Tightened(names, what, before, after, is_share, unit, "", rows, path, more)


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
        words = f"the share of rows that {event.said}"
        yield key, words, event.share, Unit(), quantity.wants_more
    promise = quantity.promise
    if promise is None or promise.of_magnitude:  # the quantiles of the rows have a sign
        return
    known = quantity.wants_more
    if quantity.events and known is None:  # which quantile matters is not known
        return
    if quantity.is_life and known is not None:
        known = not known  # more ends are shorter lives
    ends = (round(1 - promise.coverage, 12), promise.coverage)
    for p, before in zip(ends, promise.quantiles, strict=True):
        if isfinite(before.value):
            words = f"the {100 * p:g} % quantile"
            yield ("quantiles", repr(p)), words, before, promise.unit, known
