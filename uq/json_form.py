"""Estimates as JSON has them: a number that is not finite is null."""

from math import isfinite

from uq.estimate import Estimate


def number(value: float) -> float | None:
    """Return a number, None for one that is not finite."""
    return float(value) if isfinite(value) else None


def numbers(estimate: Estimate) -> dict[str, float | None]:
    """Return value and interval."""
    return {"value": number(estimate.value), **ends(estimate)}


def ends(estimate: Estimate) -> dict[str, float | None]:
    """Return the interval alone."""
    return {"low": number(estimate.low), "high": number(estimate.high)}
