"""The quantiles that a study asks for, and the B-lives of lifetimes."""

from collections.abc import Iterator
from dataclasses import replace

from uq.assess.counted_rows import CountedRows
from uq.assess.estimators import quantile_of
from uq.assess.failed_rows import bounded
from uq.assess.population import Population
from uq.assess.statistic import COUNT, Context, Listing, Reader, Statistic, StatisticKind
from uq.result.elements import Element
from uq.stats import order_statistics
from uq.stats.estimate import NOTHING, Estimate
from uq.stats.kaplan_meier import kaplan_meier

B_LIVES = {"B1": 0.01, "B10": 0.1, "B50": 0.5}
"""Share of rows that have ended by each of the lives that engineers quote."""

_LIVES = Listing("B-lives: B10 is the time by which 10 % have ended", first="lifetime")
_TIMES = Listing("Times by which a share has succeeded", first="time")
LIFE = StatisticKind(name="B-lives", listing=_LIVES, readers=~Reader.RUNNING)
_BY = (order_statistics.quantile, order_statistics.quantile_interval)
_BY_KAPLAN_MEIER = (CountedRows.life_quantile, kaplan_meier)
_LAWS = (Population.quantile, Population)
_ROWS = replace(COUNT, readers=Reader.REPORT)


@bounded()
def quantiles(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield quantiles, with Kaplan-Meier estimates where they depend on censored rows."""
    sample = context.sample(element)
    for p in dict.fromkeys(context.analysis.quantiles):
        name = repr(p)
        statistic = Statistic(
            ("quantiles", name),
            f"quantile {name}",
            sample.quantile(p),
            element.units,
            column=f"q{name}",
            heading=f"{100 * p:g} % quantile",
            rows_needed=sample.rows_needed(p),
            estimator=quantile_of(element, p),
            by=_BY if element.is_plain else _LAWS,
        )
        counted = element.is_lifetime and element.is_plain  # else no Kaplan-Meier curve
        guess = sample.life_quantile(p) if counted else NOTHING
        label = f"{statistic.label}, if"
        otherwise = replace(statistic, label=label, estimate=guess, by=_BY_KAPLAN_MEIER)
        yield replace(statistic, otherwise=otherwise) if guess.assumes else statistic


@bounded()
def b_lives(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the times by which a share of rows has ended, and how many rows have not."""
    if not element.is_lifetime:
        return
    success = bool(element.declared.success)
    listing, verb = (_TIMES, "succeeding") if success else (_LIVES, "ending")
    sample = context.sample(element)
    for name, p in B_LIVES.items():
        life = sample.life_quantile(p)
        yield Statistic(
            ("b_lives", name),
            f"{100 * p:g} % by" if success else name,
            life,
            element.units,
            replace(LIFE, listing=listing),
            rows_needed=None if life.assumes else sample.rows_needed(p),
            column=name,
            estimator=quantile_of(element, p),
            by=(_BY_KAPLAN_MEIER if life.assumes else _BY) if element.is_plain else _LAWS,
        )
    rows_in = replace(_ROWS, listing=listing)
    for label, rows in (("never ending", element.never), ("censored", element.censored)):
        key, words = f"rows {label}", f"rows {label.replace('ending', verb)}"
        yield Statistic(("b_lives", key), words, Estimate(float(rows.sum())), "rows", rows_in)
