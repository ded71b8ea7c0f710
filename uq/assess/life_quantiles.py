"""Times by which a given share of rows has ended, and shares that have ended by a given time."""

from collections.abc import Mapping

import numpy as np

from uq.assess.population import Population
from uq.assess.survival import curve
from uq.result.elements import Element, Floats
from uq.stats import order_statistics
from uq.stats.estimate import NOTHING, Estimate
from uq.stats.intervals import CONFIDENCE, UNKNOWN, Ends, Replicates, replicates_of_some

B_LIVES = {"B1": 0.01, "B10": 0.1, "B50": 0.5}
"""Share of rows that have ended by each of the lives that engineers quote."""

ASSUMES = "that censoring is non-informative"
"""What the Kaplan-Meier estimate assumes."""


def life_quantiles(
    element: Element,
    asked: Mapping[str, float],
    replicate: Replicates,
    confidence: float = CONFIDENCE,
) -> dict[str, Estimate]:
    """Estimate times by which a share of the rows has ended.

    Parameters
    ----------
    element : Element
        Of independent rows.
    asked : dict of str to float
        Name -> share.
    replicate : ndarray of int, shape (n,), or None
    confidence : float, optional

    Returns
    -------
    dict
        Name -> estimate [s]. A plain quantile as long as it does not depend on when the censored
        rows end. Otherwise the time at which the Kaplan-Meier curve, or an end of its pointwise
        interval [1]_, crosses the share; it states what it assumes. Where rows are laws of lives,
        or have weights: see `uq.assess.population.Population.quantile`.

    References
    ----------
    .. [1] R. Brookmeyer, J. Crowley, "A confidence interval for the median survival time",
       Biometrics 38, 29-41 (1982).
    """
    if not element.is_plain:
        of = Population(element, replicate, confidence)
        return {name: of.quantile(p) for name, p in asked.items()}
    within = replicates_of_some(replicate, element.present)
    found = {name: quantile_estimate(element, p, within, confidence) for name, p in asked.items()}
    open_ones = [name for name, one in found.items() if "value" in one.beyond]
    if open_ones:
        time = _times(element)
        seen = curve(element, time, replicate, confidence)
        first_end = _first(seen.survival < 1, time)
        for name in open_ones:
            value, low, high = (_first(one <= 1 - asked[name], time) for one in seen)
            if low == first_end:  # earlier times carry no information
                low = np.nan
            if np.isfinite(value):
                found[name] = Estimate(value, low, high, assumes=ASSUMES)
    return found


def ended_by(element: Element, time: float, replicate: Replicates) -> tuple[Estimate, Estimate]:
    """Estimate P(T > t) and P(T < t) by Kaplan-Meier, where rows were censored before t.

    Parameters
    ----------
    element : Element
        Of independent rows, some censored.
    time : float
        [s]
    replicate : ndarray of int, shape (n,), or None

    Returns
    -------
    above, below : Estimate
        NaN where `time` is after the last observation; with the reason where there is no interval.
    """
    times = _times(element)
    seen = curve(element, times, replicate)

    def share(place: int) -> Estimate:
        if place < 0:
            return Estimate(1.0)
        if time > times[-1]:
            return NOTHING
        value, low, high = (float(one[place]) for one in seen)
        return Estimate(value, low, high)

    above = share(int(np.searchsorted(times, time, side="right")) - 1)
    not_below = share(int(np.searchsorted(times, time, side="left")) - 1)
    below = Estimate(1 - not_below.value, 1 - not_below.high, 1 - not_below.low)
    return _explained(above, len(times)), _explained(below, len(times))


def _explained(share: Estimate, seen: int) -> Estimate:
    """Return a Kaplan-Meier share, with the reason where there is no interval."""
    reason = ""
    if np.isnan(share.low) and np.isnan(share.high):
        if not seen:
            reason = "there are no rows"
        elif np.isnan(share.value):
            reason = "it is after the last observation"
        elif share.value in (0.0, 1.0):
            reason = "no row ended before it"
        else:
            reason = "its scatter is unknown"
    return Estimate(*share.numbers, reason, ASSUMES)


def quantile_estimate(
    element: Element, probability: float, replicate: Replicates, confidence: float = CONFIDENCE
) -> Estimate:
    """Estimate a quantile that is valid whenever the censored rows end.

    Parameters
    ----------
    element : Element
        Of independent rows.
    probability : float
    replicate : ndarray of int, shape (present,), or None
        Of the rows that have a value.
    confidence : float, optional

    Returns
    -------
    Estimate
        NaN, with the reason, where there are too few rows; one end may still bound it.
    """

    def estimate(values: Floats, ascending: Floats) -> tuple[float, Ends]:
        ends = order_statistics.quantile_interval(
            values, probability, replicate, confidence, ascending
        )
        return order_statistics.quantile(ascending, probability), ends

    value, early = latest, late = estimate(element.at_least, element.ascending)
    if element.censored.any():
        ending_late = element.at_most
        latest, late = estimate(ending_late, np.sort(ending_late))
    rows, needed = len(element.at_least), rows_needed(element, probability)
    return whenever_censored_rows_end(
        (value, np.inf if value < latest else value),
        (early[0], early[0]),
        (early[1], late[1]),
        f"{rows} rows are too few for the {probability:g} quantile: it needs {needed}"
        if needed
        else "",
    )


def rows_needed(element: Element, probability: float) -> int | None:
    """Return how many rows a quantile needs; None where there are enough, or none."""
    rows = len(element.at_least)
    if rows == 0 or not element.is_plain or order_statistics.is_within(probability, rows):
        return None
    return order_statistics.rows_to_reach(probability)


def whenever_censored_rows_end(
    value: Ends, low: Ends = UNKNOWN, high: Ends = UNKNOWN, reason: str = ""
) -> Estimate:
    """Return an estimate that is valid whenever the censored rows end.

    Each number is given twice: with the censored rows ending when last observed, and never. The
    second is returned, so that an upper bound is valid in any case.
    """
    pairs = {"value": value, "low": low, "high": high}
    beyond = tuple(
        name for name, (first, last) in pairs.items() if np.isposinf(last) > np.isposinf(first)
    )
    numbers = [np.inf if np.isposinf(first) else float(last) for first, last in pairs.values()]
    return Estimate(numbers[0], numbers[1], numbers[2], reason, beyond=beyond)


def _times(element: Element) -> Floats:
    return np.unique(element.values[np.isfinite(element.values)])


def _first(passed: np.ndarray, time: Floats) -> float:
    return float(time[np.argmax(passed)]) if passed.any() else np.nan
