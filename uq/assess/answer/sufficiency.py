"""Sufficiency of the sample size: unsettled results, and the sample size they need."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain
from math import ceil, floor, inf, isfinite, isnan, log10
from typing import Any

from uq.assess.answer.events import Event
from uq.assess.answer.quantities import Quantity
from uq.assess.answer.repeat_interval import repeated_share
from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.answer.wording import DisplayUnit
from uq.assess.convergence import Errors, compared
from uq.assess.fact import Fact
from uq.assess.findings import Findings
from uq.assess.summary import why_no_intervals
from uq.result.result import Result
from uq.result.variables import is_error
from uq.sampling.designs import DESIGNS
from uq.text.numbers import capitalized, grouped, percent, rounded_up, rows_in_words

SHARE = 0.2
"""A probability is settled if its half-width is at most this fraction of the rarer side ..."""

POINT = 0.01
"""... or at most a percentage point."""

BOUND = 0.1
"""A tolerance bound is settled if it is within this fraction of the quantile that it bounds (of a
life), or of the likely range."""

_FINEST = 10.0  # factor on the accuracy beyond which errors hardly follow it

MOST = 100.0
"""Largest factor on the sample size that is predicted from its root."""


_BOUNDS = {"tolerance": "tolerance bounds", "joint_bounds": "joint bounds"}


Shortfall = tuple[str, float]
"""A clause on the quantity that needs more rows, and the factor on the sample size it needs.

