"""Effect of the numerical error of rows on a promise, in words."""

from collections.abc import Iterator
from dataclasses import dataclass, field, replace
from math import inf, isfinite, nan

from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.answer.wording import DisplayUnit, joined
from uq.assess.scaling import population
from uq.assess.solver_error import error_share, off_by_error, stating_none
from uq.assess.statistic import Context
from uq.assess.statistics.counts import stated_error
from uq.assess.statistics.quantiles import quantiles
from uq.assess.statistics.tolerance import tolerance
from uq.assess.summary import Described
from uq.result.elements import Element
from uq.text.numbers import capitalized, counted, percent

NOTABLE = 0.01
"""A smaller share of the variance is negligible."""

Sides = tuple[float, float]


@dataclass(frozen=True)
class OwnError:
    """Effect of the numerical error of the rows on a promise.

    Attributes
    ----------
    bounds : tuple of float
        Lower and upper, as promised; NaN without one.
    worse : tuple of float
        The bounds if every value were wrong by its error, to the unsafe side.
    are_quantiles : bool
        Whether quantiles are promised, for want of tolerance bounds.
    share : float
        Mean square of the errors as a share of the variance; NaN if unknown.
    unit : DisplayUnit
        Of the bounds.
    is_life : bool
        Whether it is of lives; the share is then of their logarithms.
    asked, missed : float
        The accuracy that the settings ask for, and the share of the rows that miss it; NaN without.
    unstated : int
        Number of rows without a stated error.
    """

    bounds: Sides = (nan, nan)
    worse: Sides = (nan, nan)
    are_quantiles: bool = False
    share: float = nan
    unit: DisplayUnit = field(default_factory=DisplayUnit)
    is_life: bool = False
    asked: float = nan
    missed: float = nan
    unstated: int = 0

    @property
    def sentence(self) -> str:
        """The effect of the error in words; "" if negligible."""
        if not (self._moved or self.share >= NOTABLE or self.unstated):
            return ""
        about = (self._moved, self._of_variance, self._missing)
        return " ".join(f"{capitalized(clause)}." for clause in about if clause)

    @property
    def _moved(self) -> str:
        """The new bounds, of those that change in a shown digit."""
        noun, ways = "life" if self.is_life else "value", ("overestimated", "underestimated")
        now, then = ([*self._texts(ends)] for ends in (self.bounds, self.worse))
        moved = [i for i in (0, 1) if then[i] and then[i] != now[i]]
        if not moved:
            return ""
        how = joined([ways[i] for i in moved], "or")
        bound_noun = "quantile" if self.are_quantiles else "bound"
        does, it = (
            (f"{bound_noun} does", "it") if len(moved) == 1 else (f"{bound_noun}s do", "they")
        )
        return (
            f"the {does} not allow for the rows' own numerical error: if every {noun} were {how}"
            f" by as much, {it} would be {joined([then[i] for i in moved])}"
        )

    def _texts(self, ends: Sides) -> Iterator[str]:
        for end, towards in zip(ends, (-inf, inf), strict=True):
            yield self.unit.text(end, towards) if isfinite(end) else ""

    @property
    def _of_variance(self) -> str:
        if not self.share >= NOTABLE:
            return ""
        variance = "variance of the logarithm" if self.is_life else "variance"
        which = "this error" if self._moved else "the rows' own numerical error"
        if self.share >= 1:
            return (
                f"the mean square of {which} exceeds the {variance}: all scatter may be numerical"
            )
        return f"the mean square of {which} is {percent(self.share)} of the {variance}"

    @property
    def _missing(self) -> str:
        parts = []
        if self.missed > 0:
            asked = f"{100 * self.asked:g} %"
            parts.append(f"{percent(self.missed)} of the rows miss the accuracy asked for, {asked}")
        if self.unstated:
            verb = "states" if self.unstated == 1 else "state"
            parts.append(f"{counted(self.unstated, 'row')} {verb} no error")
        return "; ".join(parts)


def own_error_of(
    promise: ToleranceBound, described: Described, element: Element, context: Context
) -> OwnError | None:
    """Return the effect of the stated errors of rows on a promise; None if none is stated.

    Parameters
    ----------
    promise : ToleranceBound
    described : Described
        The statistics behind it.
    element : Element
        Of an angle, its magnitude.
    context : Context
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
    accuracies = [statistic.facts["accuracy"] for statistic in described.parts.get("accuracy", ())]
    asked, missed = next(
        ((accuracy["asked"], accuracy["share"] or 0.0) for accuracy in accuracies), (nan, 0.0)
    )
    return OwnError(
        bounds,
        (worse[0], worse[1]),
        are_quantiles,
        error_share(element, error),
        promise.unit,
        element.is_lifetime,
        asked,
        missed,
        stating_none(element, error),
    )


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
