"""Tolerance bounds that hold for several outputs at once."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isnan
from typing import Any

from uq.assess.statistic import COUNT, Context, Listing, Reader, Statistic, StatisticKind
from uq.result.elements import Element
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.stats.order_statistics import joint_bounds, rows_for_bound
from uq.study.file import USUAL


def _write(group: Sequence[Statistic]) -> dict[str, Any]:
    numbers: dict[str, Any] = {
        statistic.key[-1]: estimate_json.number(statistic.estimate.value) for statistic in group
    }
    for statistic in group:
        numbers |= estimate_json.flag(f"{statistic.key[-1]}_", statistic.estimate, "value")
    return numbers


def joint(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the bounds of an element, of all that hold at once, and the rows that these need."""
    asked = context.analysis
    if not context.sample(element).is_simple_random:
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
    bound = StatisticKind(write=_write, has_interval=False, listing=listing, readers=COUNT.readers)
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
