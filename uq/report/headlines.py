"""The key results as a few sentences at the top of a report."""

from collections.abc import Iterator, Sequence
from math import isfinite

from uq.analysis.statistics.statistic import Statistic
from uq.analysis.summary import Summary
from uq.report.indices import Method
from uq.report.outcomes import Outcome
from uq.wording import brief, percent, percent_with_interval

_MOST = 6
"""Outputs, and targets, that get a sentence."""


def headlines(
    summary: Summary, failed: int, found: Sequence[Outcome], methods: Sequence[Method]
) -> list[str]:
    """Return the sentences.

    Parameters
    ----------
    summary : Summary
    failed : int
        Rows.
    found : sequence of Outcome
    methods : sequence of Method

    Returns
    -------
    list of str
    """
    ended = f"{failed} of {summary.samples} rows failed." if failed else "All rows were computed."
    return [ended, *_regimes(summary), *_outputs(found), *_leading(methods)]


def _regimes(summary: Summary) -> Iterator[str]:
    seen = [one for one in summary.regimes.values() if one.facts["count"]]
    seen.sort(key=lambda one: -one.facts["count"])
    if seen:
        shares = (f"{one.label} {percent(one.estimate.value)}" for one in seen)
        yield f"Regimes: {', '.join(shares)}."


def _outputs(found: Sequence[Outcome]) -> Iterator[str]:
    """Yield the results that the study requests, output by output."""
    for outcome in found[:_MOST]:
        sentences = (
            _sentence(outcome, one)
            for part in outcome.parts.values()
            for one in part
            if one.sentence
        )
        if text := " ".join(filter(None, sentences)):
            yield f"{outcome.words[:1].upper()}{outcome.words[1:]}: {text[:1].lower()}{text[1:]}"


def _sentence(outcome: Outcome, one: Statistic) -> str:
    """Fill in the numbers of a sentence; "" if they are unknown."""
    if "{brief}" in one.sentence:
        return "" if one.words() == "-" else one.sentence.format(brief=_brief(outcome, one))
    if not isfinite(one.estimate.value):
        return ""
    return one.sentence.format(
        number=outcome.in_its_unit(one.estimate.value),
        share=percent_with_interval(one.estimate, one.failed) if one.at is not None else "",
        at="" if one.at is None else outcome.in_its_unit(one.at),
    )


def _brief(outcome: Outcome, one: Statistic) -> str:
    """Return a value, rounded to its precision, with its unit and interval."""
    value, ends = brief(one.estimate, outcome.per(one))
    if isfinite(one.estimate.value):
        value = f"{value} {outcome.unit_cell.text}".strip()
    return f"{value}{f' (95 % interval {ends})' if ends else ''}"


def _leading(methods: Sequence[Method]) -> Iterator[str]:
    subjects = [one for method in methods[:1] for one in method.subjects if one.leading]
    for one in subjects[:_MOST]:
        yield one.leading
