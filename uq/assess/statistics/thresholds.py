"""Probabilities that an output lies above and below thresholds."""

from collections.abc import Iterator
from dataclasses import replace
from math import nan

from uq.assess.failed_rows import bounded
from uq.assess.statistic import Context, Listing, Reader, Statistic, StatisticKind
from uq.result.element import Element
from uq.stats import estimate_json
from uq.stats.estimate import Estimate

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
