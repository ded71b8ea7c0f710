"""Sample of lives known within intervals, or of rows that came under observation late."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import inf, isfinite, nan

import numpy as np

from uq.assess.counted_rows import ASSUMES, CountedRows
from uq.assess.fact import Functions
from uq.assess.sample import Curve
from uq.contract import Floats
from uq.stats.estimate import NOTHING, Estimate
from uq.stats.interval_censoring import LifeIntervals, LikelihoodIntervals, turnbull
from uq.stats.moments import Moments
from uq.text.numbers import counted

_MOST_TIMES = 60  # of a survival curve, each with a likelihood-ratio interval
_OPEN = 0.005  # width of the range of a probability that the data leave open, worth stating
_DEPENDENT = "intervals need independent rows of equal weight"


@dataclass(frozen=True)
class ObservedLives(CountedRows):
    """Lives known to end between two times, or given that they exceed an entry time.

    Probabilities and quantiles are nonparametric maximum likelihood estimates. Where the data leave
    them open, the value is the middle of the range; the interval contains the range.
    """

    @property
    def by(self) -> dict[str, Functions]:
        """The functions that compute each estimate, by its name here."""
        by_likelihood = (LikelihoodIntervals.ended_by, turnbull)
        return super().by | {
            "life_quantile": (ObservedLives.life_quantile, *by_likelihood),
            "ended_by": by_likelihood,
        }

    @property
    def is_simple_random(self) -> bool:
        """Return whether rows are independent and represent all lives: none entered late."""
        return super().is_simple_random and self.element.entered is None

    def moments(self) -> Moments:
        """Estimate mean, standard deviation and tail: of rows that entered late there are none."""
        if self.element.entered is not None:
            return Moments(NOTHING, NOTHING, None, None)
        return super().moments()

    @cached_property
    def lives(self) -> LifeIntervals:
        """The intervals of the rows with a life; those that never end are censored at the end."""
        element, kept = self.element, self.element.present
        low = element.values[kept].copy()
        high = np.where(element.censored, inf, element.values)[kept]
        if element.high is not None:
            high = np.where(element.censored, element.high, element.values)[kept]
        finite = np.concatenate([low[np.isfinite(low)], high[np.isfinite(high)], [0.0]])
        never = np.isposinf(low)
        low[never], high[never] = finite.max(), inf
        entered = np.zeros(len(low)) if element.entered is None else element.entered[kept]
        return LifeIntervals(low, high, entered)

    @cached_property
    def refusal(self) -> str:
        """Why the lives give no probabilities, or "": nobody is at risk at the start, or later."""
        lives = self.lives
        if not len(lives):
            return "there are no rows"
        first = float(lives.entered.min())
        if first > 0:
            return (
                f"no row was observed before {first:g} {self.element.units}, the earliest entry:"
                " lives are known only given survival to that time"
            )
        gap = _empty_risk_set(lives)
        if gap is not None:
            return (
                f"all rows observed up to {gap:g} {self.element.units} had ended there, and others"
                " entered later: nothing links the two groups"
            )
        return ""

    @cached_property
    def _likelihood(self) -> LikelihoodIntervals:
        return LikelihoodIntervals(self.lives, self.confidence)

    def quantile(self, probability: float) -> Estimate:
        """Estimate a quantile that is valid whenever lives end within their intervals.

        With late entry there is none without the likelihood: rows are no sample of all lives.
        """
        if self.element.entered is None:
            return super().quantile(probability)
        life = self.life_quantile(probability)
        return (
            life if self.refusal or isfinite(life.value) else Estimate(reason=_beyond(self.lives))
        )

    def probability_below(self, threshold: float) -> Estimate:
        """Estimate P(T < t); by the likelihood with late entry."""
        if self.element.entered is None:
            return super().probability_below(threshold)
        return self._ended(threshold)[1]

    def probability_above(self, threshold: float) -> Estimate:
        """Estimate P(T > t); by the likelihood with late entry."""
        if self.element.entered is None:
            return super().probability_above(threshold)
        return self._ended(threshold)[0]

    def ended_by(self, time: float) -> tuple[Estimate, Estimate] | None:
        """Estimate P(T > t) and P(T <= t) where rows leave their side open."""
        if self.element.entered is None and not self.element.unknown_sides(time).any():
            return None
        return self._ended(time)

    def _ended(self, time: float) -> tuple[Estimate, Estimate]:
        if self.refusal:
            return Estimate(reason=self.refusal), Estimate(reason=self.refusal)
        lives = self.lives
        if not (lives.high > time).any() or time > _last_seen(lives):
            reason = "it is after the last observation"
            return Estimate(reason=reason), Estimate(reason=reason)
        below = self._at(time)
        above = Estimate(
            1 - below.value, 1 - below.high, 1 - below.low, below.reason, below.assumes
        )
        return above, below

    def _at(self, time: float) -> Estimate:
        """Estimate P(T <= t)."""
        estimate, (least, most) = self._likelihood.ended_by(time)
        assumes = ASSUMES
        if most - least > _OPEN:
            assumes += f"; P(T <= t) may be {least:.3g} to {most:.3g} for these data"
        if not self.dependence.is_none:
            return Estimate(estimate.value, reason=_DEPENDENT, assumes=assumes)
        value, low, high = map(float, estimate.numbers)
        return Estimate(value, low, high, assumes=assumes)

    def life_quantile(self, probability: float) -> Estimate:
        """Estimate the time by which a share has ended.

        Returns
        -------
        Estimate
            Where the estimate of the distribution function crosses the share: within an interval
            without information its middle. The interval has all times at which the interval of the
            distribution function contains the share [1]_.

        References
        ----------
        .. [1] R. Brookmeyer, J. Crowley, "A confidence interval for the median survival time",
           Biometrics 38, 29-41 (1982).
        """
        if self.refusal:
            return Estimate(reason=self.refusal)
        estimate = self._likelihood.estimate
        total = np.cumsum(estimate.mass)
        place = int(np.searchsorted(total, probability - 1e-9))
        if place >= len(total) or not isfinite(estimate.high[place]):
            return Estimate(reason=_beyond(self.lives))
        value = (float(estimate.low[place]) + float(estimate.high[place])) / 2
        if not self.dependence.is_none:
            return Estimate(value, reason=_DEPENDENT, assumes=ASSUMES)
        low, high = self._quantile_ends(probability)
        return Estimate(value, low, high, assumes=ASSUMES)

    def _quantile_ends(self, probability: float) -> tuple[float, float]:
        """Return the first and last time at which the interval of P(T <= t) contains the share."""
        lives = self.lives
        times = np.unique(np.concatenate([lives.low, lives.high, lives.entered]))
        times = times[np.isfinite(times) & (times > 0)]

        def interval(time: float) -> tuple[float, float]:
            estimate = self._likelihood.ended_by(time)[0]
            return float(estimate.low), float(estimate.high)

        first = _first_true(times, lambda t: interval(t)[1] >= probability)
        last = _first_true(times, lambda t: interval(t)[0] > probability)
        # Between two ends of intervals the data say nothing: the lower end is the one before.
        low = nan if first is None else float(times[first - 1]) if first else 0.0
        if first is not None and bool((lives.is_exact & (lives.low == times[first])).any()):
            low = float(times[first])
        high = nan if last is None else float(times[last])
        return low, high

    @property
    def most_times(self) -> float:
        """Number of times of a survival curve that shows enough of it."""
        return _MOST_TIMES

    @cached_property
    def times(self) -> Floats:
        """The times at which the estimate has a step, shape (k,)."""
        lives = self.lives
        every = np.concatenate([lives.low, lives.high])
        times = np.unique(every[np.isfinite(every) & (every > 0)])
        if len(times) > _MOST_TIMES:
            times = times[np.linspace(0, len(times) - 1, _MOST_TIMES).round().astype(int)]
        return times

    def survival(self, time: Floats) -> Curve:
        """Estimate P(T > t) with pointwise intervals; NaN where nothing can be said."""
        numbers = np.full((3, len(time)), np.nan)
        if self.refusal:
            return Curve(*numbers)
        for i, at in enumerate(time.tolist()):
            above = self._ended(at)[0]
            if at >= self.lives.high.max():  # all had ended
                above = Estimate(0.0)
            numbers[:, i] = above.numbers
        return Curve(*numbers)


def _first_true(times: Floats, holds: Callable[[float], bool]) -> int | None:
    """Return the first place at which a condition holds, that holds from then on."""
    low, high = 0, len(times)
    while low < high:
        middle = (low + high) // 2
        if holds(float(times[middle])):
            high = middle
        else:
            low = middle + 1
    return low if low < len(times) else None


def _last_seen(lives: LifeIntervals) -> float:
    ends = np.where(np.isfinite(lives.high), lives.high, lives.low)
    return float(ends.max())


def _beyond(lives: LifeIntervals) -> str:
    censored = int(np.isposinf(lives.high).sum())
    return f"fewer have ended: {counted(censored, 'row has', 'rows have')} no end"


def _empty_risk_set(lives: LifeIntervals) -> float | None:
    """Return the time at which all rows so far had ended, while others entered later."""
    last = np.where(np.isfinite(lives.high), lives.high, inf)
    order = np.argsort(lives.entered, kind="stable")
    entered, seen_until = lives.entered[order], np.maximum.accumulate(last[order])
    apart = np.flatnonzero(entered[1:] >= seen_until[:-1])
    return float(seen_until[apart[0]]) if len(apart) else None
