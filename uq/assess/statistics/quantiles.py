"""The quantiles that a study asks for, and the B-lives of lifetimes."""

from collections.abc import Iterator
from dataclasses import replace

from uq.assess.failed_rows import bounded
from uq.assess.statistic import COUNT, Context, Listing, Reader, Statistic, StatisticKind
from uq.result.element import Element
from uq.stats.estimate import NOTHING, Estimate

B_LIVES = {"B1": 0.01, "B10": 0.1, "B50": 0.5}
"""Share of rows that have ended by each of the lives that engineers quote."""

_LIVES = Listing("B-lives: B10 is the time by which 10 % have ended", first="lifetime")
_TIMES = Listing("Times by which a share has succeeded", first="time")
LIFE = StatisticKind(name="B-lives", listing=_LIVES, readers=~Reader.RUNNING)
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
            estimator=sample.quantile_estimator(p),
            by=sample.by["quantile"],
        )
        counted = element.is_lifetime and element.is_plain  # else no Kaplan-Meier curve
        guess = sample.life_quantile(p) if counted else NOTHING
        label = f"{statistic.label}, if"
        if guess.assumes:
            by = sample.by["life_quantile"]
            otherwise = replace(statistic, label=label, estimate=guess, by=by)
            statistic = replace(statistic, otherwise=otherwise)
        yield statistic


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
            estimator=sample.quantile_estimator(p),
            by=sample.by["life_quantile" if life.assumes else "quantile"],
        )
    rows_in = replace(_ROWS, listing=listing)
    for label, rows in (("never ending", element.never), ("censored", element.censored)):
        key, words = f"rows {label}", f"rows {label.replace('ending', verb)}"
        yield Statistic(("b_lives", key), words, Estimate(float(rows.sum())), "rows", rows_in)
