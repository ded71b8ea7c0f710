"""Tolerance bounds that hold for several outputs at once."""

from collections.abc import Iterator
from dataclasses import replace
from math import isnan

from uq.assess.statistic import COUNT, Context, Listing, Reader, Statistic, StatisticKind
from uq.result.elements import Element
from uq.stats.estimate import Estimate
from uq.stats.order_statistics import joint_bounds, rows_for_bound
from uq.study.file import USUAL


def joint(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the bounds of an element, of all that hold at once, and the rows that these need."""
    asked = context.analysis
    if context.replicate is not None or context.weights is not None:
        return
    bounds = [limit for limit in context.joint_bounds if limit.element == element.name]
    if not bounds:
        return
    coverage, confidence = (f"{100 * share:g}" for share in asked.tolerance or USUAL)
    words = (
        f"Joint bounds: with {confidence} % confidence, {coverage} % of all lie within those of"
        f" {', '.join(asked.joint_bounds)} at once"
    )
    is_first = context.joint_bounds[0].element == element.name
    listing = Listing(words, keeps_empty=True)
    bound = StatisticKind(form="bound", listing=listing, readers=COUNT.readers)
    for joint_bound in bounds:
        yield Statistic(
            ("joint_bounds", joint_bound.side),
            f"joint bound, {joint_bound.side}",
            Estimate(joint_bound.value, beyond=("value",) * joint_bound.beyond),
            element.units,
            bound,
            rows_needed=joint_bound.rows_needed if isnan(joint_bound.value) else None,
            column=f"joint_{joint_bound.side}",
            heading=joint_bound.side,
            notes=(f"{words}.",) * (is_first and joint_bound is bounds[0]),
            by=(joint_bounds,),
        )
    yield Statistic(
        ("joint_bounds", "rows_needed"),
        "rows needed",
        Estimate(bounds[0].rows_needed).finite,
        "rows",
        replace(COUNT, listing=listing, readers=COUNT.readers & ~Reader.TERMINAL),
        column="joint_rows_needed",
        by=(rows_for_bound,),
    )
