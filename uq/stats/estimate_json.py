"""Estimates as JSON: a number that is not finite becomes null, and the reason is stored with it."""

from math import isfinite
from typing import Any

from uq.stats.estimate import Estimate


def number(value: float) -> float | None:
    """Return the number, or None if it is not finite."""
    return float(value) if isfinite(value) else None


def numbers(estimate: Estimate) -> dict[str, float | None]:
    """Return value and interval as a dictionary."""
    return {"value": number(estimate.value), **ends(estimate)}


def ends(estimate: Estimate) -> dict[str, float | None]:
    """Return the interval alone as a dictionary."""
    return {"low": number(estimate.low), "high": number(estimate.high)}


def whole(estimate: Estimate) -> dict[str, Any]:
    """Return value and interval, the reason for each null, and the assumptions."""
    entry: dict[str, Any] = numbers(estimate)
    for name in ("value", "low", "high"):
        entry |= flag("" if name == "value" else f"{name}_", estimate, name)
    if estimate.reason:
        entry["reason"] = estimate.reason
    if estimate.assumes:
        entry["assumes"] = estimate.assumes
    return entry


def flag(prefix: str, estimate: Estimate, name: str) -> dict[str, bool]:
    """Return flags for a life that never ends, or exceeds the horizon."""
    if getattr(estimate, name) != float("inf"):
        return {}
    return {f"{prefix}{'censored' if name in estimate.beyond else 'never'}": True}


def failed(bounds: Estimate | None) -> dict[str, Any]:
    """Return the best-case and worst-case bounds for failed rows as a dictionary."""
    entry: dict[str, Any] = {}
    if bounds is not None:
        for name in ("low", "high"):
            entry[f"failed_{name}"] = number(getattr(bounds, name))
            entry |= flag(f"failed_{name}_", bounds, name)
    return entry
