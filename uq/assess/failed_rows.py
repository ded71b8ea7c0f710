"""Bounds of an estimate with the failed rows at best and at worst.

The value of a failed row is unknown, and failures are often related to the output: the other rows
may not be representative. A tolerance bound counts failed rows as the worst on each side; so do
these bounds.
"""

from collections.abc import Callable
from dataclasses import replace
from functools import wraps

import numpy as np
from numpy.typing import ArrayLike

from uq.assess.statistic import Context, Maker, Statistic
from uq.contract import Floats, Mask
from uq.result.element import Element
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.estimate import Estimate
from uq.stats.intervals import share_interval


def with_failed_at(element: Element, value: float) -> Element:
    """Return an element whose failed rows have a value."""
    return replace(
        element,
        values=np.where(element.failed, value, element.values),
        failed=np.zeros_like(element.failed),
    )


def bounded(of_magnitude: bool = False) -> Callable[[Maker], Maker]:
    """Add bounds to the statistics of a maker where rows failed.

    Parameters
    ----------
    of_magnitude : bool
        Whether they describe the magnitude of an angle.

    Returns
    -------
    callable
        Maker -> maker. The bounds are the ends of the 95 % interval with all failed rows at the
        lowest and at the highest possible value, for a lifetime 0 and never; NaN where there is no
        bound. Numbers of rows have none.
    """

    def wrap(make: Maker) -> Maker:
        @wraps(make)
        def made(element: Element, context: Context) -> list[Statistic]:
            statistics = list(make(element, context))
            if not element.failed.any():
                return statistics
            least = 0.0 if element.is_lifetime or of_magnitude and element.is_angle else -np.inf
            ends = (make(with_failed_at(element, end), context) for end in (least, np.inf))
            return [
                statistic
                if statistic.kind.is_count
                else _with_bounds(
                    statistic, element.is_lifetime, *(both[::-1] if statistic.falls else both)
                )
                for statistic, *both in zip(statistics, *ends, strict=True)
            ]

        return made

    return wrap


def _with_bounds(
    statistic: Statistic, is_life: bool, lowest: Statistic, highest: Statistic
) -> Statistic:
    ends = bounds(statistic.estimate, lowest.estimate, highest.estimate, is_life)
    otherwise = statistic.otherwise
    if otherwise and lowest.otherwise and highest.otherwise:
        otherwise = _with_bounds(otherwise, is_life, lowest.otherwise, highest.otherwise)
    return replace(statistic, failed=ends, otherwise=otherwise)


def bounds(plain: Estimate, lowest: Estimate, highest: Estimate, is_life: bool) -> Estimate:
    """Return both bounds: for an estimate without interval, the estimates themselves.

    Parameters
    ----------
    plain : Estimate
    lowest, highest : Estimate
        With the failed rows at the lowest and at the highest possible value.
    is_life : bool
        Whether infinite bounds mean something.
    """
    alone = not _has_end(plain)

    def bound(which: str, estimate: Estimate) -> tuple[float, bool]:
        # Replicates that agree with the failed rows on one side give no interval there.
        agreed = np.isfinite(estimate.value) and not _has_end(estimate)
        end = "value" if alone or agreed else which
        widest, inner = getattr(estimate, end), getattr(plain, which)
        if np.isfinite(widest) and np.isfinite(inner):
            widest = float(outer(which, widest, inner))
        return widest if is_life or np.isfinite(widest) else np.nan, end in estimate.beyond

    (low, low_beyond), (high, high_beyond) = bound("low", lowest), bound("high", highest)
    beyond = ("low",) * low_beyond + ("high",) * high_beyond
    return Estimate(low=low, high=high, beyond=beyond)


def _has_end(estimate: Estimate) -> bool:
    return bool(np.isfinite(estimate.low) or np.isfinite(estimate.high))


def outer(which: str, bound: ArrayLike, end: ArrayLike) -> Floats:
    """Return the outer one of bounds and ends of plain intervals; NaN where there is no bound.

    Replicates may scatter less with the failed rows on one side than without them.
    """
    widest = (np.fmin if which == "low" else np.fmax)(bound, end)
    return np.where(np.isnan(bound), np.nan, widest)


def failed_share_bounds(
    hits: Mask, failed: Mask, dependence: Dependence = INDEPENDENT
) -> Estimate | None:
    """Return bounds of a share with all failed rows among the misses, and among the hits.

    Parameters
    ----------
    hits, failed : ndarray of bool, shape (n,)
        Of all independent rows.
    dependence : Dependence, optional

    Returns
    -------
    Estimate
        Without value; None where no row failed.
    """
    if not failed.any():
        return None
    plain = share_interval(hits[~failed], dependence[~failed])

    def bound(which: str, place: int, some: Mask) -> float:
        end = share_interval(some, dependence)[place]
        return float(outer(which, end if np.isfinite(end) else some.mean(), plain[place]))

    return Estimate(low=bound("low", 0, hits & ~failed), high=bound("high", 1, hits | failed))
