"""Counting: how often an interval was given, and how often it held a number that is known."""

from typing import NamedTuple

import numpy as np
from scipy import stats

LOW, HIGH = 0.93, 0.97
"""Where the coverage of an interval of 95 % should lie."""

ENOUGH = 1000
"""With fewer repetitions the coverage itself is not known to a per cent: its interval counts."""

OURS = "uq"


class Line(NamedTuple):
    """The outcome of one interval over all repetitions.

    Attributes
    ----------
    problem, what, by : str
        The problem, the quantity, and whose interval it is.
    repetitions, given, held : int
    width : float
        Median of the widths of those given; NaN for bounds on one side.
    reason : str
        Why its coverage does not lie between 93 and 97 %, or "".
    bias, scatter : float
        Mean error of the estimate and its standard deviation; NaN where they were not counted.
    """

    problem: str
    what: str
    by: str
    repetitions: int
    given: int
    held: int
    width: float
    reason: str
    bias: float = np.nan
    scatter: float = np.nan

    @property
    def coverage(self):
        """Share of the intervals given that held the truth, with its own interval (exact)."""
        if not self.given:
            return np.nan, np.nan, np.nan
        interval = stats.binomtest(self.held, self.given).proportion_ci()
        return self.held / self.given, interval.low, interval.high

    @property
    def unexplained(self):
        """Whether an interval of ours is off and nothing says why."""
        if not self.given:
            return False
        value, low, high = self.coverage
        if self.repetitions >= ENOUGH:
            low = high = value
        return self.by == OURS and not (low <= HIGH and high >= LOW) and not self.reason


class Tally:
    """The intervals of one problem.

    Parameters
    ----------
    problem : str
        What it is, with the design and its rows.
    reasons : dict of str to str, optional
        Beginning of the name of a quantity -> why its coverage lies elsewhere.
    """

    def __init__(self, problem, reasons=None):
        self.problem, self.reasons = problem, reasons or {}
        self._held = {}
        self._errors = {}

    def add(self, quantity, truth, low, high, by=OURS, value=None):
        """Count one interval, an end of which may be None or NaN, and the error of a value."""
        given = all(end is not None and not np.isnan(end) for end in (low, high))
        held = (bool(low <= truth <= high), float(high) - float(low)) if given else None
        self._held.setdefault((quantity, by), []).append(held)
        if value is not None:
            self._errors.setdefault((quantity, by), []).append(value - truth)

    def entry(self, quantity, truth, entry, by=OURS):
        """Count the interval of an entry with ``low`` and ``high``; without one, none is given."""
        low, high = (None, None) if entry is None else (entry["low"], entry["high"])
        self.add(quantity, truth, low, high, by)

    def estimate(self, quantity, truth, estimate, by=OURS):
        """Count the interval of an `uq.stats.estimate.Estimate`."""
        self.add(quantity, truth, estimate.low, estimate.high, by)

    def lines(self):
        """Return the line of each quantity."""
        return [self._line(quantity, by, held) for (quantity, by), held in self._held.items()]

    def _line(self, quantity, by, held):
        given = [entry for entry in held if entry is not None]
        widths = [width for _, width in given if np.isfinite(width)]
        return Line(
            self.problem,
            quantity,
            by,
            len(held),
            len(given),
            sum(hit for hit, _ in given),
            float(np.median(widths)) if widths else np.nan,
            self._reason(quantity) if by == OURS else "",
            *self._error(quantity, by),
        )

    def _error(self, quantity, by):
        errors = self._errors.get((quantity, by))
        return (float(np.mean(errors)), float(np.std(errors))) if errors else (np.nan, np.nan)

    def _reason(self, quantity):
        fitting = [start for start in self.reasons if quantity.startswith(start)]
        return self.reasons[max(fitting, key=len)] if fitting else ""
