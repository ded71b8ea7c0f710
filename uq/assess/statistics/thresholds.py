"""Probabilities that an output lies above and below thresholds."""

from collections.abc import Callable, Iterator
from dataclasses import replace
from math import nan

from uq.assess.counted_rows import CountedRows, share_of
from uq.assess.estimators import SelectedRows, share
from uq.assess.failed_rows import bounded
from uq.assess.population import Population
from uq.assess.sample import Sample
from uq.assess.statistic import Context, Listing, Reader, Statistic, StatisticKind
from uq.result.elements import Element
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.stats.intervals import share_interval
from uq.stats.kaplan_meier import kaplan_meier

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
    for threshold in context.analysis.thresholds.get(element.output, ()):
        yield from _probabilities(context.sample(element), threshold)


def _probabilities(sample: Sample, threshold: float) -> Iterator[Statistic]:
    element = sample.element
    kept = ~element.failed
    share_undefined = float(element.undefined[kept].mean()) if kept.any() else nan
    undefined = {"undefined": estimate_json.number(share_undefined)}
    estimates = (sample.probability_above(threshold), sample.probability_below(threshold))
    counts = isinstance(sample, CountedRows)
    for (side, sign), estimate in zip(SIDES.items(), estimates, strict=True):
        statistic = Statistic(
            ("thresholds", repr(threshold), side),
            f"P({sign}{threshold!r})",
            estimate,
            kind=PROBABILITY,
            heading=f"P({side})",
            falls=side == "below",
            at=threshold,
            facts=undefined,
            estimator=replace(
                share(_hits(threshold, side)), counts_hits=counts, averages=not counts
            ),
            by=(share_of, share_interval)
            if counts
            else (getattr(Population, f"probability_{side}"), Population),
        )
        if isinstance(sample, CountedRows) and element.unknown_sides(threshold).any():
            statistic = _by_kaplan_meier(statistic, sample, threshold)
        yield statistic
    yield Statistic(
        ("thresholds", repr(threshold), "undefined"),
        "",
        Estimate(share_undefined),
        kind=UNDEFINED,
        heading="undefined",
        at=threshold,
        facts=undefined,
    )


def _by_kaplan_meier(plain: Statistic, sample: CountedRows, threshold: float) -> Statistic:
    """Return a probability that censored rows leave open, with its Kaplan-Meier estimate."""
    guess = sample.ended_by(threshold)[plain.falls]
    label = f"{plain.label}, if" if plain.falls else ""  # a terminal shows one side only
    small = (plain.estimate.reason, f"by Kaplan-Meier, assuming {guess.assumes}", guess.reason)
    by = (CountedRows.ended_by, kaplan_meier, CountedRows.survival)
    return replace(
        plain,
        otherwise=replace(plain, label=label, estimate=guess, by=by),
        more="; ".join(filter(None, small)) if plain.falls else "",
    )


def _hits(threshold: float, side: str) -> Callable[[Element], SelectedRows | None]:
    def sample(element: Element) -> SelectedRows | None:
        if element.law is None and element.unknown_sides(threshold).any():
            return None
        numbers = (element.above if side == "above" else element.below)(threshold)
        return SelectedRows(~element.failed, numbers)

    return sample
