"""The quantiles that a study asks for, and the B-lives of lifetimes."""

from collections.abc import Iterator
from dataclasses import replace

from uq.assess.estimators import quantile_of
from uq.assess.failed_rows import bounded
from uq.assess.life_quantiles import B_LIVES, life_quantiles, quantile_estimate, rows_needed
from uq.assess.population import Population
from uq.assess.statistic import COUNT, Context, Listing, Reader, Statistic, StatisticKind
from uq.result.elements import Element
from uq.stats import order_statistics
from uq.stats.estimate import NOTHING, Estimate
from uq.stats.kaplan_meier import kaplan_meier

_LIVES = Listing("B-lives: B10 is the time by which 10 % have ended", first="lifetime")
_TIMES = Listing("Times by which a share has succeeded", first="time")
LIFE = StatisticKind(name="B-lives", listing=_LIVES, readers=~Reader.RUNNING)
_BY = (order_statistics.quantile, order_statistics.quantile_interval)
_BY_KAPLAN_MEIER = (life_quantiles, kaplan_meier)
_LAWS = (Population.quantile, Population)
_ROWS = replace(COUNT, readers=Reader.REPORT)


@bounded()
def quantiles(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield quantiles, with Kaplan-Meier estimates where they depend on censored rows."""
    within = context.present(element)
    asked = {repr(probability): probability for probability in context.analysis.quantiles}
    lives = element.is_lifetime or not element.is_plain
    guesses = life_quantiles(element, asked, context.replicate) if lives else {}
    for name, p in asked.items():
        plain = quantile_estimate(element, p, within) if element.is_plain else guesses[name]
        one = Statistic(
            ("quantiles", name),
            f"quantile {name}",
            plain,
            element.units,
            column=f"q{name}",
            heading=f"{100 * p:g} % quantile",
            rows_needed=rows_needed(element, p),
            estimator=quantile_of(element, p),
            by=_BY if element.is_plain else _LAWS,
        )
        guess = guesses.get(name, NOTHING)
        otherwise = replace(one, label=f"{one.label}, if", estimate=guess, by=_BY_KAPLAN_MEIER)
        yield replace(one, otherwise=otherwise) if guess.assumes else one


@bounded()
def b_lives(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the times by which a share of rows has ended, and how many rows have not."""
    if not element.is_lifetime:
        return
    success = bool(element.declared.success)
    listing, verb = (_TIMES, "succeeding") if success else (_LIVES, "ending")
    for name, found in life_quantiles(element, B_LIVES, context.replicate).items():
        p = B_LIVES[name]
        yield Statistic(
            ("b_lives", name),
            f"{100 * p:g} % by" if success else name,
            found,
            element.units,
            replace(LIFE, listing=listing),
            rows_needed=None if found.assumes else rows_needed(element, p),
            column=name,
            estimator=quantile_of(element, p),
            by=(_BY_KAPLAN_MEIER if found.assumes else _BY) if element.is_plain else _LAWS,
        )
    rows_in = replace(_ROWS, listing=listing)
    for label, rows in (("never ending", element.never), ("censored", element.censored)):
        key, words = f"rows {label}", f"rows {label.replace('ending', verb)}"
        yield Statistic(("b_lives", key), words, Estimate(float(rows.sum())), "rows", rows_in)
