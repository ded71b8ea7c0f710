"""Times by which a share of the rows has ended, and shares that have ended by a time."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from uq import order_statistics
from uq.analysis.lifetime import curve
from uq.intervals import Ends, Replicates
from uq.rows.elements import Element, Floats

B_LIVES = {"B1": 0.01, "B10": 0.1, "B50": 0.5}
"""Share of rows that has ended by each of the times that engineers ask for."""

ASSUMES = "that censoring says nothing of the life left"
"""What the estimate of Kaplan and Meier asks of the rows."""


def b_lives(element: Element, replicate: Replicates) -> dict[str, dict[str, Any]]:
    """Estimate B1, B10 and B50 of a lifetime, as `life_quantiles` does."""
    return life_quantiles(element, B_LIVES, replicate)


def life_quantiles(
    element: Element, asked: Mapping[str, float], replicate: Replicates
) -> dict[str, dict[str, Any]]:
    """Estimate times by which a share of the rows has ended.

    Parameters
    ----------
    element : Element
        Of independent rows.
    asked : dict of str to float
        Name -> share.
    replicate : ndarray of int, shape (n,), or None

    Returns
    -------
    dict
        Name -> ``value``, ``low``, ``high`` [s], None where there is none; beside them ``never``,
        ``low_censored`` and the like. As long as it does not matter when the censored rows end,
        it is a plain quantile. Else it is the time at which the curve of Kaplan and Meier, or an
        end of its pointwise interval [1]_, passes the share, and ``assumes`` says what for.

    References
    ----------
    .. [1] R. Brookmeyer, J. Crowley, "A confidence interval for the median survival time",
       Biometrics 38, 29-41 (1982).
    """
    within = None if replicate is None else replicate[element.present]
    found = {name: quantile_entry(element, p, within) for name, p in asked.items()}
    if any("censored" in entry for entry in found.values()):
        time = _times(element)
        seen = curve(element, time, replicate)
        first_end = _first(seen["survival"] < 1, time)
        for name, probability in asked.items():
            passed = {end: _first(seen[end] <= 1 - probability, time) for end in _ENDS}
            if passed["low"] == first_end:  # nothing is known of times before the first end
                passed["low"] = None
            if "censored" in found[name] and passed["survival"] is not None:
                ends = {_ENDS[end]: value for end, value in passed.items()}
                found[name] = ends | {"assumes": ASSUMES}
    return found


_ENDS = {"survival": "value", "low": "low", "high": "high"}


def ended_by(element: Element, time: float, replicate: Replicates) -> dict[str, Any]:
    """Estimate P(T < t) and P(T > t) where rows were censored before t, after Kaplan and Meier.

    Parameters
    ----------
    element : Element
        Of independent rows, some censored.
    time : float
        [s]
    replicate : ndarray of int, shape (n,), or None

    Returns
    -------
    dict
        ``above`` and ``below``, each ``value``, ``low``, ``high``, and ``assumes``; None where the
        last row was seen before `time`. Where there is no interval ``reason`` says why.
    """
    times = _times(element)
    seen = curve(element, times, replicate)

    def share(place: int) -> dict[str, float | None]:
        if place < 0:
            return {"value": 1.0, "low": None, "high": None}
        known = time <= times[-1]
        return {name: _plain(seen[end][place]) if known else None for end, name in _ENDS.items()}

    above = share(int(np.searchsorted(times, time, side="right")) - 1)
    not_below = share(int(np.searchsorted(times, time, side="left")) - 1)
    value, low, high = (not_below[name] for name in ("value", "high", "low"))
    below = {"value": _rest(value), "low": _rest(low), "high": _rest(high)}
    sides: dict[str, dict[str, Any]] = {"above": above, "below": below}
    for side, entry in sides.items():
        if entry["low"] is None and entry["high"] is None:
            sides[side] = entry | {"reason": _why_none(entry["value"], len(times))}
    return sides | {"assumes": ASSUMES}


def _why_none(value: float | None, seen: int) -> str:
    """Say why there is no interval of a share after Kaplan and Meier."""
    if not seen:
        return "there are no rows"
    if value is None:
        return "the last row was seen before then"
    return "no row ended before then" if value in (0.0, 1.0) else "nothing shows its scatter"


def quantile_entry(element: Element, probability: float, replicate: Replicates) -> dict[str, Any]:
    """Estimate a quantile, whenever the censored rows may end.

    Parameters
    ----------
    element : Element
        Of independent rows.
    probability : float
    replicate : ndarray of int, shape (present,), or None
        Of the rows that have a value.

    Returns
    -------
    dict
        ``value``, ``low``, ``high``; see `entry`. Where the rows do not reach it ``value`` is None,
        with ``reason`` and ``rows_needed``; one end may still bound it.
    """

    def estimate(values: Floats) -> tuple[float, Ends]:
        interval = order_statistics.quantile_interval(values, probability, replicate)
        return order_statistics.quantile(values, probability), interval

    value, early = estimate(element.at_least)
    latest, late = estimate(element.at_most) if element.censored.any() else (value, early)
    found = entry(
        value=(value, np.inf if value < latest else value),
        low=(early[0], early[0]),
        high=(early[1], late[1]),
    )
    return found | beyond(probability, len(element.at_least))


def beyond(probability: float, rows: int) -> dict[str, Any]:
    """Say that rows do not reach a quantile; nothing where they do, or there are none."""
    if rows == 0 or order_statistics.is_within(probability, rows):
        return {}
    needed = order_statistics.rows_to_reach(probability)
    reason = f"{rows} rows do not reach the quantile {probability:g}: it takes {needed}"
    return {"reason": reason, "rows_needed": needed}


def entry(**numbers: tuple[float, float]) -> dict[str, Any]:
    """Return numbers that depend on the censored rows, with the reason for each that is null.

    Each comes twice: with the censored rows ending where they were last seen, and never ending.
    The second is given, so that a bound from above holds whenever they end.
    """
    found: dict[str, Any] = {name: _plain(last) for name, (_, last) in numbers.items()}
    for name, (first, last) in numbers.items():
        reason = "never" if np.isposinf(first) else "censored" if np.isposinf(last) else None
        if reason:
            found[reason if name == "value" else f"{name}_{reason}"] = True
    return found


def _times(element: Element) -> Floats:
    return np.unique(element.values[np.isfinite(element.values)])


def _rest(share: float | None) -> float | None:
    return None if share is None else 1 - share


def _first(passed: np.ndarray, time: Floats) -> float | None:
    return float(time[np.argmax(passed)]) if passed.any() else None


def _plain(number: float) -> float | None:
    return float(number) if np.isfinite(number) else None
