"""Sufficiency of the rows for the subject of a study, and predictions for another seed."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import isfinite

from uq.assess.answer.parts import Event, Quantity
from uq.assess.answer.repeat_interval import PredictionInterval, repeated_share
from uq.assess.answer.sample_size import (
    MOST,
    Unsettled,
    bounds_unsettled,
    unsettled,
    unsettled_share,
)
from uq.assess.answer.wording import DisplayUnit
from uq.assess.convergence import Errors, compared
from uq.assess.findings import Findings
from uq.assess.summary import why_no_intervals
from uq.result.result import Result
from uq.result.variables import is_error
from uq.text.numbers import capitalized, rows_in_words


@dataclass(frozen=True)
class Enough:
    """Sufficiency of the sample size.

    Attributes
    ----------
    unknown : str
        Reason why it is unknown, or "".
    question : tuple of Unsettled
        Unsettled results on the subject of the study, the least settled first.
    besides : tuple of Unsettled
        Unsettled results on everything else, the least settled first.
    errors : Errors or None
        Errors of the subject, if the numerical error exceeds the sampling error.
    unit : DisplayUnit
        Unit of these errors.
    again : PredictionInterval
        Prediction interval for another seed.
    others : tuple of str
        Sentences on all unsettled results but the first of the question.
    """

    unknown: str = ""
    question: tuple[Unsettled, ...] = ()
    besides: tuple[Unsettled, ...] = ()
    errors: Errors | None = None
    unit: DisplayUnit = field(default_factory=DisplayUnit)
    again: PredictionInterval = field(default_factory=PredictionInterval)
    others: tuple[str, ...] = ()

    @property
    def every(self) -> tuple[Unsettled, ...]:
        """All unsettled results, the least settled first."""
        return tuple(sorted(self.question + self.besides, key=lambda shortfall: -shortfall.factor))

    @property
    def sentence(self) -> str:
        """Sufficiency and prediction for another seed; "" if unknown."""
        again = self.again.sentence
        if self.unknown:
            return again
        if any(isfinite(shortfall.factor) for shortfall in self.question):
            opening = "The rows are not enough to settle all of this. "
        elif self.errors is not None:
            opening = "More rows alone would not help, more accurate ones would. "
        else:
            opening = "" if self.question else "The rows are enough: "
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
        return (
            "Compute more accurate rows before more of them (finer settings or longer averages):"
            f" their numerical error may move the {self.errors.estimate} by {numerical},"
            f" sampling by {sampling}."
        )


def enough_of(
    findings: Findings, answered: Sequence[Quantity], regimes: Sequence[Event] = ()
) -> Enough:
    """Return whether the rows are enough.

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
    question = [unsettled_number for quantity in about for unsettled_number in unsettled(quantity)]
    question += [
        unsettled_number for regime in regimes for unsettled_number in unsettled_share(regime)
    ]
    question += bounds_unsettled(findings, primary)
    besides = [
        replace(other, clause=f"{other.clause} ({quantity.words})")
        for quantity in rest
        for other in unsettled(quantity)
    ]
    errors = None if not about or result.has_weights else _errors(findings, about[0])
    enough = Enough(
        unknown,
        tuple(sorted(question, key=lambda shortfall: -shortfall.factor)),
        tuple(sorted(besides, key=lambda shortfall: -shortfall.factor)),
        errors,
        about[0].range.unit if about and about[0].range is not None else DisplayUnit(),
        _prediction(about, regimes),
    )
    others = [
        shortfall
        for shortfall in enough.every
        if shortfall is not next(iter(enough.question), None)
    ]
    sentences = (
        capitalized(settled(shortfall, result))
        for shortfall in others
        if isfinite(shortfall.factor)
    )
    return replace(enough, others=tuple(sentences))


def _prediction(about: Sequence[Quantity], regimes: Sequence[Event]) -> PredictionInterval:
    if regimes:
        first = regimes[0]
        ranking = None if first.is_of_single else first.ranking
        return repeated_share(f"be {first.predicate}", first.share, ranking)
    return about[0].repeated if about else PredictionInterval()


def _errors(findings: Findings, quantity: Quantity) -> Errors | None:
    """Return the errors of a quantity, if its numerical error exceeds its sampling error."""
    (element,) = findings.rows.named_elements(quantity.name)
    errors = compared(findings.rows, element, findings.summary.outputs[quantity.name])
    return errors if errors.warning else None


def settled(shortfall: Unsettled, result: Result) -> str:
    """Return an unsettled result and the sample size that would settle it."""
    return f"{shortfall.clause}; {needed(shortfall, result)} in all would settle it."


def needed(shortfall: Unsettled, result: Result) -> str:
    """Return the number of rows that would settle it, with samples if these have several rows."""
    many = "more than" if shortfall.factor > MOST else "about"
    factor = min(shortfall.factor, MOST)
    rows = f"{many} {rows_in_words(factor * result.dataset.sizes['row'])} rows"
    samples = rows_in_words(factor * int(result.dataset.attrs["samples"]))
    return f"{rows} ({samples} samples)" if result.is_nested else rows
