"""Mean, standard deviation, and the tail that may rule them out."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import isfinite, isnan, nan
from typing import Any

from uq.assess.estimators import MEAN, SD
from uq.assess.statistic import FACT, Context, Reader, Statistic, StatisticKind
from uq.result.elements import Element
from uq.stats.estimate import NOTHING, Estimate
from uq.stats.importance_weights import Smoothed
from uq.stats.intervals import mean_interval
from uq.stats.moments import Moments, moments, sd_interval, standard_deviation
from uq.stats.tails import heavier_tail
from uq.stats.weighted_means import moments_of_rows, weighted_moments

MOMENT = StatisticKind(form="moment")
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
    have_moments = len(values) and not (element.never.any() or element.censored.any())
    nothing = Moments(NOTHING, NOTHING, None, None)
    estimates = moments(values, context.present(element)) if have_moments else nothing
    if have_moments and context.weights is not None:
        estimates = _weighted(element, context, context.weights, estimates)
    more = estimates.caution or ""
    unit = element.units
    mean, sd = _BY if context.weights is None else _WEIGHTED
    yield Statistic(
        ("mean",), "mean", estimates.mean, unit, MOMENT, more=more, estimator=MEAN, by=mean
    )
    yield Statistic(("sd",), "sd", estimates.sd, unit, SPREAD, estimator=SD, by=sd)
    reasons = _reasons(estimates)
    tail = estimates.tail
    yield Statistic(
        ("tail",),
        "tail",
        NOTHING if tail is None else Estimate(tail.k, tail.low, tail.high),
        kind=FACT,
        column="tail_k",
        notes=(*dict.fromkeys(reasons.values()), *filter(None, [estimates.caution])),
        facts={"tail": tail and tail._asdict(), "reasons": reasons, "caution": estimates.caution},
        by=(heavier_tail,),
    )


def _weighted(element: Element, context: Context, by: Smoothed, plain: Moments) -> Moments:
    """Return the moments of weighted rows; the tail rules out what it does without weights."""
    kept = element.present
    both = weighted_moments(element.values[kept], by.weights[kept], context.present(element))
    weighted = [
        Estimate(estimate.value if isfinite(other.value) else nan, reason=other.reason)
        if other.reason
        else estimate
        for estimate, other in zip(both, (plain.mean, plain.sd), strict=True)
    ]
    if by.refusal:
        weighted = [Estimate(reason=by.refusal)] * 2
    return Moments(weighted[0], weighted[1], plain.tail, plain.caution)


def _reasons(estimates: Moments) -> dict[str, str]:
    both = {"sd": estimates.sd, "mean": estimates.mean}
    reasons = {f"{name}_interval": estimate.reason for name, estimate in both.items()}
    reasons |= {name: estimate.reason for name, estimate in both.items() if isnan(estimate.value)}
    return {name: reason for name, reason in reasons.items() if reason}