The factor is infinite if no number of rows would.
"""


def unsettled(quantity: Quantity) -> Iterator[Shortfall]:
    """Yield each insufficiently estimated quantity and the factor on the sample size it needs.

    References
    ----------
    JCGM 101:2008, "Evaluation of measurement data - Supplement 1 to the GUM", 7.9: the standard
    deviation of an estimate falls as one over the root of the number of rows.
    """
    for event in quantity.events:
        yield from unsettled_share(event)
    if quantity.tolerance_bound is not None:
        yield from _of_tolerance_bound(quantity.tolerance_bound, quantity)
    ranking = quantity.ranking
    if ranking is not None and isfinite(ranking.rows_factor):
        yield ranking.reason, ranking.rows_factor
    for event in quantity.events:
        if event.ranking is not None and isfinite(event.ranking.rows_factor):
            clause = f"the main driver of the share that {event.clause} is not settled"
            yield clause, event.ranking.rows_factor


def bounds_unsettled(findings: Findings, answered: Sequence[Quantity]) -> Iterator[Shortfall]:
    """Yield the requested bounds that the sample size does not support."""
    rows = len(findings.rows)
    for key, words in _BOUNDS.items():
        described = (findings.summary.outputs[quantity.name] for quantity in answered)
        bounds = (element.find(key, side) for element in described for side in ("lower", "upper"))
        needed = max((bound.rows_needed or 0.0 for bound in bounds if bound), default=0.0)
        if needed:
            asked = f"the requested {words}"
            clause = f"{asked} require {needed:.0f} rows" if isfinite(needed) else ""
            yield clause or f"too many rows are invalid for {asked}", needed / max(rows, 1)


def unsettled_share(event: Event) -> Iterator[Shortfall]:
    """Yield the probability of an event, if not settled."""
    share = event.share
    if isnan(share.value) and event.sentence:
        yield f"{event.sentence[:1].lower()}{event.sentence[1:-1]}", inf
    if not share.has_interval:
        return
    half = (share.high - share.low) / 2
    goal = max(SHARE * min(share.value, 1 - share.value), POINT)
    if half > goal:
        points = percent(half).removesuffix(" %")
        clause = f"the share that {event.clause} is uncertain by ±{points} percentage points (95 %)"
        yield clause, (half / goal) ** 2


def _of_tolerance_bound(tolerance_bound: ToleranceBound, quantity: Quantity) -> Iterator[Shortfall]:
    likely = quantity.range
    if likely is None:
        return
    for bound, estimate, end, outwards in (
        (tolerance_bound.lower, likely.low, tolerance_bound.quantiles[0].low, -inf),
        (tolerance_bound.upper, likely.high, tolerance_bound.quantiles[1].high, inf),
    ):
        reached = bound if isfinite(bound) else end
        if not (isfinite(reached) and isfinite(estimate.value)):
            continue
        scale = abs(estimate.value)
        if not tolerance_bound.is_life:
            scale = abs(likely.high.value - likely.low.value)
        away = abs(estimate.value - reached)
        # Farther away, the quantile is at a jump of the values, which more rows hardly help.
        if isfinite(scale) and BOUND * scale < away < BOUND * scale * MOST**0.5:
            text = tolerance_bound.unit.text(reached, outwards)
            best = tolerance_bound.unit.text(estimate.value)
            clause = f"the conservative bound, {text}, is far from the estimate, {best}"
            yield clause, (away / (BOUND * scale)) ** 2


@dataclass(frozen=True)
class SampleSizeAssessment:
    """Sufficiency of the sample size.

    Attributes
    ----------
    unknown : str
        Reason why it is unknown, or "".
    question : tuple of Shortfall
        Unsettled results on the subject of the study, the least settled first.
    besides : tuple of Shortfall
        Unsettled results on everything else, the least settled first.
    errors : Errors or None
        Errors of the subject, if the numerical error exceeds the sampling error.
    unit : DisplayUnit
        Unit of these errors.
    setting : str
        The setting and its value that reduce the numerical error to the sampling error, or "".
    again : Fact
        Prediction interval for another seed.
    of_share : bool
        Whether that is one of a probability.
    others : tuple of str
        Sentences on all unsettled results but the first of the question.
    """

    unknown: str = ""
    question: tuple[Shortfall, ...] = ()
    besides: tuple[Shortfall, ...] = ()
    errors: Errors | None = None
    unit: DisplayUnit = field(default_factory=DisplayUnit)
    setting: str = ""
    again: Fact = field(default_factory=lambda: Fact({}))
    of_share: bool = False
    others: tuple[str, ...] = ()

    def fact(self, result: Result | None = None) -> Fact:
        """Return sufficiency, predictions and errors."""
        members: dict[str, Any] = {"sentence": self.sentence, "others": list(self.others)}
        mentions: tuple[tuple[str], ...] = ()
        if self.of_share and "expected" in self.again.members:
            ends, mentions = self.again.members["expected"], (("expected",),)
            members["expected"] = Fact(ends, self.again.by, rows=result)
        if self.errors is not None:
            errors = {"own_error": self.errors.numerical, "sampling_error": self.errors.sampling}
            members |= errors
        settled = not (self.question or self.unknown or self.errors)
        rows = None if result is None else result.independent
        return Fact(members, (compared,), rows=rows, mentions=mentions, more={"settled": settled})

    @property
    def every(self) -> tuple[Shortfall, ...]:
        """All unsettled results, the least settled first."""
        return least_settled_first(self.question + self.besides)

    @property
    def sentence(self) -> str:
        """Sufficiency and prediction for another seed; "" if unknown."""
        again = self.again.sentence
        if self.unknown:
            return again
        if any(isfinite(factor) for _, factor in self.question):
            opening = "Sample size is not sufficient for all of this. "
        elif self.errors is not None:
            opening = "Numerical error dominates: more accurate rows would help, more rows not. "
        else:
            opening = "" if self.question else "Sample size is sufficient: "
        if not again:
            return ""
        return opening + (f"{again[0].lower()}{again[1:]}" if opening.endswith(": ") else again)

    @property
    def finer(self) -> str:
        """Advice on a dominant numerical error; "" if it does not dominate."""
        if self.errors is None:
            return ""
        numerical, sampling = (
            self.unit.text(error) for error in (self.errors.numerical, self.errors.sampling)
        )
        how = self.setting or "finer settings or longer averages"
        return (
            f"Reduce numerical error ({how}) before adding rows: it may"
            f" change the {self.errors.estimate} by {numerical}, sampling by {sampling}."
        )


def enough_of(
    findings: Findings, answered: Sequence[Quantity], regimes: Sequence[Event] = ()
) -> SampleSizeAssessment:
    """Return the sufficiency of the sample size.

    Parameters
    ----------
    findings : Findings
    answered : sequence of Quantity
        The subject of the study first.
    regimes : sequence of Event
        The subject of the study; none if that is a quantity.
    """
    result = findings.result
    why = result.why_no_statistics
    none = f"the rows of a '{result.design_name}' design {why}; use 'monte-carlo'" if why else ""
    unknown = none or why_no_intervals(result).removeprefix("no intervals: ")
    outputs = result.outputs
    primary = [quantity for quantity in answered if not is_error(quantity.output, outputs)] or [
        *answered
    ]
    about, rest = ([], primary) if regimes else (primary[:1], primary[1:])
    question = [
        *chain.from_iterable(map(unsettled, about)),
        *chain.from_iterable(map(unsettled_share, regimes)),
        *bounds_unsettled(findings, primary),
    ]
    besides = [
        (f"{clause} ({quantity.words})", factor)
        for quantity in rest
        for clause, factor in unsettled(quantity)
    ]
    errors = None if not about or result.has_weights else _errors(findings, about[0])
    enough = SampleSizeAssessment(
        unknown,
        least_settled_first(question),
        least_settled_first(besides),
        errors,
        about[0].range.unit if about and about[0].range is not None else DisplayUnit(),
        _finer_setting(result, about[0], errors) if errors is not None else "",
        _prediction(about, regimes),
        bool(regimes) or any(quantity.first is not None for quantity in about),
    )
    first = next(iter(enough.question), None)
    sentences = (
        capitalized(settled(*shortfall, result))
        for shortfall in enough.every
        if shortfall is not first and isfinite(shortfall[1])
    )
    return replace(enough, others=tuple(sentences))


def least_settled_first(shortfalls: Iterable[Shortfall]) -> tuple[Shortfall, ...]:
    """Return shortfalls, the one that needs most rows first."""
    return tuple(sorted(shortfalls, key=lambda shortfall: -shortfall[1]))


def _prediction(about: Sequence[Quantity], regimes: Sequence[Event]) -> Fact:
    if regimes:
        first = regimes[0]
        ranking = None if first.is_of_single else first.ranking
        return repeated_share(f"be {first.predicate}", first.share, ranking, first.by)
    return about[0].repeated if about else Fact({})


def _errors(findings: Findings, quantity: Quantity) -> Errors | None:
    """Return the errors of a quantity, if its numerical error exceeds its sampling error."""
    (element,) = findings.rows.named_elements(quantity.name)
    errors = compared(findings.rows, element, findings.summary.outputs[quantity.name])
    return errors if errors.warning else None


def _finer_setting(result: Result, quantity: Quantity, errors: Errors) -> str:
    """Return the setting of the accuracy with a value that equals the sampling error; "" if none.

    None either where the errors are many times the accuracy: they do not follow it.

    At most half the present value, since errors are rarely as large as the accuracy allows.
    """
    setting = result.outputs[quantity.output].accuracy
    asked = None if quantity.own_error is None else quantity.own_error.members["accuracy"]
    if not setting or not asked or not isfinite(errors.sampling):
        return ""
    finer = asked * min(errors.sampling / errors.numerical, 0.5)
    if finer < asked / _FINEST:
        return ""
    digit = 10.0 ** floor(log10(finer))
    return f"set {setting} = {floor(finer / digit) * digit:.1g}"


def settled(clause: str, factor: float, result: Result) -> str:
    """Return an unsettled result and the sample size that would settle it."""
    return f"{clause}; {needed(factor, result)} in total would settle it."


def needed(factor: float, result: Result) -> str:
    """Return so many times the rows in words, with samples if these have several rows."""
    many = "more than" if factor > MOST else "about"
    rows, samples = rounded_size(size_for(factor, result), result)
    of_samples = f" ({grouped(samples)} samples)" * (rows != samples)
    return f"{many} {rows_in_words(rows) if rows == samples else grouped(rows)} rows{of_samples}"


def size_for(factor: float, result: Result) -> int:
    """Return a number of rows that the design allows, for a factor on the rows.

    Parameters
    ----------
    factor : float
        Limited to `MOST`.
    result : Result

    Returns
    -------
    int
        At least the factor times the rows of the result. A sample, of which some designs need a
        power of two, has a row of every replicate and block of the design.
    """
    samples = int(result.dataset.attrs["samples"])
    rows_of_a_sample = max(len(result) // samples, 1)
    wanted = ceil(min(factor, MOST) * len(result) / rows_of_a_sample)
    if DESIGNS[result.design_name].power_of_two:
        wanted = 1 << (wanted - 1).bit_length()
    return wanted * rows_of_a_sample


def rounded_size(rows: int, result: Result) -> tuple[int, int]:
    """Return a number of rows and its samples, rounded up to two digits if the design allows it."""
    rows_of_a_sample = max(len(result) // int(result.dataset.attrs["samples"]), 1)
    samples = ceil(rows / rows_of_a_sample)
    if not DESIGNS[result.design_name].power_of_two:
        samples = rounded_up(samples)
    return samples * rows_of_a_sample, samples
