"""Mean, standard deviation, and the tail that may rule them out."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import isfinite, isnan, nan
from typing import Any

from uq.assess.estimators import MEAN, SD
from uq.assess.statistic import FACT, Context, Reader, Statistic, StatisticKind
from uq.result.elements import Element
from uq.stats import estimate_json
from uq.stats.estimate import NOTHING, Estimate
from uq.stats.importance_weights import Smoothed
from uq.stats.intervals import mean_interval
from uq.stats.moments import Moments, moments, sd_interval, standard_deviation
from uq.stats.tails import heavier_tail
from uq.stats.weighted_means import moments_of_rows, weighted_moments


def _numbers(one: Statistic) -> dict[str, Any]:
    return estimate_json.numbers(one.estimate)


def _write(group: Sequence[Statistic]) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for one in group:
        found[one.key[-1]] = estimate_json.number(one.estimate.value)
        found[f"{one.key[-1]}_interval"] = estimate_json.ends(one.estimate)
    return found


MOMENT = StatisticKind(entry=_numbers, write=_write)
SPREAD = replace(MOMENT, readers=~Reader.RUNNING)


_Functions = tuple[Callable[..., Any], ...]
_BY: tuple[_Functions, _Functions] = (
    (moments, mean_interval),
    (standard_deviation, sd_interval),
)
_WEIGHTED: tuple[_Functions, _Functions] = ((weighted_moments, moments_of_rows),) * 2
"""What computes mean and standard deviation, of plain and of weighted rows."""


def moments_of(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield mean, standard deviation and tail; unknown where rows never end or are censored.

    The shape k of the heavier tail (``tail_k``): there is no variance from 0.5 on, no mean from 1.
    """
    values = element.at_least
    known = len(values) and not (element.never.any() or element.censored.any())
    nothing = Moments(NOTHING, NOTHING, None, None)
    found = moments(values, context.present(element)) if known else nothing
    if known and context.weights is not None:
        found = _weighted(element, context, context.weights, found)
    more = found.caution or ""
    unit = element.units
    mean, sd = _BY if context.weights is None else _WEIGHTED
    yield Statistic(("mean",), "mean", found.mean, unit, MOMENT, more=more, estimator=MEAN, by=mean)
    yield Statistic(("sd",), "sd", found.sd, unit, SPREAD, estimator=SD, by=sd)
    reasons = _reasons(found)
    tail = found.tail
    yield Statistic(
        ("tail",),
        "tail",
        NOTHING if tail is None else Estimate(tail.k, tail.low, tail.high),
        kind=FACT,
        column="tail_k",
        notes=(*dict.fromkeys(reasons.values()), *filter(None, [found.caution])),
        facts={"tail": tail and tail._asdict(), "reasons": reasons, "caution": found.caution},
        by=(heavier_tail,),
    )


def _weighted(element: Element, context: Context, by: Smoothed, plain: Moments) -> Moments:
    """Return the moments of weighted rows; the tail rules out what it does without weights."""
    kept = element.present
    both = weighted_moments(element.values[kept], by.weights[kept], context.present(element))
    found = [
        Estimate(one.value if isfinite(other.value) else nan, reason=other.reason)
        if other.reason
        else one
        for one, other in zip(both, (plain.mean, plain.sd), strict=True)
    ]
    if by.refusal:
        found = [Estimate(reason=by.refusal)] * 2
    return Moments(found[0], found[1], plain.tail, plain.caution)


def _reasons(found: Moments) -> dict[str, str]:
    both = {"sd": found.sd, "mean": found.mean}
    reasons = {f"{name}_interval": one.reason for name, one in both.items()}
    reasons |= {name: one.reason for name, one in both.items() if isnan(one.value)}
    return {name: reason for name, reason in reasons.items() if reason}
