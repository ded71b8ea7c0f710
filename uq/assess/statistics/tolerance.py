"""Tolerance bounds: limits for a given share of all values, with a given confidence."""

from collections.abc import Iterator
from dataclasses import replace
from math import isnan

import numpy as np

from uq.assess.counted_rows import whenever_censored_rows_end
from uq.assess.statistic import COUNT, Context, Listing, Reader, Statistic, StatisticKind
from uq.result.elements import Element
from uq.stats.estimate import Estimate
from uq.stats.order_statistics import rows_for_bound, rows_still_needed, tolerance_bounds


def tolerance(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield both one-sided bounds and the rows they need; failed rows count as the worst.

    Of an angle, whose sign is only a direction, also the upper bound of the magnitude.
    """
    asked = context.analysis.tolerance
    if asked is None or context.replicate is not None or context.weights is not None:
        return
    failed = int(element.failed.sum())
    early = tolerance_bounds(element.at_least, failed, *asked)
    late = tolerance_bounds(element.at_most, failed, *asked)
    lower = whenever_censored_rows_end((early[0], early[0]))
    upper = whenever_censored_rows_end((early[1], late[1]))
    needed = rows_still_needed(int((element.present | element.failed).sum()), failed, *asked)
    coverage, confidence = (f"{100 * share:g}" for share in asked)
    listing = Listing(
        f"Tolerance bounds: with {confidence} % confidence each, {coverage} % of all lie above the"
        f" lower, and {coverage} % below the upper" + ", or the magnitude's" * element.is_angle,
        keeps_empty=True,
    )
    bound = StatisticKind(form="bound", listing=listing, readers=COUNT.readers)
    bounds = {"lower": lower, "upper": upper}
    if element.is_angle:
        largest = tolerance_bounds(np.abs(element.at_most), failed, *asked)[1]
        bounds["magnitude"] = Estimate(largest)
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
