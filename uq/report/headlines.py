"""The few sentences at the top of a report: what a reader must know before any table."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from uq.report.indices import Method
from uq.report.outcomes import Outcome
from uq.wording import brief, known, percent, percent_with_interval

_MOST = 6
"""Outputs, and targets, of which there is a sentence."""


def headlines(
    summary: Mapping[str, Any],
    failed: int,
    found: Sequence[Outcome],
    methods: Sequence[Method],
    tolerance: tuple[float, float] | None,
) -> list[str]:
    """Return the sentences.

    Parameters
    ----------
    summary : dict
        What `uq.analysis.statistics.summarise` returns.
    failed : int
        Rows.
    found : sequence of Outcome
    methods : sequence of Method
    tolerance : tuple of float, optional
        Coverage and confidence of the bounds.

    Returns
    -------
    list of str
    """
    ended = f"{failed} of {summary['samples']} rows failed." if failed else "No row failed."
    return [ended, *_regimes(summary), *_outputs(found, tolerance), *_leading(methods)]


def _regimes(summary: Mapping[str, Any]) -> Iterator[str]:
    seen = [(label, one) for label, one in summary["regime"].items() if one["count"]]
    seen.sort(key=lambda pair: -pair[1]["count"])
    if seen:
        shares = (f"{label} {percent(one['share'])}" for label, one in seen)
        yield f"Regimes: {', '.join(shares)}."


def _outputs(found: Sequence[Outcome], tolerance: tuple[float, float] | None) -> Iterator[str]:
    """Yield what the study asks of each output."""
    for one in found[:_MOST]:
        if text := " ".join([*_median(one), *_bound(one, tolerance), *_probabilities(one)]):
            yield f"{one.words[:1].upper()}{one.words[1:]}: {text[:1].lower()}{text[1:]}"


def _median(one: Outcome) -> Iterator[str]:
    median = one.entry["quantiles"].get("0.5")
    if median is not None and known(median) != "-":
        value, ends = brief(median, one.unit.seconds)
        if value not in ("never", "beyond the horizon"):
            value = f"{value} {one.unit_cell.text}".strip()
        yield f"Median {value}{f' (95 % interval {ends})' if ends else ''}."


def _bound(one: Outcome, tolerance: tuple[float, float] | None) -> Iterator[str]:
    """Yield what most lives surely reach."""
    lower = (one.entry["tolerance"] or {}).get("lower")
    if tolerance is not None and one.declared.is_lifetime and lower is not None:
        coverage, confidence = (f"{100 * share:g} %" for share in tolerance)
        least = one.in_its_unit(lower)
        yield f"With {confidence} confidence, {coverage} of all take longer than {least}."


def _probabilities(one: Outcome) -> Iterator[str]:
    """Yield the share on the far side of each threshold: of lives, those that have ended."""
    side = "below" if one.declared.is_lifetime else "above"
    words = "end within {}" if one.declared.is_lifetime else "lie above {}"
    words = "lie beyond {} on either side" if one.declared.is_angle else words
    for threshold, entry in one.entry["thresholds"].items():
        if entry[side]["value"] is not None:
            where = words.format(one.in_its_unit(float(threshold)))
            yield f"{percent_with_interval(entry[side])} {where}."


def _leading(methods: Sequence[Method]) -> Iterator[str]:
    subjects = [one for method in methods[:1] for one in method.subjects if one.leading]
    for one in subjects[:_MOST]:
        yield one.leading
