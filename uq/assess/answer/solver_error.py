"""Effect of the numerical error of rows on a promise, in words."""

from collections.abc import Iterator
from dataclasses import replace
from math import inf, isfinite, nan

from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.answer.wording import DisplayUnit, joined, sentence
from uq.assess.fact import Fact
from uq.assess.scaling import population
from uq.assess.solver_error import error_share, off_by_error, stating_none
from uq.assess.statistic import Context
from uq.assess.statistics.counts import accuracy, stated_error
from uq.assess.statistics.quantiles import quantiles
from uq.assess.statistics.tolerance import tolerance
from uq.assess.summary import Described
from uq.result.elements import Element
from uq.stats import estimate_json
from uq.text.numbers import counted, percent

NOTABLE = 0.01
"""A smaller share of the variance is negligible."""

Sides = tuple[float, float]


def own_error_of(
    promise: ToleranceBound, described: Described, element: Element, context: Context
) -> Fact | None:
    """Return the effect of the stated errors of rows on a promise; None if none is stated.

    Parameters
    ----------
    promise : ToleranceBound
    described : Described
        The statistics behind it.
    element : Element
        Of an angle, its magnitude.
    context : Context

    Returns
    -------
    Fact or None
        ``lower`` and ``upper``: the bounds if every value were wrong by its error, to the unsafe
        side; ``share_of_variance``: the mean square of the errors as a share of the variance;
        ``accuracy``: requested by the settings, and ``rows_missing_it``: the share of rows that
        miss it; ``rows_stating_none``: their number. The sentence is "" if all is negligible.
    """
    error = stated_error(context.rows, element)
    if error is None:
        return None
    are_quantiles = not (isfinite(promise.lower) or isfinite(promise.upper))
    bounds = promise.lower, promise.upper
    if are_quantiles:
        bounds = promise.quantiles[0].value, promise.quantiles[1].value
    worse = [nan, nan]
    for side in (0, 1):
        if isfinite(bounds[side]) and not promise.joint:
            moved = off_by_error(element, error, (-1, 1)[side])
            worse[side] = _bounds(promise, are_quantiles, moved, context)[side]
    asked, missed = nan, 0.0
    for statistic in described.parts.get("accuracy", ()):
        facts = statistic.facts["accuracy"]
        asked, missed = facts["asked"], facts["share"] or 0.0
    share, unstated = error_share(element, error), stating_none(element, error)
    moved_bounds = _moved(promise, bounds, (worse[0], worse[1]), are_quantiles)
    text = ""
    if moved_bounds or share >= NOTABLE or unstated:
        variance = _of_variance(share, element.is_lifetime, bool(moved_bounds))
        clauses = (moved_bounds, variance, _missing(asked, missed, unstated))
        text = " ".join(sentence(clause) for clause in clauses if clause)
    numbers = {
        "lower": worse[0],
        "upper": worse[1],
        "share_of_variance": share,
        "accuracy": asked,
        "rows_missing_it": missed,
    }
    by_bound = promise.by_quantile if are_quantiles else (promise.by, promise.by)
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


def _moved(promise: ToleranceBound, bounds: Sides, worse: Sides, are_quantiles: bool) -> str:
    """Return a clause on the new bounds, of those that change in a shown digit."""
    noun, ways = "life" if promise.is_life else "value", ("overestimated", "underestimated")
    now, then = ([*_texts(promise.unit, ends)] for ends in (bounds, worse))
    moved = [i for i in (0, 1) if then[i] and then[i] != now[i]]
    if not moved:
        return ""
    how = joined([ways[i] for i in moved], "or")
    bound_noun = "quantile" if are_quantiles else "bound"
    does, it = (f"{bound_noun} does", "it") if len(moved) == 1 else (f"{bound_noun}s do", "they")
    return (
        f"the {does} not allow for the rows' own numerical error: if every {noun} were {how}"
        f" by as much, {it} would be {joined([then[i] for i in moved])}"
    )


def _texts(unit: DisplayUnit, ends: Sides) -> Iterator[str]:
    for end, towards in zip(ends, (-inf, inf), strict=True):
        yield unit.text(end, towards) if isfinite(end) else ""


def _of_variance(share: float, is_life: bool, is_named: bool) -> str:
    """Return a clause on the mean square of an error, which may have been named; "" if small."""
    if not share >= NOTABLE:
        return ""
    variance = "variance of the logarithm" if is_life else "variance"
    which = "this error" if is_named else "the rows' own numerical error"
    if share >= 1:
        return f"the mean square of {which} exceeds the {variance}: all scatter may be numerical"
    return f"the mean square of {which} is {percent(share)} of the {variance}"


def _missing(asked: float, missed: float, unstated: int) -> str:
    """Return a clause on rows that miss the accuracy or state no error; "" if there are none."""
    parts = []
    if missed > 0:
        share = f"{100 * asked:g} %"
        parts.append(f"{percent(missed)} of the rows miss the accuracy asked for, {share}")
    if unstated:
        verb = "states" if unstated == 1 else "state"
        parts.append(f"{counted(unstated, 'row')} {verb} no error")
    return "; ".join(parts)


def _bounds(
    promise: ToleranceBound, are_quantiles: bool, element: Element, context: Context
) -> Sides:
    """Return the bounds of other values of the same rows."""
    if not are_quantiles:
        bounds = {
            statistic.key[-1]: statistic.estimate.value for statistic in tolerance(element, context)
        }
        return bounds["lower"], bounds["upper"]
    alike = (
        candidate
        for candidate in population(context.rows, [element.output])
        if candidate.name == element.name
    )
    drawn = replace(next(alike), values=element.values)  # with the law of its scaling inputs
    values = {
        statistic.key[-1]: statistic.best.estimate.value for statistic in quantiles(drawn, context)
    }
    low, high = (values[repr(p)] for p in promise.probabilities)
    return low, high
