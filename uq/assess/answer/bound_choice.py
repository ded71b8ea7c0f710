"""Choose the tolerance bound, or quantiles in its place, and move it by the rows' errors."""

from collections.abc import Iterator
from dataclasses import replace
from math import inf, isfinite, isnan, nan
from typing import Any

from uq.assess.answer.tolerance_bound import FAIL, ToleranceBound, piles
from uq.assess.answer.wording import DisplayUnit, joined, sentence
from uq.assess.fact import Fact, Functions
from uq.assess.integrated_inputs import elements_with_laws
from uq.assess.joint_bounds import SIDES
from uq.assess.statistic import Context, Statistic
from uq.assess.statistics.counts import (
    accuracy,
    error_share,
    off_by_error,
    stated_error,
    stating_none,
)
from uq.assess.statistics.quantiles import quantiles
from uq.assess.statistics.table import STATISTICS
from uq.assess.statistics.tolerance import tolerance
from uq.assess.summary import Described
from uq.result.elements import Element
from uq.result.result import Result
from uq.result.weights import weighted_by
from uq.stats import estimate_json
from uq.stats.estimate import NOTHING, Estimate
from uq.study.file import AnalysisTable
from uq.text.numbers import counted, percent

COVERAGE = 0.95
CONFIDENCE = 0.95
"""Default of a bound if the study does not set one."""

MIDDLE = 0.5


def tolerance_bound_of(
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
        reason = _why_no_bound(result, element, both, bounds, coverage)
    elif isfinite(wrong := _contradicted(bounds, ends)):
        reason = f"its value, {unit.text(wrong)}, contradicts the estimate"
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
        recurs=element.law is None and described.recurs,
        ranks=(0, 0) if joint else _ranks(element, bounds),
        rows=int((element.present | element.failed).sum()),
        piled=piled,
        by=next((statistic.by for statistic in both if statistic), (STATISTICS[part],)),
        by_quantile=(functions_of(estimated[0]), functions_of(estimated[1])),
    )


def _ranks(element: Element, bounds: list[float]) -> tuple[int, int]:
    """Return the ranks of bounds among the rows, failed rows beyond them; 0 without a bound."""
    values, lower, upper = element.for_thresholds[element.present], *bounds
    first = int(element.failed.sum() + (values < lower).sum()) + 1 if isfinite(lower) else 0
    return first, int((values <= upper).sum()) if isfinite(upper) else 0


def without_value(element: Element) -> dict[str, Any]:
    """Return whether rows failed, and the share of the others without a defined value."""
    sound = ~element.failed
    undefined = float(element.undefined[sound].mean()) if sound.any() else 0.0
    return {"rows_failed": bool(element.failed.any()), "undefined": undefined}


def best_quantile(described: Described, p: float) -> Statistic | None:
    """Return a requested quantile, by Kaplan-Meier if censored rows leave it open."""
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
    return "succeed" if element.declared.success else FAIL


