"""A coordinate that moves at a rate known at nodes: when it reaches its targets, with errors.

Between nodes the rate is linear in the coordinate, so that the time from one to the next is the
length over the logarithmic mean of the rates. The error of a step follows from the second divided
difference D of the rate r, over a step h that takes a time T: T |D| h^2/(6 r), the error of linear
interpolation (P. J. Davis and P. Rabinowitz, "Methods of Numerical Integration", Sec. 2.1), where D
changes little from node to node. Where it does change, as at a jump, up to three times as much is
stated.
"""

import math
from collections.abc import Callable

_CHANGE = 0.3
_FIRST, _SHORTEST = 0.25, 1 / 16  # steps, of the longest
SURE = 1.6449
"""Standard errors: half-width of a 90 % interval."""

PENDING, OPEN, REACHED, NEVER = range(4)
"""Of a target: not decided yet, never to be decided, or when."""


class Course:
    """Times at which one coordinate reaches its targets.

    Attributes
    ----------
    fates : list of int
        `PENDING`, `OPEN`, `REACHED` or `NEVER`, of each target.
    times, errors : list of float
        [s]; where open, the time until which it is not reached.
    """

    def __init__(self, targets: tuple[float, ...]) -> None:
        self.targets, self.here = targets, 0.0
        self.fates = [PENDING] * len(targets)
        self.times, self.errors = [0.0] * len(targets), [math.nan] * len(targets)
        self._variance = self._carried = self._truncated = 0.0
        self._before = 0.0, 0.0, 0.0, 0.0  # length, change of rate, time, its error
        self._bend = math.nan  # second divided difference of the rate
        self._steps = 0

    @property
    def pending(self) -> list[int]:
        """Targets not reached yet."""
        return [i for i, fate in enumerate(self.fates) if fate == PENDING]

    def step(
        self,
        end: float,
        now: float,
        span: float,
        rates: tuple[float, float],
        errors: tuple[float, float],
        when: Callable[[float], float],
    ) -> list[int]:
        """Go on to `end` in a time `span` from `now`; return the targets reached on the way.

        Parameters
        ----------
        end, now, span : float
        rates, errors : tuple of float
            Rates at the beginning and the end, and their standard errors.
        when : callable
            Time from the beginning at which a place is reached.
        """
        length, mean = abs(end - self.here), 0.5 * (rates[0] + rates[1])
        change = rates[1] - rates[0]
        local, bend = 0.0, self._bend
        if length and mean:
            local = span * abs(change) / (4 * abs(mean))
            if self._steps:
                old, old_change, old_span, old_local = self._before
                bend = (change / length - old_change / old) / (length + old)
                weight = _weight(self._bend, bend)
                local = weight * span * abs(bend) * length**2 / abs(mean)
                # What follows tells more of the step before: a jump, or no bend at the start.
                again = weight * old_span * abs(bend) * old**2 / abs(mean)
                if self._steps <= 2 or again > old_local:
                    self._truncated += again - old_local
        reached = []
        for i in self.pending:
            if not self.here < self.targets[i] <= end:
                continue
            part = when(self.targets[i] - self.here)
            first, last = self._shares(part, rates, errors)
            spread = math.sqrt(self._variance + (self._carried + first) ** 2 + last**2)
            share = part / span if span > 0 else 0.0
            self.fates[i], self.times[i] = REACHED, now + part
            self.errors[i] = self._truncated + 2 * share * local + SURE * spread
            reached.append(i)
        first, last = self._shares(span, rates, errors)
        self._variance += (self._carried + first) ** 2
        self._carried = last
        self._truncated += local
        if length:
            self._steps += 1
            self._before, self._bend = (length, change, span, local), bend
        self.here = end
        return reached

    @staticmethod
    def _shares(
        span: float, rates: tuple[float, float], errors: tuple[float, float]
    ) -> tuple[float, float]:
        first, last = (
            0.5 * span * error / abs(rate) if error and rate else 0.0
            for rate, error in zip(rates, errors, strict=True)
        )
        return first, last

    def stride(self, longest: float, rate: float) -> float:
        """Return a step over which a rate should change by less than `_CHANGE` of itself."""
        if not self._steps:
            return _FIRST * longest
        length, change = self._before[:2]
        most = _CHANGE * rate * length / abs(change) if change else longest
        return min(longest, max(most, _SHORTEST * longest))

    def blur(self, error: float) -> None:
        """Add an error to the times of the targets to come [s]."""
        self._truncated += error

    def decide(self, fate: int, time: float) -> None:
        """Set what is known of all targets that are still pending."""
        for i in self.pending:
            self.fates[i] = fate
            self.times[i] = math.inf if fate == NEVER else time


def _weight(before: float, bend: float) -> float:
    """Return the weight of a bend in the error: 1/6 if it is as before, up to 1/2 if it is not."""
    largest = max(abs(before), abs(bend))
    change = abs(bend - before) / largest if largest > 0 else 0.0
    return 1 / 6 + min(change, 1.0) / 3 if math.isfinite(change) else 0.5


def elapsed(way: float, length: float, first: float, last: float) -> float:
    """Return the time for part of a length over which a positive rate changes linearly.

    It is infinite where the rate falls to zero before.
    """
    turn = (last - first) * way / (length * first)
    if turn <= -1:
        return math.inf
    return way / first * (math.log1p(turn) / turn if turn else 1.0)


def mean_rate(first: float, last: float) -> float:
    """Return the logarithmic mean of two positive rates, else the mean."""
    if first > 0 and last > 0:
        return 1 / elapsed(1.0, 1.0, first, last)
    return 0.5 * (first + last)
