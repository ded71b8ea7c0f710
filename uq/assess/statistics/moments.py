"""Mean, standard deviation, and the tail that may rule them out."""

from collections.abc import Iterator
from dataclasses import replace
from math import isnan

from uq.assess.estimators import MEAN, SD
from uq.assess.statistic import FACT, Context, Reader, Statistic, StatisticKind
from uq.result.element import Element
from uq.stats.estimate import NOTHING, Estimate
from uq.stats.moments import Moments
from uq.stats.tails import heavier_tail

MOMENT = StatisticKind(form="moment")
SPREAD = replace(MOMENT, readers=~Reader.RUNNING)


def moments_of(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield mean, standard deviation and tail; unknown where rows never end or are censored.

    The shape k of the heavier tail (``tail_k``): there is no variance from 0.5 on, no mean from 1.
    """
    sample = context.sample(element)
    estimates, unit, by = sample.moments(), element.units, sample.by
    more, mean, sd = estimates.caution or "", estimates.mean, estimates.sd
    yield Statistic(("mean",), "mean", mean, unit, MOMENT, more=more, estimator=MEAN, by=by["mean"])
    yield Statistic(("sd",), "sd", sd, unit, SPREAD, estimator=SD, by=by["sd"])
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


def _reasons(estimates: Moments) -> dict[str, str]:
    both = {"sd": estimates.sd, "mean": estimates.mean}
    reasons = {f"{name}_interval": estimate.reason for name, estimate in both.items()}
    reasons |= {name: estimate.reason for name, estimate in both.items() if isnan(estimate.value)}
    return {name: reason for name, reason in reasons.items() if reason}
