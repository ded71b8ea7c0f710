"""Axes of a page: ends, scale and ticks, and the digits that tell values apart."""

from math import floor, isfinite, log10
from typing import Any

import numpy as np
from matplotlib.ticker import LogLocator, MaxNLocator

from uq.contract import Floats
from uq.render.figures.panel import is_wide

_MOST_TICKS = 7
_MOST_DIGITS = 13
_SHORT = 8.0  # a logarithmic axis that spans a smaller factor has evenly spaced ticks


def axis_of(values: Floats, per: float) -> dict[str, Any]:
    """Return the ends of an axis, whether it is logarithmic, and its ticks.

    Parameters
    ----------
    values : ndarray
        Some may be infinite.
    per : float
        The size of the unit shown, in which ticks are round.
    """
    finite = values[np.isfinite(values)]
    low, high = (float(finite.min()), float(finite.max())) if len(finite) else (0.0, 1.0)
    if low == high:
        low, high = low - abs(low or 1.0) / 2, high + abs(high or 1.0) / 2
    wide = bool(is_wide(finite)) and low > 0
    return {"low": low, "high": high, "wide": wide, "ticks": _ticks(low, high, per, wide)}


def common_digits(axis: dict[str, Any]) -> int:
    """Return how many digits the values of an axis have in common."""
    low, high = axis["low"], axis["high"]
    alike = floor(log10(max(-low, high)) - log10(high - low)) if isfinite(high - low) else 0
    return min(max(alike, 0), _MOST_DIGITS)


def _ticks(low: float, high: float, per: float, wide: bool) -> list[float]:
    """Return round numbers between two ends, in the unit shown; the ends where there are none."""
    first, last = low / per, high / per
    if not (isfinite(last - first) and last - first > np.finfo(float).tiny):
        return [low, high]
    if wide and last / first > _SHORT:
        decades = log10(last) - log10(first)
        steps = (1.0, 2.0, 5.0) if decades <= 2 else (1.0, 3.0) if decades <= 4 else (1.0,)
        places = LogLocator(subs=steps, numticks=_MOST_TICKS).tick_values(first, last)
    else:
        places = MaxNLocator(_MOST_TICKS, steps=[1, 2, 5, 10]).tick_values(first, last)
    inside = [float(place * per) for place in places if first <= place <= last]
    return inside if len(inside) > 1 else [low, high]
