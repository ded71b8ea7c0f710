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
    """Whether the rows are enough.

    Attributes
    ----------
    unknown : str
        Why that is not known, or "".
    question : tuple of Unsettled
        What is not settled of that which the study is about, the least settled first.
    besides : tuple of Unsettled
        The same of everything else that it asks for.
    errors : Errors or None
        Of what it is about, where the error of the rows themselves is the larger.
    unit : DisplayUnit
        Of these errors.
    again : PredictionInterval
        What another seed would find.
    others : tuple of str
        What is not settled besides the first of the question, in sentences.
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
        """All that is not settled, the least settled first."""
        return tuple(sorted(self.question + self.besides, key=lambda one: -one.factor))

    @property
    def sentence(self) -> str:
        """Whether they are enough, and what another seed would find; "" where nothing is known."""
        again = self.again.sentence
        if self.unknown:
            return again
        if any(isfinite(one.factor) for one in self.question):
            said = "The rows are not enough to settle all of this. "
        elif self.errors is not None:
            said = "More rows alone would not help, more accurate ones would. "
        else:
            said = "" if self.question else "The rows are enough: "
        if not again:
            return ""
        return said + (f"{again[0].lower()}{again[1:]}" if said.endswith(": ") else again)

    @property
    def finer(self) -> str:
        """That the error of the rows themselves is the larger; "" where it is not."""
        if self.errors is None:
            return ""
        own, sampling = (self.unit.text(one) for one in (self.errors.own, self.errors.sampling))
        return (
            "Compute more accurate rows before more of them (finer settings or longer averages):"
            f" their numerical error may move the {self.errors.estimate} by {own}, sampling by"
            f" {sampling}."
        )


def enough_of(
    findings: Findings, answered: Sequence[Quantity], regimes: Sequence[Event] = ()
) -> Enough:
    """Return whether the rows are enough.

    Parameters
    ----------
    findings : Findings
    answered : sequence of Quantity
        The one that the study is about first.
    regimes : sequence of Event
        Those that the study is about; none if it is about a quantity.
    """
    result = findings.result
    why = result.why_no_statistics
    none = f"the rows of a '{result.design_name}' design {why}; use 'monte-carlo'" if why else ""
    unknown = none or why_no_intervals(result).removeprefix("no intervals: ")
    known = result.outputs
    own = [one for one in answered if not is_error(one.output, known)] or [*answered]
    about, rest = ([], own) if regimes else (own[:1], own[1:])
    question = [each for one in about for each in unsettled(one)]
    question += [each for one in regimes for each in unsettled_share(one)]
    question += bounds_unsettled(findings, own)
    besides = [
        replace(each, what=f"{each.what} ({one.words})") for one in rest for each in unsettled(one)
    ]
    errors = None if not about or result.has_weights else _errors(findings, about[0])
    found = Enough(
        unknown,
        tuple(sorted(question, key=lambda one: -one.factor)),
        tuple(sorted(besides, key=lambda one: -one.factor)),
        errors,
        about[0].range.unit if about and about[0].range is not None else DisplayUnit(),
        _again(about, regimes),
    )
    others = [one for one in found.every if one is not next(iter(found.question), None)]
    said = (capitalized(settled(one, result)) for one in others if isfinite(one.factor))
    return replace(found, others=tuple(said))


def _again(about: Sequence[Quantity], regimes: Sequence[Event]) -> PredictionInterval:
    if regimes:
        first = regimes[0]
        ranking = None if first.is_of_single else first.ranking
        return repeated_share(f"be {first.said}", first.share, ranking)
    return about[0].repeated if about else PredictionInterval()


def _errors(findings: Findings, one: Quantity) -> Errors | None:
    """Return the errors of a quantity where that of the rows themselves is the larger."""
    (element,) = findings.rows.named_elements(one.name)
    found = compared(findings.rows, element, findings.summary.outputs[one.name])
    return found if found.warning else None


def settled(one: Unsettled, result: Result) -> str:
    """Return what is not settled, and how many rows in all would settle it."""
    return f"{one.what}; {needed(one, result)} in all would settle it."


def needed(one: Unsettled, result: Result) -> str:
    """Return the rows that would settle it, and of how many samples where these have several."""
    many = "more than" if one.factor > MOST else "about"
    factor = min(one.factor, MOST)
    rows = f"{many} {rows_in_words(factor * result.dataset.sizes['row'])} rows"
    samples = rows_in_words(factor * int(result.dataset.attrs["samples"]))
    return f"{rows} ({samples} samples)" if result.is_nested else rows
