"""The quantiles that a study asks for, and the B-lives of lifetimes."""

from collections.abc import Iterator
from dataclasses import replace

from uq import order_statistics
from uq.analysis.estimators import quantile
from uq.analysis.failed_rows import bounded
from uq.analysis.life_quantiles import B_LIVES, life_quantiles, quantile_estimate
from uq.analysis.statistics.statistic import (
    COUNT,
    EVERYWHERE,
    REPORT,
    RUNNING,
    Context,
    Kind,
    Listing,
    Statistic,
)
from uq.estimate import Estimate
from uq.rows.elements import Element

QUANTILE = Kind()

_LIVES = Listing("B-lives: B10 is the time by which 10 % have ended", "lifetime", of_lives=True)
LIFE = Kind("B-lives", listing=_LIVES, readers=EVERYWHERE - {RUNNING})
_ROWS = replace(COUNT, listing=_LIVES, readers=frozenset((REPORT,)))


@bounded()
def quantiles(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield quantiles, with Kaplan-Meier estimates where they depend on censored rows."""
    within = context.present(element)
    asked = {repr(probability): probability for probability in context.analysis.quantiles}
    guesses = life_quantiles(element, asked, context.replicate) if element.is_lifetime else {}
    for name, p in asked.items():
        one = Statistic(
            ("quantiles", name),
            f"quantile {name}",
            quantile_estimate(element, p, within),
            element.units,
            QUANTILE,
            column=f"q{name}",
            heading=f"{100 * p:g} % quantile",
            rows_needed=_rows_needed(element, p),
            sentence="Median {brief}." if p == 0.5 else "",
            estimator=quantile(p),
        )
        guess = guesses.get(name)
        if guess is not None and guess.assumes:
            yield replace(one, otherwise=replace(one, label=f"{one.label}, if", estimate=guess))
        else:
            yield one


def b_lives(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the times by which a share of rows has ended, and how many rows have not."""
    if element.is_lifetime:
        yield from _lives(element, context)
        for label, rows in (("never ending", element.never), ("censored", element.censored)):
            seen = Estimate(float(rows.sum()))
            yield Statistic((label,), f"rows {label}", seen, "rows", _ROWS)


@bounded()
def _lives(element: Element, context: Context) -> Iterator[Statistic]:
    for name, found in life_quantiles(element, B_LIVES, context.replicate).items():
        p = B_LIVES[name]
        yield Statistic(
            ("b_lives", name),
            name,
            found,
            element.units,
            LIFE,
            rows_needed=None if found.assumes else _rows_needed(element, p),
            estimator=quantile(p),
        )


def _rows_needed(element: Element, probability: float) -> int | None:
    """Return how many rows a quantile needs; None where there are enough, or none."""
    rows = len(element.at_least)
    if rows == 0 or order_statistics.is_within(probability, rows):
        return None
    return order_statistics.rows_to_reach(probability)
