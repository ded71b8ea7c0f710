"""Tolerance bounds: limits for a given share of all values, with a given confidence."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import isnan
from typing import Any

from uq.assess.statistic import COUNT, Context, Listing, Reader, Statistic, StatisticKind, placed
from uq.result.element import Element
from uq.stats.estimate import Estimate
from uq.stats.order_statistics import (
    joint_bounds,
    rows_for_bound,
    rows_still_needed,
    tolerance_bounds,
)
from uq.study.file import USUAL


@placed(json=1, columns=2, absent="null")
def tolerance(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield both one-sided bounds and the rows they need; failed rows count as the worst.

    Of an angle, whose sign is only a direction, also the upper bound of the magnitude.
    """
    asked = context.analysis.tolerance
    if not asked or not (bounds := context.sample(element).tolerance_bounds(*asked)):
        return
    failed = int(element.failed.sum())
    needed = rows_still_needed(int((element.present | element.failed).sum()), failed, *asked)
    coverage, confidence = (f"{100 * share:g}" for share in asked)
    caption = (
        f"Tolerance bounds: with {confidence} % confidence each, {coverage} % of all are above the"
        f" lower, and {coverage} % below the upper" + ", or the magnitude's" * element.is_angle
    )
    names = ("tolerance", "tolerance, ", "tolerance_")
    yield from _bounds(bounds, needed, element.units, caption, names, tolerance_bounds)


def joint(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the bounds of an element, of all that hold at once, and the rows that these need."""
    asked = context.analysis
    if not context.sample(element).is_simple_random:
        return
    limits = [limit for limit in context.joint_bounds if limit.element == element.name]
    if not limits:
        return
    bounds = {
        limit.side: Estimate(limit.value, beyond=("value",) * limit.beyond) for limit in limits
    }
    coverage, confidence = (f"{100 * share:g}" for share in asked.tolerance or USUAL)
    caption = (
        f"Joint bounds: with {confidence} % confidence, {coverage} % of all are within the"
        f" bounds of"
        f" {', '.join(asked.joint_bounds)} simultaneously"
    )
    names = ("joint_bounds", "joint bound, ", "joint_")
    first, *others = _bounds(
        bounds, limits[0].rows_needed, element.units, caption, names, joint_bounds
    )
    is_first = context.joint_bounds[0].element == element.name
    yield replace(first, notes=(f"{caption}.",) * is_first)
    yield from others


def _bounds(
    bounds: dict[str, Estimate],
    needed: float,
    units: str,
    caption: str,
    names: tuple[str, str, str],
    by: Callable[..., Any],
) -> Iterator[Statistic]:
    """Yield bounds by side, and the rows they need; `names` start keys, labels and columns."""
    key, label, column = names
    listing = Listing(caption, keeps_empty=True)
    kind = StatisticKind(form="bound", listing=listing, readers=COUNT.readers)
    for side, estimate in bounds.items():
        yield Statistic(
            (key, side),
            f"{label}{side}",
            estimate,
            units,
            kind,
            rows_needed=needed if isnan(estimate.value) else None,
            column=f"{column}{side}",
            heading=side,
            by=(by,),
        )
    yield Statistic(
        (key, "rows_needed"),
        "rows needed",
        Estimate(needed).finite,
        "rows",
        replace(COUNT, listing=listing, readers=COUNT.readers & ~Reader.TERMINAL),
        column=f"{column}rows_needed",
        by=(rows_for_bound,),
    )