def _contradicted(bounds: list[float], ends: list[Estimate]) -> float:
    """Return a bound on the wrong side of its quantile, which is then stated instead; else NaN.

    It occurs by chance with few rows, where integrated lives estimate the quantile more precisely.
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
    result: Result,
    element: Element,
    both: list[Statistic | None],
    bounds: list[float],
    coverage: float,
) -> str:
    needed = next(
        (statistic.rows_needed for statistic in both if statistic and statistic.rows_needed), None
    )
    if needed == inf:
        return f"{percent(element.failed.mean())} of the rows are invalid and count as beyond it"
    if needed:
        return f"{needed:.0f} rows are required"
    if any(not isnan(bound) for bound in bounds):
        many = "more" if element.declared.success else "fewer"
        may = "may not " if element.declared.success else ""
        return f"{many} than {100 * (1 - coverage):.3g} % {may}{end_verb(element)}"
    if result.has_next_rows:
        return f"the rows {weighted_by(result.dataset)}"
    if result.has_weights:
        return "the rows are weighted by inspections"
    if result.is_nested:
        return "the rows of one sample are not independent"
    return f"the rows of a '{result.design_name}' design are not independent"


NOTABLE = 0.01
"""A smaller share of the variance is negligible."""

Sides = tuple[float, float]


def own_error_of(
    tolerance_bound: ToleranceBound, described: Described, element: Element, context: Context
) -> Fact | None:
    """Return the effect of the numerical errors of rows on a bound; None if rows state none.

    Parameters
    ----------
    tolerance_bound : ToleranceBound
    described : Described
        The statistics behind it.
    element : Element
        Of an angle, its magnitude.
    context : Context

    Returns
    -------
    Fact or None
        ``lower`` and ``upper``: the bounds with each value shifted by its error to the unsafe side;
        ``share_of_variance``: the mean square of the errors as a share of the variance;
        ``accuracy``: requested by the settings; ``rows_missing_it``: the share of rows that exceed
        it; ``rows_stating_none``: the number of rows without an error. The sentence is "" if all
        are negligible.
    """
    error = stated_error(context.rows, element)
    if error is None:
        return None
    are_quantiles = not (isfinite(tolerance_bound.lower) or isfinite(tolerance_bound.upper))
    bounds = tolerance_bound.lower, tolerance_bound.upper
    if are_quantiles:
        bounds = tolerance_bound.quantiles[0].value, tolerance_bound.quantiles[1].value
    worse = [nan, nan]
    for side in (0, 1):
        if isfinite(bounds[side]) and not tolerance_bound.joint:
            moved = off_by_error(element, error, (-1, 1)[side])
            worse[side] = _bounds(tolerance_bound, are_quantiles, moved, context)[side]
    asked, missed = nan, 0.0
    for statistic in described.parts.get("accuracy", ()):
        facts = statistic.facts["accuracy"]
        asked, missed = facts["asked"], facts["share"] or 0.0
    share, unstated = error_share(element, error), stating_none(element, error)
    moved_bounds = _moved(tolerance_bound, bounds, (worse[0], worse[1]), are_quantiles)
    text = ""
    if moved_bounds or share >= NOTABLE or unstated:
        variance = _of_variance(share, element.is_lifetime)
        clauses = (moved_bounds, variance, _missing(asked, missed, unstated))
        text = " ".join(sentence(clause) for clause in clauses if clause)
    numbers = {
        "lower": worse[0],
        "upper": worse[1],
        "share_of_variance": share,
        "accuracy": asked,
        "rows_missing_it": missed,
    }
    by_bound = (
        tolerance_bound.by_quantile if are_quantiles else (tolerance_bound.by, tolerance_bound.by)
    )
    return Fact(
        {"sentence": text}
        | {name: estimate_json.number(value) for name, value in numbers.items()}
        | {"rows_stating_none": unstated},
        (off_by_error, error_share, accuracy),
        {
            "lower": (off_by_error, *by_bound[0]),
            "upper": (off_by_error, *by_bound[1]),
            "share_of_variance": (error_share,),
            "accuracy": (accuracy,),
            "rows_missing_it": (accuracy,),
            "rows_stating_none": (stating_none,),
        },
    )


def _moved(
    tolerance_bound: ToleranceBound, bounds: Sides, worse: Sides, are_quantiles: bool
) -> str:
    """Return a clause on the new bounds, of those that change in a shown digit."""
    now, then = ([*_texts(tolerance_bound.unit, ends)] for ends in (bounds, worse))
    moved = [i for i in (0, 1) if then[i] and then[i] != now[i]]
    if not moved:
        return ""
    bound_noun = "quantile" if are_quantiles else "bound"
    excludes = f"{bound_noun} excludes" if len(moved) == 1 else f"{bound_noun}s exclude"
    then_moved = joined([then[i] for i in moved])
    return f"the {excludes} numerical error; including it gives {then_moved}"


def _texts(unit: DisplayUnit, ends: Sides) -> Iterator[str]:
    for end, towards in zip(ends, (-inf, inf), strict=True):
        yield unit.text(end, towards) if isfinite(end) else ""


def _of_variance(share: float, is_life: bool) -> str:
    """Return a clause on the mean square of the numerical error; "" if small."""
    if not share >= NOTABLE:
        return ""
    variance = "variance of the logarithm" if is_life else "variance"
    error = "the mean square of numerical error"
    if share >= 1:
        return f"{error} exceeds the {variance}: all scatter may be numerical"
    return f"{error} is {percent(share)} of the {variance}"


def _missing(asked: float, missed: float, unstated: int) -> str:
    """Return a clause on rows that miss the accuracy or state no error; "" if there are none."""
    parts = []
    if missed > 0:
        parts.append(f"{percent(missed)} of the rows exceed the {100 * asked:g} % error target")
    if unstated:
        verb = "states" if unstated == 1 else "state"
        parts.append(f"{counted(unstated, 'row')} {verb} no error")
    return "; ".join(parts)


def _bounds(
    tolerance_bound: ToleranceBound, are_quantiles: bool, element: Element, context: Context
) -> Sides:
    """Return the bounds of other values of the same rows."""
    if not are_quantiles:
        bounds = {
            statistic.key[-1]: statistic.estimate.value for statistic in tolerance(element, context)
        }
        return bounds["lower"], bounds["upper"]
    alike = (
        candidate
        for candidate in elements_with_laws(context.rows, [element.output])
        if candidate.name == element.name
    )
    drawn = replace(next(alike), values=element.values)  # with the law of its scaling inputs
    values = {
        statistic.key[-1]: statistic.best.estimate.value for statistic in quantiles(drawn, context)
    }
    low, high = (values[repr(p)] for p in tolerance_bound.probabilities)
    return low, high
