"""Cumulative incidence of each cause that may end a life, and B-lives by cause."""

from collections.abc import Callable, Iterator
from math import isfinite, nan

import numpy as np
from numpy.typing import NDArray

from uq.assess.counted_rows import ASSUMES
from uq.assess.failed_rows import bounded
from uq.assess.sample import SelectedRows, share, share_of
from uq.assess.statistic import Context, Reader, Statistic, StatisticKind, placed
from uq.assess.statistics.quantiles import B_LIVES
from uq.contract import Floats
from uq.result.element import Element
from uq.stats.estimate import Estimate
from uq.stats.survival_curves import aalen_johansen, incidence_interval
from uq.text.numbers import number, threshold
from uq.text.units import beside, typical, unit_of

_KIND = StatisticKind(
    name="Incidences by cause", is_share=True, readers=~(Reader.RUNNING | Reader.REPORT)
)
_LIFE = StatisticKind(name="B-lives by cause", readers=Reader.JSON | Reader.COLUMNS)
_WEIGHTED = "cumulative incidence needs rows of equal weight"


@placed()
@bounded()
def causes(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the cumulative incidence of each cause at thresholds and quantiles, and B-lives.

    Of a cause that ended no row where causes tell why a life never ends: the share that never ends.
    """
    if not element.declared.causes or element.causes is None:
        return
    of_never = element.causes[element.never]
    sample = context.sample(element)
    asked = list(context.analysis.thresholds.get(element.output, ()))
    times = [sample.life_quantile(p).value for p in dict.fromkeys(context.analysis.quantiles)]
    unit = unit_of(element.units, typical(times))
    quantiles = sorted(time for time in times if isfinite(time))
    labels = {time: beside(number(time / unit.size), unit.name) for time in quantiles}
    labels |= {time: threshold(time, element.units) for time in asked}
    every = dict.fromkeys([*asked, *quantiles])
    for code, cause in enumerate(element.declared.causes):
        if (of_never >= 0).any() and not (element.causes[~element.never] == code).any():
            yield Statistic(
                ("causes", cause, "never"),
                f"never, by {cause}",
                _held(element, context, code),
                kind=_KIND,
                column=f"never by {cause}",
                by=(share_of,),
            )
            continue
        for time in every:
            yield Statistic(
                ("causes", cause, repr(time)),
                f"by {cause} within {labels[time]}",
                incidence(element, context, code, time),
                kind=_KIND,
                column=f"{cause} by {time!r}",
                falls=True,
                at=time,
                estimator=share(_hits(code, time)),
                by=(aalen_johansen, incidence_interval),
            )
        for name, p in B_LIVES.items():
            yield Statistic(
                ("causes", cause, name),
                "",
                life_by_cause(element, context, code, p),
                element.units,
                _LIFE,
                column=f"{name} by {cause}",
                by=(aalen_johansen, incidence_interval),
            )


def _held(element: Element, context: Context, code: int) -> Estimate:
    """Estimate the share of rows that never end by a cause."""
    if why := refusal(element, context):
        return Estimate(reason=why)
    if element.censored.any() and not element.declared.never_known_at_once:
        return Estimate(reason="rows that are censored may never end")
    kept = element.present
    hits = (element.never & (element.causes == code))[kept]
    return share_of(hits, context.sample(element).dependence[kept])


def _hits(code: int, time: float) -> Callable[[Element], SelectedRows | None]:
    """Return a function from elements to the rows that the cause ended by a time."""

    def rows(element: Element) -> SelectedRows | None:
        if element.causes is None or element.unknown_sides(time).any():
            return None
        return SelectedRows(
            ~element.failed, ((element.causes == code) & (element.values <= time)).astype(float)
        )

    return rows


def refusal(element: Element, context: Context) -> str:
    """Return why the lives of an element have no cumulative incidence by cause, or ""."""
    if element.weights is not None:
        return _WEIGHTED
    if within := int(element.within_interval.sum()):
        return f"cumulative incidence needs exact lives: {within} are known within an interval only"
    sample = context.sample(element)
    why = getattr(sample, "refusal", "")
    return str(why)


def incidence(element: Element, context: Context, code: int, time: float) -> Estimate:
    """Estimate the probability that a cause has ended the life by a time.

    Without rows censored before it is the share of rows; else the estimate of Aalen and Johansen,
    for independent rows with an interval.
    """
    assert element.causes is not None
    if why := refusal(element, context):
        return Estimate(reason=why)
    if element.entered is None and not (element.censored & (element.values < time)).any():
        hits = (element.causes == code) & (element.values <= time)
        kept = element.present
        return share_of(hits[kept], context.sample(element).dependence[kept])
    values, codes, entered = at_risk(element)
    if time > values[np.isfinite(values)].max(initial=0.0) and (codes < 0).any():
        return Estimate(reason="it is after the last observation")
    estimate = aalen_johansen(values, codes, entered, code, np.array([time]))
    value = float(estimate.share[0])
    if not context.sample(element).dependence.is_none:
        return Estimate(value, reason="intervals need independent rows", assumes=ASSUMES)
    low, high = incidence_interval(values, codes, entered, code, np.array([time]))
    return Estimate(value, float(low[0]), float(high[0]), assumes=ASSUMES)


def at_risk(element: Element) -> tuple[Floats, NDArray[np.int8], Floats]:
    """Return lives, causes and entries of the rows with a life."""
    assert element.causes is not None
    kept = element.present
    codes = np.where(element.censored, -1, element.causes)[kept]
    entered = np.zeros(len(codes)) if element.entered is None else element.entered[kept]
    return element.values[kept], codes, entered


def life_by_cause(element: Element, context: Context, code: int, probability: float) -> Estimate:
    """Estimate the time by which a cause has ended a share of the rows."""
    assert element.causes is not None
    if why := refusal(element, context):
        return Estimate(reason=why)
    values, codes, entered = at_risk(element)
    times = np.unique(values[codes == code])
    curve = aalen_johansen(values, codes, entered, code, times).share
    low, high = incidence_interval(values, codes, entered, code, times)
    if not context.sample(element).dependence.is_none:
        low = high = np.full(len(times), np.nan)

    def first(share: Floats) -> float:
        reached = share >= probability
        return float(times[np.argmax(reached)]) if reached.any() else nan

    value = first(curve)
    if not isfinite(value):
        return Estimate(reason=f"fewer are ended by '{element.declared.causes[code]}'")
    return Estimate(value, first(high), first(low), assumes=ASSUMES)
