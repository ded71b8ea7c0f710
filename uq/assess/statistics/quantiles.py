"""Quantiles, B-lives, probabilities at thresholds, and the gain from exact integration."""

from collections.abc import Iterator
from dataclasses import replace
from math import isfinite, nan

from uq.assess.failed_rows import bounded
from uq.assess.integrated_inputs import why_not_integrated
from uq.assess.statistic import (
    COUNT,
    FACT,
    Context,
    Listing,
    Reader,
    Statistic,
    StatisticKind,
    placed,
)
from uq.result.element import Element
from uq.stats import estimate_json
from uq.stats.estimate import NOTHING, Estimate

B_LIVES = {"B1": 0.01, "B10": 0.1, "B50": 0.5}
"""Share of rows that have ended by each of the lives that engineers quote."""

_LIVES = Listing("B-lives: B10 is the time by which 10 % have ended", first="lifetime")
_TIMES = Listing("Times by which a share has succeeded", first="time")
LIFE = StatisticKind(name="B-lives", listing=_LIVES, readers=~Reader.RUNNING)
_ROWS = replace(COUNT, readers=Reader.REPORT)


@placed(json=2, columns=1, absent="{}")
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
        has_curve = element.is_lifetime and "life_quantile" in sample.by  # of Kaplan and Meier
        guess = sample.life_quantile(p) if has_curve else NOTHING
        label = f"{statistic.label}, if"
        if guess.assumes and not statistic.estimate.assumes:
            by = sample.by["life_quantile"]
            otherwise = replace(statistic, label=label, estimate=guess, by=by)
            statistic = replace(statistic, otherwise=otherwise)
        yield statistic


@placed(json=4, absent="{}")
@bounded()
def b_lives(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the times by which a share of rows has ended, and the number that have not."""
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


SIDES = {"above": ">", "below": "<"}


_LISTING = Listing("Probabilities, with 95 % intervals", by="threshold")
PROBABILITY = StatisticKind(form="side", listing=_LISTING)
UNDEFINED = StatisticKind(
    form="",
    is_share=True,
    without="",
    is_count=True,
    listing=_LISTING,
    readers=Reader.REPORT,
)
"""The share of undefined rows beside both probabilities; JSON has it among theirs."""


@placed(json=3, absent="{}")
@bounded(of_magnitude=True)
def thresholds(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield P(above), P(below) and the share that is undefined for each threshold of an output."""
    sample, kept = context.sample(element), ~element.failed
    share_undefined = float(element.undefined[kept].mean()) if kept.any() else nan
    undefined = {"undefined": estimate_json.number(share_undefined)}
    for threshold in context.analysis.thresholds.get(element.output, ()):
        key = ("thresholds", repr(threshold))
        estimates = (sample.probability_above(threshold), sample.probability_below(threshold))
        guesses = sample.ended_by(threshold)
        for (side, sign), estimate in zip(SIDES.items(), estimates, strict=True):
            statistic = Statistic(
                (*key, side),
                f"P({sign}{threshold!r})",
                estimate,
                kind=PROBABILITY,
                heading=f"P({side})",
                falls=side == "below",
                at=threshold,
                facts=undefined,
                estimator=sample.share_estimator(threshold, side),
                by=sample.by[f"probability_{side}"],
            )
            if guesses is not None:
                guess = guesses[statistic.falls]
                guessed = replace(statistic, estimate=guess, by=sample.by["ended_by"])
                statistic = _with_guess(statistic, guessed)
            yield statistic
        yield Statistic(
            (*key, "undefined"),
            "",
            Estimate(share_undefined),
            kind=UNDEFINED,
            heading="undefined",
            at=threshold,
            facts=undefined,
        )


def _with_guess(plain: Statistic, guess: Statistic) -> Statistic:
    """Return a probability that censored rows leave open, with its Kaplan-Meier estimate."""
    label = f"{plain.label}, if" if plain.falls else ""  # a terminal shows one side only
    assumed = f"by Kaplan-Meier, assuming {guess.estimate.assumes}"
    small = (plain.estimate.reason, assumed, guess.estimate.reason)
    return replace(
        plain,
        otherwise=replace(guess, label=label),
        more="; ".join(filter(None, small)) if plain.falls else "",
    )


_AT = "B10"
_KIND = replace(
    FACT,
    text="{:.2g} times",
    listing=LIFE.listing,
    readers=FACT.readers | Reader.REPORT,
)


def integrated(element: Element, context: Context) -> Iterator[Statistic]:
    """Yield the variance reduction factor of exact integration against plain Monte Carlo."""
    if not element.declared.exponents:
        return
    why = why_not_integrated(context.rows, element)
    law = element.law
    if law is None:
        if why:
            yield Statistic(("integrated",), "", Estimate(), kind=_KIND, column="", notes=(why,))
        return
    names = " and ".join(name.replace("_", " ") for name in law.inputs)
    words = f"{names} integrated exactly"
    worth = context.sample(element).integration_gain(B_LIVES[_AT])
    if isfinite(worth):
        words += f", worth {worth:.2g} times the rows at {_AT}"
    yield Statistic(
        ("integrated",),
        "worth of the rows",
        Estimate(worth),
        kind=_KIND,
        heading=f"worth of the rows at {_AT}",
        more=f"{names} integrated exactly",
        notes=tuple(filter(None, (words, why))),
        facts={"integrated": {"inputs": list(law.inputs), "worth": estimate_json.number(worth)}},
    )
