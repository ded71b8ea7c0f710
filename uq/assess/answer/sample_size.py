"""Sample size that settles an answer: intervals narrow as one over root n."""

from collections.abc import Iterator, Sequence
from math import inf, isfinite, isnan

from uq.assess.answer.parts import Event, Quantity
from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.findings import Findings
from uq.text.numbers import percent

SHARE = 0.2
"""A probability is settled if half its interval is at most this part of the rarer side ..."""

POINT = 0.01
"""... or at most a percentage point."""

BOUND = 0.1
"""A promise is settled if it is within this part of the quantile that it bounds (of a life), or of
the likely range."""

MOST = 100.0
"""Beyond so many times the rows, the root of n is no forecast."""


_BOUNDS = {"tolerance": "tolerance bounds", "joint_bounds": "joint bounds"}


Shortfall = tuple[str, float]
"""What the sample size does not settle, in a clause, and the factor on it that would settle it.

The factor is infinite if no number of rows would.
"""


def unsettled(quantity: Quantity) -> Iterator[Shortfall]:
    """Yield what is not settled about a quantity, and how many times the rows would settle it.

    References
    ----------
    JCGM 101:2008, "Evaluation of measurement data - Supplement 1 to the GUM", 7.9: the standard
    deviation of an estimate falls as one over the root of the number of rows.
    """
    for event in quantity.events:
        yield from unsettled_share(event)
    if quantity.promise is not None:
        yield from _of_promise(quantity.promise, quantity)
    ranking = quantity.ranking
    if ranking is not None and isfinite(ranking.rows_factor):
        yield ranking.reason, ranking.rows_factor
    for event in quantity.events:
        if event.ranking is not None and isfinite(event.ranking.rows_factor):
            clause = f"what decides how many {event.clause} is not settled"
            yield clause, event.ranking.rows_factor


def bounds_unsettled(findings: Findings, answered: Sequence[Quantity]) -> Iterator[Shortfall]:
    """Yield the requested bounds that the sample size does not support."""
    rows = len(findings.rows)
    for key, words in _BOUNDS.items():
        described = (findings.summary.outputs[quantity.name] for quantity in answered)
        bounds = (element.find(key, side) for element in described for side in ("lower", "upper"))
        needed = max((bound.rows_needed or 0.0 for bound in bounds if bound), default=0.0)
        if needed:
            asked = f"the {words} that the study asks for"
            clause = f"{asked} need {needed:.0f} rows" if isfinite(needed) else ""
            yield clause or f"too many rows failed for {asked}", needed / max(rows, 1)


def unsettled_share(event: Event) -> Iterator[Shortfall]:
    """Yield the probability of an event, if not settled."""
    share = event.share
    if isnan(share.value) and event.sentence:
        yield f"{event.sentence[:1].lower()}{event.sentence[1:-1]}", inf
    if not share.has_interval:
        return
    half = (share.high - share.low) / 2
    goal = max(SHARE * min(share.value, 1 - share.value), POINT)
    if half > goal:
        clause = f"how many {event.clause} is known to {percent(half).removesuffix(' %')} points"
        yield clause, (half / goal) ** 2


def _of_promise(promise: ToleranceBound, quantity: Quantity) -> Iterator[Shortfall]:
    likely = quantity.range
    if likely is None:
        return
    for bound, estimate, end, outwards in (
        (promise.lower, likely.low, promise.quantiles[0].low, -inf),
        (promise.upper, likely.high, promise.quantiles[1].high, inf),
    ):
        reached = bound if isfinite(bound) else end
        if not (isfinite(reached) and isfinite(estimate.value)):
            continue
        scale = abs(estimate.value)
        if not promise.is_life:
            scale = abs(likely.high.value - likely.low.value)
        away = abs(estimate.value - reached)
        # Beyond, the quantile is where values jump, and nearly any number of rows bounds it badly.
        if isfinite(scale) and BOUND * scale < away < BOUND * scale * MOST**0.5:
            text = promise.unit.text(reached, outwards)
            best = promise.unit.text(estimate.value)
            clause = f"the cautious bound, {text}, is far from the estimate, {best}"
            yield clause, (away / (BOUND * scale)) ** 2
