"""Probabilities that an output lies above and below thresholds."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import nan
from typing import Any

import numpy as np

from uq.assess.estimators import SelectedRows, share
from uq.assess.failed_rows import bounded
from uq.assess.life_quantiles import ended_by
from uq.assess.population import Population
from uq.assess.statistic import Context, Listing, Reader, Statistic, StatisticKind, entry
from uq.assess.survival import survival
from uq.result.elements import Element, Mask
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.stats.intervals import Replicates, replicates_of_some, share_interval
from uq.stats.kaplan_meier import kaplan_meier
from uq.text.numbers import percent

SIDES = {"above": ">", "below": "<"}


def event(element: Element, threshold: float) -> tuple[Mask, Mask] | None:
    """Return which rows lie above and which below a threshold, by magnitude for an angle.

    Parameters
    ----------
    element : Element
    threshold : float

    Returns
    -------
    tuple of ndarray of bool, or None
        Rows without a value lie on neither side. None where rows were censored below the
        threshold, so that their side is unknown.
    """
    if element.unknown_sides(threshold).any():
        return None
    values, censored = element.for_thresholds, element.censored
    above = (values > threshold) | (censored & (values == threshold))
    return above, (values < threshold) & ~censored


def share_of(hits: Mask, replicate: Replicates) -> Estimate:
    """Estimate the share of rows that are hits."""
    return Estimate(float(hits.mean()) if len(hits) else np.nan, *share_interval(hits, replicate))


def _alone(one: Statistic) -> dict[str, Any]:
    """Return one side as `uq compare` has it."""
    assumes = one.estimate.assumes
    return _side(one) | ({"assumes": assumes} if assumes else {})


def _side(one: Statistic) -> dict[str, Any]:
    reason = one.estimate.reason if one.estimate.assumes else ""
    bare = replace(one.estimate, assumes="", reason=reason)
    return entry(replace(one, estimate=bare, otherwise=None))


def _write(group: Sequence[Statistic]) -> dict[str, Any]:
    """Return both sides of a threshold."""
    found: dict[str, Any] = {one.key[-1]: _side(one) for one in group}
    found |= group[0].facts
    guesses = {one.key[-1]: one.otherwise for one in group if one.otherwise}
    if reason := group[0].estimate.reason:
        found["reason"] = reason
    if guesses:
        assumes = group[0].best.estimate.assumes
        found["kaplan_meier"] = {side: _side(one) for side, one in guesses.items()}
        found["kaplan_meier"]["assumes"] = assumes
    return found


_LISTING = Listing("Probabilities, with 95 % intervals", by="threshold")
PROBABILITY = StatisticKind(entry=_alone, write=_write, listing=_LISTING)
UNDEFINED = StatisticKind(
    write=lambda group: dict(group[0].facts),
    shown=lambda share: percent(share) if share else "",
    is_count=True,
    has_interval=False,
    listing=_LISTING,
    readers=Reader.REPORT,
)
"""The share of undefined rows beside both probabilities; JSON has it among theirs."""


@bounded(of_magnitude=True)
def thresholds(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield P(above), P(below) and the share that is undefined for each threshold of an output."""
    for threshold in context.analysis.thresholds.get(element.output, ()):
        yield from _probabilities(element, threshold, context.replicate)


def _probabilities(
    element: Element, threshold: float, replicate: Replicates
) -> Iterator[Statistic]:
    kept = ~element.failed
    share_undefined = float(element.undefined[kept].mean()) if kept.any() else nan
    undefined = {"undefined": estimate_json.number(share_undefined)}
    sides = event(element, threshold)
    for place, (side, sign) in enumerate(SIDES.items()):
        one = Statistic(
            ("thresholds", repr(threshold), side),
            f"P({sign}{threshold!r})",
            Estimate(),
            kind=PROBABILITY,
            heading=f"P({side})",
            falls=side == "below",
            at=threshold,
            facts=undefined,
            estimator=replace(
                share(_hits(threshold, place)),
                counts_hits=element.is_plain,
                averages=not element.is_plain,
            ),
            by=(share_of, share_interval)
            if element.is_plain
            else (getattr(Population, side), Population),
        )
        if not element.is_plain and sides is None:
            yield replace(one, estimate=Estimate(reason=_unknown_sides(element, threshold)))
        elif not element.is_plain:
            of = Population(element, replicate)
            yield replace(one, estimate=(of.above, of.below)[place](threshold))
        elif sides is None:
            yield _by_kaplan_meier(one, element, threshold, replicate)
        else:
            within = replicates_of_some(replicate, kept)
            yield replace(one, estimate=share_of(sides[place][kept], within))
    yield Statistic(
        ("thresholds", repr(threshold), "undefined"),
        "",
        Estimate(share_undefined),
        kind=UNDEFINED,
        heading="undefined",
        at=threshold,
        facts=undefined,
    )


def _by_kaplan_meier(
    one: Statistic, element: Element, threshold: float, replicate: Replicates
) -> Statistic:
    reason = _unknown_sides(element, threshold)
    guess = ended_by(element, threshold, replicate)[one.falls]
    label = f"{one.label}, if" if one.falls else ""  # a terminal shows one side only
    small = (reason, f"by Kaplan-Meier, assuming {guess.assumes}", guess.reason)
    return replace(
        one,
        estimate=Estimate(reason=reason),
        otherwise=replace(one, label=label, estimate=guess, by=(ended_by, kaplan_meier, survival)),
        more="; ".join(filter(None, small)) if one.falls else "",
    )


def _unknown_sides(element: Element, threshold: float) -> str:
    unknown = element.unknown_sides(threshold)
    return f"{unknown.sum()} of {unknown.size} rows were censored before that time"


def _hits(threshold: float, place: int) -> Callable[[Element], SelectedRows | None]:
    def sample(element: Element) -> SelectedRows | None:
        if element.law is not None:
            numbers = (element.above, element.below)[place](threshold)
            return SelectedRows(~element.failed, numbers)
        sides = event(element, threshold)
        return None if sides is None else SelectedRows(~element.failed, sides[place].astype(float))

    return sample
