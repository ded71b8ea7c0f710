"""Variance reduction by exact integration of the lives of an output."""

from collections.abc import Iterator
from dataclasses import replace
from math import isfinite

from uq.assess.scaling import why_not_integrated
from uq.assess.statistic import FACT, Context, Reader, Statistic
from uq.assess.statistics.quantiles import B_LIVES, LIFE
from uq.result.element import Element
from uq.stats.estimate import Estimate
from uq.stats.estimate_json import number

_AT = "B10"
_KIND = replace(
    FACT,
    text="{:.2g} times",
    listing=LIFE.listing,
    readers=FACT.readers | Reader.REPORT,
)


def integrated(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield how many times the rows the exact integration is worth: a ratio of variances."""
    if not element.declared.scales:
        return
    why = why_not_integrated(context.rows, element)
    law = element.law
    if law is None:
        if why:
            yield Statistic(("integrated",), "", Estimate(), kind=_KIND, column="", notes=(why,))
        return
    names = " and ".join(name.replace("_", " ") for name in law.inputs)
    words = f"{names} integrated exactly"
    worth = context.sample(element).integration_gain(B_LIVES[_AT])
    if isfinite(worth):
        words += f", worth {worth:.2g} times the rows at {_AT}"
    yield Statistic(
        ("integrated",),
        "worth of the rows",
        Estimate(worth),
        kind=_KIND,
        heading=f"worth of the rows at {_AT}",
        more=f"{names} integrated exactly",
        notes=tuple(filter(None, (words, why))),
        facts={"integrated": {"inputs": list(law.inputs), "worth": number(worth)}},
    )
