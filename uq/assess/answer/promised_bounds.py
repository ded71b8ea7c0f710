"""The promised bounds of an output: joint ones where a study asks for them, else its own."""

from math import inf, isfinite, isnan, nan
from typing import Any

import numpy as np

from uq.assess.answer.tolerance_bound import ToleranceBound, piles
from uq.assess.answer.wording import DisplayUnit
from uq.assess.fact import Functions
from uq.assess.joint_bounds import SIDES
from uq.assess.statistic import Statistic
from uq.assess.statistics.table import STATISTICS
from uq.assess.summary import Described
from uq.result.elements import Element
from uq.result.result import Result
from uq.stats.estimate import NOTHING, Estimate
from uq.study.file import AnalysisTable
from uq.text.numbers import percent

COVERAGE = 0.95
CONFIDENCE = 0.95
"""Of a bound where the study does not ask for others."""

MIDDLE = 0.5


def promise_of(
    result: Result,
    described: Described,
    element: Element,
    analysis: AnalysisTable,
    wanted: str,
    unit: DisplayUnit,
) -> ToleranceBound:
    """Return the tolerance bound of an element, or quantiles in its place.

    Parameters
    ----------
    result : Result
    described : Described
        With the quantiles and bounds that the answer needs.
    element : Element
    analysis : AnalysisTable
        The [analysis] of the study.
    wanted : {"", "above", "below"}
        The good side of a limit.
    unit : DisplayUnit

    Returns
    -------
    ToleranceBound
    """
    coverage, confidence = analysis.tolerance or (COVERAGE, CONFIDENCE)
    joint = SIDES.get(analysis.joint_bounds.get(element.output, ""), ())
    sides = _sides(element, described, analysis.thresholds.get(element.output, ()), wanted)
    if joint:
        sides = "lower" in joint, "upper" in joint
    part = "joint_bounds" if joint else "tolerance"
    both = [described.find(part, name) for name in ("lower", "upper")]
    bounds = [
        statistic.estimate.value if matters and statistic else nan
        for statistic, matters in zip(both, sides, strict=True)
    ]
    piled = {} if joint else piles(element, sides, coverage)
    sides = sides[0] and 0 not in piled, sides[1] and 1 not in piled
    bounds = [bound if matters else nan for bound, matters in zip(bounds, sides, strict=True)]
    # Quantiles of an angle refer to its magnitude, its joint bounds have a sign.
    signed = bool(joint) and element.is_angle
    estimated = [best_quantile(described, p) for p in (round(1 - coverage, 12), coverage)]
    quantiles = [
        statistic if matters and not signed else None
        for statistic, matters in zip(estimated, sides, strict=True)
    ]
    ends = [statistic.estimate if statistic else NOTHING for statistic in quantiles]
    with_failed = [statistic.failed if statistic else None for statistic in quantiles]
    reason = ""
    if any(sides) and not any(map(isfinite, bounds)):
        reason = _why_no_bound(result, element, both, bounds)
    elif isfinite(wrong := _contradicted(bounds, ends)):
        reason = f"counted from the rows, {unit.text(wrong)}, it lies beyond the quantile itself"
        bounds = [nan, nan]
    return ToleranceBound(
        coverage,
        confidence,
        bounds[0],
        bounds[1],
        unit,
        (ends[0], ends[1]),
        (with_failed[0], with_failed[1]),
        reason,
        element.is_lifetime,
        element.is_angle and not joint,
        end_verb(element),
        tuple(analysis.joint_bounds) if joint else (),
        **without_value(element),
        recurs=_recurs(element),
        ranks=(0, 0) if joint else _ranks(element, bounds),
        rows=int((element.present | element.failed).sum()),
        piled=piled,
        by=next((statistic.by for statistic in both if statistic), (STATISTICS[part],)),
        by_quantile=(functions_of(estimated[0]), functions_of(estimated[1])),
    )


def _ranks(element: Element, bounds: list[float]) -> tuple[int, int]:
    """Return the places of bounds among the rows, failed ones beyond them; 0 without a bound."""
    values, lower, upper = element.for_thresholds[element.present], *bounds
    first = int(element.failed.sum() + (values < lower).sum()) + 1 if isfinite(lower) else 0
    return first, int((values <= upper).sum()) if isfinite(upper) else 0


def without_value(element: Element) -> dict[str, Any]:
    """Return which rows have no value: whether any failed, and the share of undefined ones."""
    sound = ~element.failed
    undefined = float(element.undefined[sound].mean()) if sound.any() else 0.0
    return {"rows_failed": bool(element.failed.any()), "undefined": undefined}


def _recurs(element: Element) -> bool:
    """Return whether rows have equal values."""
    if element.law is not None:
        return False
    values = element.for_thresholds[element.present & ~element.censored]
    values = values[np.isfinite(values)]
    return len(np.unique(values)) < len(values)


def best_quantile(described: Described, p: float) -> Statistic | None:
    """Return a requested quantile, by Kaplan-Meier where the rows alone do not decide it."""
    statistic = described.find("quantiles", repr(p))
    return statistic and statistic.best


def quantile_of(described: Described, p: float) -> Estimate:
    """Return a requested quantile, else an estimate without a number."""
    statistic = best_quantile(described, p)
    return statistic.estimate if statistic else NOTHING


def functions_of(statistic: Statistic | None) -> Functions:
    """Return the functions that compute a quantile."""
    return statistic.by if statistic else (STATISTICS["quantiles"],)


def end_verb(element: Element) -> str:
    """Return the verb for the end of a life."""
    return "succeed" if element.declared.success else "end"


def _contradicted(bounds: list[float], ends: list[Estimate]) -> float:
    """Return a bound on the wrong side of its quantile; NaN if there is none.

    By chance few rows give one, where the quantile is better known since lives are integrated.
    """
    lower, upper = bounds
    if lower > ends[0].value:
        return lower
    return upper if upper < ends[1].value else nan


def _sides(
    element: Element, described: Described, thresholds: tuple[float, ...], wanted: str
) -> tuple[bool, bool]:
    """Return whether a lower and an upper bound matter."""
    if element.is_lifetime:
        early = bool(element.declared.success)  # for a success, the latest time matters
        return not early, early
    if wanted:
        return wanted == "above", wanted == "below"
    middle = quantile_of(described, MIDDLE).value
    if thresholds and isfinite(middle):
        return any(t < middle for t in thresholds), any(t >= middle for t in thresholds)
    return True, True


def _why_no_bound(
    result: Result, element: Element, both: list[Statistic | None], bounds: list[float]
) -> str:
    needed = next(
        (statistic.rows_needed for statistic in both if statistic and statistic.rows_needed), None
    )
    if needed == inf:
        return f"{percent(element.failed.mean())} of the rows failed, and count as lying beyond it"
    if needed:
        return f"it needs {needed:.0f} rows"
    if any(not isnan(bound) for bound in bounds):
        return f"too few {end_verb(element)}"
    if result.has_weights:
        return "the rows are weighted by inspections"
    if result.is_nested:
        return "the rows of one sample are not independent"
    return f"the rows of a '{result.design_name}' design are not independent"
