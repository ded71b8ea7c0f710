"""Tolerance bounds: limits for a given share of all values, with a given confidence."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import isnan
from typing import Any

from uq.assess.statistic import COUNT, Context, Listing, Reader, Statistic, StatisticKind
from uq.result.elements import Element
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.stats.order_statistics import rows_for_bound, rows_still_needed, tolerance_bounds


def _write(group: Sequence[Statistic]) -> dict[str, Any]:
    numbers: dict[str, Any] = {
        statistic.key[-1]: estimate_json.number(statistic.estimate.value) for statistic in group
    }
    for statistic in group:
        numbers |= estimate_json.flag(f"{statistic.key[-1]}_", statistic.estimate, "value")
    return numbers


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
    listing = Listing(
        f"Tolerance bounds: with {confidence} % confidence each, {coverage} % of all lie above the"
        f" lower, and {coverage} % below the upper" + ", or the magnitude's" * element.is_angle,
        keeps_empty=True,
    )
    bound = StatisticKind(write=_write, has_interval=False, listing=listing, readers=COUNT.readers)
    for name, estimate in bounds.items():
        yield Statistic(
            ("tolerance", name),
            f"tolerance, {name}",
            estimate,
            element.units,
            bound,
            rows_needed=needed if isnan(estimate.value) else None,
            column=f"tolerance_{name}",
            heading=name,
            by=(tolerance_bounds,),
        )
    yield Statistic(
        ("tolerance", "rows_needed"),
        "rows needed",
        Estimate(needed).finite,
        "rows",
        replace(COUNT, listing=listing, readers=COUNT.readers & ~Reader.TERMINAL),
        column="tolerance_rows_needed",
        by=(rows_for_bound,),
    )
