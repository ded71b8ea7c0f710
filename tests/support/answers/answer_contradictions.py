"""What is wrong with an answer: sentences that deny each other."""

import re

import numpy as np


def denied_by_each_other(conclusions):
    """Yield pairs of sentences that cannot both be true."""
    rules = {remedy.rule for remedy in conclusions.advice}
    if "nothing" in rules and rules & {"rows", "measure", "failed"}:
        yield "nothing to do, and something"
    texts = [remedy.text for remedy in conclusions.advice]
    if sum(regime.share.value for regime in conclusions.regimes) > 1 + 1e-9:
        yield "regimes that are more than all"
    for quantity in conclusions.quantities:
        yield from (f"{quantity.name}: {text}" for text in _of_quantity(quantity))
    if (lead := conclusions.lead) is None:
        return
    for advice in conclusions.advice:
        for event in lead.events:
            flat = event.ranking is not None and event.ranking.denies_a_leader
            if flat and advice.rule == "tighten" and event.predicate in advice.text:
                yield f"{event.decided_by} {advice.text}"
            if advice.rule == "measure" and f"the share that {event.predicate}" in advice.text:
                named = event.ranking and event.ranking.leader and event.ranking.leader.inputs
                if not set(advice.inputs) <= set(named or ()):
                    yield f"{event.decided_by} {advice.text}"
    leader = f"({lead.words})"
    for text in texts:
        alone = len(conclusions.quantities) == 1
        if "the ranking of the inputs is not settled" in text and (leader in text or alone):
            if lead.ranking is not None and lead.ranking.leader is not None:
                yield f"{lead.ranking.sentence} {text}"


def _of_quantity(quantity):
    low, median, high = (
        (quantity.range.low.value, quantity.range.median.value, quantity.range.high.value)
        if quantity.range is not None
        else (np.nan,) * 3
    )
    if low > median or median > high:
        yield "a range that is no range"
    if quantity.tolerance_bound is not None and (
        quantity.tolerance_bound.lower > low or quantity.tolerance_bound.upper < high
    ):
        if quantity.tolerance_bound.coverage == 0.95:
            yield f"{quantity.tolerance_bound.sentence} {quantity.range.sentence}"
    for event in quantity.events:
        at, below = float(re.search(r"[<>]([^<>]*)\)$", event.name)[1]), "<" in event.name
        share = event.share.value if below else 1 - event.share.value - event.undefined
        for p, value in ((0.05, low), (0.5, median), (0.95, high)):
            if np.isfinite(value) and event.undefined == 0 and abs(value - at) > 1e-3 * abs(at):
                if (share > p + 0.02) if at < value else (share < p - 0.02):
                    yield f"{event.sentence} {quantity.range.sentence}"
        if event.curve is not None:
            ends = [event.curve.shares[i].value for i in (event.curve.least, event.curve.most)]
            if event.undefined == 0 and not ends[0] - 1e-9 <= event.share.value <= ends[1] + 1e-9:
                yield f"{event.sentence} {event.decided_by}"
    moved = {}
    for each in quantity.ranking.contributions if quantity.ranking else ():
        moved |= {n: c.direction for n, c in zip(each.inputs, each.changes, strict=False)}
    for apart in (quantity.earliest.inputs or ()) if quantity.earliest else ():
        if apart.direction * moved.get(apart.name, 0) > 0:  # what shortens it is higher, not lower
            yield f"{quantity.ranking.with_effect} {quantity.earliest.why}"
