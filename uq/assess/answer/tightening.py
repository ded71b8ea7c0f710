"""Effects of halving the scatter of inputs, by importance weights, and the advised tolerance."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from math import hypot, isfinite, sqrt

from uq.assess.answer.contributions import Contribution
from uq.assess.answer.piece_of_advice import Advice
from uq.assess.answer.quantities import Quantity
from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.answer.tolerance_effects import TighterTolerance
from uq.assess.answer.wording import CHOSEN, DisplayUnit, called, mark_of, twin_of, unit_of_input
from uq.assess.targets import split_name
from uq.assess.what_if import reweighted_summary
from uq.errors import InputError, RunError
from uq.result.result import Result
from uq.sampling.law import Law
from uq.sampling.scipy_laws import LogUniform
from uq.stats.estimate import Estimate
from uq.study.file import AnalysisTable, Tied
from uq.text.keys import key_of
from uq.text.numbers import percent

_WIDTHS = ("sd", "cv", "sigma")


def halved(law: Law) -> dict[str, float]:
    """Return the arguments that halve the scatter of a law about its middle; none if unknown.

    Parameters
    ----------
    law : Law
    """
    for name in _WIDTHS:
        if (width := getattr(law, name, None)) is not None:
            return {name: width / 2}
    lower, upper = getattr(law, "lower", None), getattr(law, "upper", None)
    if lower is None or upper is None:
        return {}
    if isinstance(law, LogUniform):
        centre, ratio = sqrt(lower * upper), (upper / lower) ** 0.25
        return {"lower": centre / ratio, "upper": centre * ratio}
    mode: float | None = getattr(law, "mode", None)
    middle = (lower + upper) / 2 if mode is None else mode
    return {"lower": (lower + middle) / 2, "upper": (upper + middle) / 2}


def halvings(result: Result, inputs: Sequence[str]) -> dict[str, dict[str, float]]:
    """Return the arguments that halve the scatter of each input; none if an input has no middle.

    Parameters
    ----------
    result : Result
        A result.
    inputs : sequence of str
    """
    laws = result.study.uncertain
    arguments = {}
    for name in inputs:
        law = laws[name]
        arguments[name] = {} if isinstance(law, Tied) else halved(law)
    return arguments if all(arguments.values()) else {}


def halvings_in_words(result: Result, changes: dict[str, dict[str, float]]) -> str:
    """Return the halved scatter in words: ``sd 0.5 mm instead of 1``; once for equal laws."""
    texts = {name: _in_words(result, name, arguments) for name, arguments in changes.items()}
    if len(set(texts.values())) == 1:
        return next(iter(texts.values()))
    return "; ".join(f"{called(name)}: {text}" for name, text in texts.items())


def _in_words(result: Result, name: str, new: dict[str, float]) -> str:
    law = result.study.uncertain[name]
    old = {key: float(getattr(law, key)) for key in new}
    if "lower" in new:
        is_factor = getattr(law, "times", None) is not None
        unit = DisplayUnit() if is_factor else unit_of_input(result, name)
        then = unit.between(new["lower"], new["upper"])
        return f"{then} instead of {unit.bare_between(old['lower'], old['upper'])}"
    ((key, before),) = old.items()
    if key == "sd":
        unit = unit_of_input(result, name)
        return f"sd {unit.text(new[key])} instead of {unit.number(before)}"
    shown = percent if key == "cv" else "{:.3g}".format
    return f"{key} {shown(new[key])} instead of {shown(before)}"


_PARTS = ("quantiles", "thresholds")
_UNKNOWN = "the rows cannot show the effect"


def tightened(
    result: Result, quantity: Quantity, inputs: Sequence[str]
) -> Iterator[TighterTolerance]:
    """Yield the effects of halving the scatter of inputs on a quantity.

    Parameters
    ----------
    result : Result
        A result.
    quantity : Quantity
    inputs : sequence of str
        All of them at once.
    """
    bounded_quantiles = list(_bounded_quantiles(quantity))
    laws = halvings(result, inputs)
    if not bounded_quantiles or not laws:
        return
    unanswered = TighterTolerance(tuple(inputs), "", law=halvings_in_words(result, laws))
    changes = {
        f"uncertain.{name}.{key}": value
        for name, arguments in laws.items()
        for key, value in arguments.items()
    }
    try:
        keys = [key for key, *_ in bounded_quantiles]
        answer = reweighted_summary(result, changes, _asked(result, quantity, keys), _PARTS)
    except (InputError, RunError) as refusal:
        yield replace(unanswered, reason=f"{_UNKNOWN} ({refusal})")
        return
    described = answer.summary.outputs.get(quantity.name)
    for key, words, before, unit, more in bounded_quantiles:
        statistic = described.find(*key) if described is not None else None
        if statistic is None:
            yield replace(unanswered, statistic=words, reason=_UNKNOWN)
            continue
        after = statistic.best.estimate
        if not isfinite(after.value):
            yield replace(unanswered, statistic=words, reason=f"{_UNKNOWN} ({after.reason})")
            continue
        given = {name: repr(value) for name, value in changes.items()}
        yield replace(
            unanswered,
            statistic=words,
            before=before,
            after=after,
            is_share=key[0] == "thresholds",
            unit=unit,
            effective_rows=answer.effective_rows,
            key=key_of("outputs", quantity.name, *key, verb="what-if", options=given),
            wants_more=more,
            tolerance_bound=_bounding(quantity, key),
            failed=statistic.best.failed,
        )


def _asked(result: Result, quantity: Quantity, keys: Sequence[Sequence[str]]) -> AnalysisTable:
    """Return the [analysis] of a study for this quantity and these quantiles alone."""
    asked = result.analysis_of(quantity.output)
    wanted = {key[1] for key in keys if key[0] == "quantiles"}
    quantiles = tuple(p for p in asked.quantiles if repr(p) in wanted)
    return asked.model_copy(update={"quantiles": quantiles})


def _bounding(quantity: Quantity, key: Sequence[str]) -> ToleranceBound | None:
    if quantity.tolerance_bound is None or key[0] != "quantiles":
        return None
    return quantity.tolerance_bound.of_quantile(float(key[1]))


def _bounded_quantiles(
    quantity: Quantity,
) -> Iterator[tuple[tuple[str, ...], str, Estimate, DisplayUnit, bool | None]]:
    """Yield the numbers that matter: key, words, number, unit, and whether more is better.

    Events without a leading input are skipped.
    """
    for event in quantity.events:
        if event.ranking is not None and event.ranking.denies_a_leader:
            continue
        side = "below" if "<" in event.name else "above"
        key = ("thresholds", split_name(event.name)[2], side)
        words = f"the share of rows that {event.predicate}"
        yield key, words, event.share, DisplayUnit(), quantity.wants_more
    tolerance_bound = quantity.tolerance_bound
    if (
        tolerance_bound is None or tolerance_bound.of_magnitude
    ):  # the quantiles of the rows have a sign
        return
    wants_more = quantity.wants_more
    if quantity.events and wants_more is None:  # which quantile matters is not known
        return
    if quantity.is_life and wants_more is not None:
        wants_more = not wants_more  # more ends are shorter lives
    for p, before in zip(tolerance_bound.probabilities, tolerance_bound.quantiles, strict=True):
        if isfinite(before.value):
            words = f"the {100 * p:g} % quantile"
            yield ("quantiles", repr(p)), words, before, tolerance_bound.unit, wants_more


MOST = 4
"""Tolerances that are compared, of the inputs that contribute most."""

ABOUT = 0.75
"""Gains of at least this fraction of the largest gain count as about equal."""


def tighten(result: Result, quantity: Quantity, leader: Contribution) -> Iterator[Advice]:
    """Yield the tolerance to tighten, its alternatives, and all estimated effects.

    Parameters
    ----------
    result : Result
        A result.
    quantity : Quantity
        The subject of the study.
    leader : Contribution
        The leading contribution: all tolerances are compared by its statistic.
    """
    of_contributions = [
        _shown(result, quantity, contribution)
        for contribution in _candidates(result, quantity, leader)
    ]
    estimated = [
        tolerance
        for tolerances in of_contributions
        for tolerance in tolerances
        if not tolerance.reason
    ]
    better = [
        tolerance
        for tolerance in estimated
        if tolerance.helps and tolerance.is_seen and not tolerance.may_stay
    ]
    if not better:
        refused = [tolerance for tolerance in of_contributions[0] if tolerance.reason]
        yield from (
            Advice("tighten", tolerance.sentence, tolerance.inputs, tightened=tolerance)
            for tolerance in refused[:1]
        )
        return
    compared = [tolerance for tolerance in better if tolerance.statistic == better[0].statistic]
    best, *others = compared[:1]
    if best.wants_more is not None:
        best, *others = sorted(compared, key=lambda tolerance: -tolerance.gain)
    yield Advice(
        "tighten",
        best.sentence,
        best.inputs,
        tightened=best,
        key=best.key,
        alike=tuple(other for other in others if _is_alike(best, other)),
        tolerances=tuple(estimated),
    )


def twins(leader: Contribution) -> tuple[str, ...]:
    """Return the first of the inputs that lead, and its twins among them."""
    return tuple(name for name in leader.sure if twin_of(name) == twin_of(leader.inputs[0]))


def _candidates(result: Result, quantity: Quantity, leader: Contribution) -> list[Contribution]:
    """Return contributions of inputs that are not chosen, without overlaps, the leader first."""
    rankings = [event.ranking for event in quantity.events] + [quantity.ranking]
    candidates = [leader]
    for ranking in rankings:
        for contribution in ranking.contributions if ranking is not None else ():
            inputs = set(contribution.inputs)
            if any(mark_of(result, name) == CHOSEN for name in inputs):
                continue
            if not any(inputs & set(candidate.inputs) for candidate in candidates):
                candidates.append(contribution)
    return candidates[:MOST]


def _shown(
    result: Result, quantity: Quantity, contribution: Contribution
) -> Sequence[TighterTolerance]:
    """Return the effects of halving the scatter of as many inputs as the rows can show."""
    tolerances: list[TighterTolerance] = []
    sets = (contribution.sure, twins(contribution), contribution.inputs[:1])
    for inputs in dict.fromkeys(sets):
        tolerances = list(tightened(result, quantity, inputs))
        if any(not tolerance.reason for tolerance in tolerances):
            break
    return tolerances


def _is_alike(best: TighterTolerance, other: TighterTolerance) -> bool:
    """Return whether another tolerance helps about as much, or the rows cannot distinguish them."""
    if other.gain >= ABOUT * best.gain:
        return True
    return best.gain - other.gain <= hypot(best.half, other.half)
