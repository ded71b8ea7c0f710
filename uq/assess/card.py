"""The card of a result: the few numbers, causes, checks and next steps that fit on a screen."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf, isfinite, nan
from typing import Any, NamedTuple

from uq.assess.answer.answer import conclude
from uq.assess.answer.contributions import AverageEffect, Ranking
from uq.assess.answer.facts import Answer
from uq.assess.answer.parts import Event, Quantity
from uq.assess.answer.remedies import Advice, TighterTolerance
from uq.assess.answer.sources import ASSUMED, mark_of
from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.answer.wording import DisplayUnit, called_together, share_text
from uq.assess.findings import Findings
from uq.result.result import Result
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.text.keys import key_of
from uq.text.numbers import capitalized, counted, percent, percent_interval

MOST_CAUSES = 4
MOST_REGIMES = 4


@dataclass(frozen=True)
class Headline:
    """A number of a card.

    Attributes
    ----------
    key : str
        For ``uq trace``.
    label : str
    estimate : Estimate
        In the unit of the output; a bound has no interval.
    unit : str
        CF unit of the estimate; ``1`` of a probability.
    shown : DisplayUnit or None
        Unit in which it is shown; None for a share in per cent.
    towards : float
        Infinite for a bound: it is rounded to its safe side.
    note : str
        Its meaning, beside it; shown instead of an interval.
    is_main : bool
        Whether it answers the question of the study.
    """

    key: str
    label: str
    estimate: Estimate
    unit: str
    shown: DisplayUnit | None
    towards: float = 0.0
    note: str = ""
    is_main: bool = False

    @property
    def value(self) -> str:
        """The number with its unit."""
        if self.shown is None:
            return percent(self.estimate.value)
        return self.shown.text(self.estimate.value, self.towards)

    @property
    def interval(self) -> str:
        """Its 95 % interval; "" without one."""
        if not self.estimate.has_interval:
            return ""
        low, high = self.estimate.low, self.estimate.high
        if self.shown is None:
            return percent_interval(low, high)
        return self.shown.between(low, high)


class Cause(NamedTuple):
    """Inputs that contribute to the scatter of the subject of a study.

    Attributes
    ----------
    inputs : tuple of str
    indices : tuple of Estimate
        The index of each input.
    share : str
        The indices in words.
    effect : AverageEffect or None
        Average change of the subject with the first input; None where it is unknown.
    tightened : TighterTolerance or None
        A number of the subject with half the scatter of the inputs; None where it is unknown.
    """

    inputs: tuple[str, ...]
    indices: tuple[Estimate, ...]
    share: str
    effect: AverageEffect | None
    tightened: TighterTolerance | None


@dataclass(frozen=True)
class Card:
    """The answer of a study on one screen.

    Attributes
    ----------
    name, title, subject : str
        Of the study; and the output that it is about.
    model, design : str
    rows, failed : int
    row_name : tuple of str
        Singular and plural of what a row is.
    headline : tuple of Headline
    assumed : tuple of str
        Assumed quantities with which every life scales.
    warning : str
        How assumptions limit the numbers; "" if they do not.
    causes : tuple of Cause
    share_of : str
        The variance that the indices are shares of, or the meaning of the index.
    no_causes : str
        Why no input leads, or "".
    checks, next : tuple of str
        Short sentences.
    """

    name: str
    title: str
    subject: str
    model: str
    design: str
    rows: int
    failed: int
    row_name: tuple[str, str]
    headline: tuple[Headline, ...] = ()
    assumed: tuple[str, ...] = ()
    warning: str = ""
    causes: tuple[Cause, ...] = ()
    share_of: str = ""
    no_causes: str = ""
    checks: tuple[str, ...] = ()
    next: tuple[str, ...] = ()

    @property
    def json(self) -> dict[str, Any]:
        """The card in plain data; numbers in the units of the outputs."""
        return {
            "title": self.title,
            "rows": self.rows,
            "failed": self.failed,
            "headline": [
                {"key": line.key, "label": line.label}
                | estimate_json.numbers(line.estimate)
                | {"unit": line.unit}
                for line in self.headline
            ],
            "assumed": list(self.assumed),
            "causes": [
                {"input": name}
                | dict(zip(("share", "low", "high"), _plain(index), strict=True))
                | {
                    "of": self.share_of,
                    "effect": None if cause.effect is None else _effect_json(cause.effect),
                    "tightened": None
                    if cause.tightened is None
                    else _tightened_json(cause.tightened),
                }
                for cause in self.causes
                for name, index in zip(cause.inputs, cause.indices, strict=True)
            ],
            "checks": list(self.checks),
            "next": list(self.next),
        }


def _plain(estimate: Estimate) -> list[float | None]:
    return [estimate_json.number(number) for number in estimate.numbers]


def _effect_json(effect: AverageEffect) -> dict[str, Any]:
    unit = effect.unit.name if effect.unit.per == 1.0 else ""
    return {"step": effect.step, "unit": unit} | estimate_json.numbers(effect.by)


def _tightened_json(tolerance: TighterTolerance) -> dict[str, Any]:
    return {"law": tolerance.law, "of": tolerance.statistic} | estimate_json.numbers(
        tolerance.after
    )


def card_of(findings: Findings) -> Card:
    """Return the card of a result."""
    result, answer = findings.result, conclude(findings)
    attrs = result.dataset.attrs
    lead = answer.lead
    causes, share_of, no_causes = _causes(answer)
    return Card(
        result.study.study.name,
        str(attrs["title"]),
        "" if lead is None else capitalized(lead.words),
        str(attrs["source"]),
        result.design_name,
        answer.rows,
        answer.failed,
        row_name_of(result),
        tuple(_headline(findings, answer)),
        () if lead is None else lead.scaled_by,
        _warning(result, answer),
        causes,
        share_of,
        no_causes,
        tuple(_checks(result, answer)),
        tuple(_next(answer.advice)),
    )


def row_name_of(result: Result) -> tuple[str, str]:
    """Return singular and plural of what a row of a result is."""
    singular, _, plural = str(result.dataset.attrs.get("row_name", "row rows")).partition(" ")
    return singular, plural


def _headline(findings: Findings, answer: Answer) -> Iterator[Headline]:
    regimes = [_of_regime(regime) for regime in answer.main_regimes[:MOST_REGIMES]]
    if answer.regimes_first:
        yield from regimes
    lead = answer.lead
    if lead is None:
        return
    events = [_of_event(lead, event) for event in lead.events if isfinite(event.share.value)]
    bound = [*_of_promise(findings, lead)]
    middle = [*_of_range(findings, lead)]
    yield from [*bound, *middle, *events] if lead.is_life else [*events, *bound, *middle]


def _of_regime(regime: Event) -> Headline:
    key = key_of("regime", regime.predicate, "share")
    return Headline(key, regime.predicate, regime.share, "1", None, is_main=True)


def _of_event(quantity: Quantity, event: Event) -> Headline:
    key = key_of("quantities", quantity.name, "events", event.name, "share", verb="answer")
    label = event.predicate.removesuffix(" in magnitude").replace("exceed", "beyond")
    label = label.removeprefix("end ").removeprefix("succeed ")
    return Headline(key, label, event.share, "1", None, is_main=not quantity.is_life)


def _of_promise(findings: Findings, quantity: Quantity) -> Iterator[Headline]:
    promise = quantity.promise
    if promise is None:
        return
    unit = findings.result.outputs[quantity.output].unit
    noun = "life" if quantity.is_life else "bound"
    for side, bound, towards in (("lower", promise.lower, -inf), ("upper", promise.upper, inf)):
        if isfinite(bound):
            label = f"{100 * promise.coverage:g}/{100 * promise.confidence:g} {noun}"
            note = f"{100 * promise.coverage:g} % {_does(promise, side)};"
            note += f" {100 * promise.confidence:g} % confidence (sampling)"
            key = key_of("quantities", quantity.name, "promise", side, verb="answer")
            yield Headline(
                key, label, Estimate(bound), unit, promise.unit, towards, note, quantity.is_life
            )
    if isfinite(promise.lower) or isfinite(promise.upper):
        return
    for p, estimate, side in zip(
        promise.probabilities, promise.quantiles, ("lower", "upper"), strict=True
    ):
        if isfinite(estimate.value):
            key = key_of("quantities", quantity.name, "promise", f"{side}_quantile", verb="answer")
            yield Headline(key, f"{100 * p:g} % quantile", estimate, unit, promise.unit)


def _does(promise: ToleranceBound, side: str) -> str:
    if promise.of_magnitude:
        return "stay within it"
    if promise.is_life:
        return f"{promise.ends} by then" if side == "upper" else "outlast it"
    return "stay below it" if side == "upper" else "stay above it"


def _of_range(findings: Findings, quantity: Quantity) -> Iterator[Headline]:
    likely = quantity.range
    if likely is None:
        return
    unit = findings.result.outputs[quantity.output].unit

    def key(name: str) -> str:
        return key_of("quantities", quantity.name, "range", name, verb="answer")

    if isfinite(likely.median.value):
        noun = "median magnitude" if likely.of_magnitude else "median"
        yield Headline(key("median"), noun, likely.median, unit, likely.unit)
    described = findings.summary.outputs.get(quantity.name)
    b10 = described.find("b_lives", "B10") if described is not None else None
    if b10 is not None and isfinite(b10.best.estimate.value):
        path = key_of("outputs", quantity.name, "b_lives", "B10")
        yield Headline(path, "B10", b10.best.estimate, unit, likely.unit)
    low, high = likely.low.value, likely.high.value
    if isfinite(low) and isfinite(high):
        middle = Estimate(nan, low, high)
        yield Headline(key("low"), "90 % between", middle, unit, likely.unit)
    if likely.never.value > 0:
        verb = "never end" if likely.ends == "end" else f"never {likely.ends}"
        yield Headline(key("never"), verb, likely.never, "1", None)


def _warning(result: Result, answer: Answer) -> str:
    lead = answer.lead
    names = () if lead is None else lead.scaled_by
    laws = [name for name in result.study.uncertain if name in result.dataset.variables]
    assumed = [name for name in laws if mark_of(result, name) == ASSUMED]
    counts = f"{len(assumed)} of {counted(len(laws), 'law')} assumed" if assumed else ""
    if names:
        both = "both assumed" if len(names) == 2 else "assumed"
        sets = "sets" if len(names) == 1 else "set"
        return f"not a prediction: {called_together(names)} {sets} the scale, {both}; {counts}"
    return counts


def _causes(answer: Answer) -> tuple[tuple[Cause, ...], str, str]:
    """Return the leading causes, what their indices are shares of, and why there are none."""
    ranking = _ranking(answer)
    if ranking is None:
        return (), "", ""
    if ranking.leader is None:
        return (), "", ranking.reason or "no input contributes measurably"
    tolerances = [entry for advice in answer.advice for entry in advice.tolerances]
    quantiles = [entry for entry in tolerances if not entry.is_share]
    is_life = answer.lead is not None and answer.lead.is_life
    preferred = quantiles or tolerances if is_life else tolerances
    statistic = preferred[0].statistic if preferred else ""
    compared = {entry.inputs: entry for entry in tolerances if entry.statistic == statistic}
    causes = [
        Cause(
            contribution.inputs,
            contribution.indices,
            contribution.size,
            contribution.changes[0] if contribution.changes else None,
            compared.get(contribution.inputs) or compared.get(contribution.sure),
        )
        for contribution in ranking.contributions[:MOST_CAUSES]
    ]
    return tuple(causes), ranking.share_of or ranking.index_meaning, ""


def _ranking(answer: Answer) -> Ranking | None:
    if answer.regimes_first:
        causes = [regime.ranking for regime in answer.regime_causes]
        return next((ranking for ranking in causes if ranking is not None), None)
    return None if answer.lead is None else answer.lead.ranking


def _checks(result: Result, answer: Answer) -> Iterator[str]:
    enough, lead = answer.enough, answer.lead
    singular, plural = row_name_of(result)
    if answer.failed:
        share = percent(answer.failed / max(answer.rows, 1))
        yield f"{share} of the {plural} failed: numbers describe the others"
    if enough.unknown:
        yield f"sample size cannot be judged: {enough.unknown}"
    elif enough.question:
        yield f"too few {plural}: {enough.question[0].clause}"
    else:
        yield f"enough {plural}"
    error = None if lead is None else lead.own_error
    if error is not None and error.missed > 0:
        yield f"{percent(error.missed)} of the {plural} miss {100 * error.asked:g} % accuracy"
    if answer.regimes and not answer.regimes_first:
        first = answer.regimes[0]
        yield f"{share_text(first.share)} {first.predicate}"


def _next(advice: Sequence[Advice]) -> Iterator[str]:
    for entry in advice:
        words = called_together(entry.inputs) if entry.inputs else ""
        match entry.rule:
            case "measure":
                yield f"measure {words}"
            case "tighten" if entry.tightened is not None and entry.tightened.law:
                yield f"tighten {words}: {entry.tightened.law}"
            case "source":
                yield f"add a source for {words}"
            case "rows" if entry.rows is not None:
                yield f"compute about {entry.rows} rows"
            case "failed":
                yield "compute the failed rows again"
            case "finer":
                yield "compute more accurate rows"
            case "keep":
                yield f"keep {words} within its good range"
            case "nothing":
                yield "nothing: the question is settled"
