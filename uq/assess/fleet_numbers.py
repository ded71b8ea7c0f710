"""Expected numbers of fleets of one size, with 5 and 95 % points over worlds."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from math import exp, expm1, inf, isnan, log, log1p, nan

import numpy as np
from scipy import special

from uq.assess import random_effects
from uq.assess.failed_rows import bounds, with_failed_at
from uq.assess.fleet_units import Units
from uq.assess.weighted_mixture import first_step
from uq.sampling.designs import several
from uq.stats.dependent_rows import Dependence
from uq.stats.estimate import Estimate
from uq.stats.quantile_functions import root

LOW, HIGH = 0.05, 0.95
"""Shares of worlds below the ends of a band."""

ALIKE = "samples share nothing that varies"
_FARTHEST = 8.2  # probit of a probability
_SETTLED = 1e-4  # of the logarithm of a time, or of a probit


@dataclass(frozen=True)
class Banded:
    """A number of a fleet.

    Attributes
    ----------
    estimate : Estimate
        The mean over unit inputs and chance, and over shared inputs.
    low, high : Estimate
        Its 5 and 95 % points over shared inputs.
    failed : Estimate or None
        The ends of the interval of `estimate` with the failed rows at best and at worst.
    """

    estimate: Estimate
    low: Estimate
    high: Estimate
    failed: Estimate | None = None


class FleetNumbers:
    """The numbers of fleets of one size, with bands, and with failed rows at best and worst.

    Parameters
    ----------
    units : Units
    size, allow : int
    dependence : Dependence
        Of the samples.
    varies : bool
        Whether shared inputs vary.
    """

    def __init__(self, units: Units, size: int, allow: int, dependence: Dependence, varies: bool):
        self._size, self._allow, self._dependence = size, allow, dependence
        self._units = units
        self._varies = varies
        self.ends: list[tuple[Estimate, Estimate]] = []
        self._cases = [units]
        if units.element.failed.any():
            lost = (with_failed_at(units.element, life) for life in (0.0, np.inf))
            self._cases += [replace(units, element=element) for element in lost]
        self._first = [case.fleet(size, 0, dependence) for case in self._cases]
        self._beyond = [case.fleet(size, allow, dependence) for case in self._cases]
        self._alone = [case.fleet(1, 0, dependence) for case in self._cases]
        self.first_of = self._first[0]
        self._spreads: dict[float, random_effects.Exceeding] = {}

    def first(self, probability: float) -> Banded:
        """Return a quantile of the time at which the first ends."""
        estimates = [self._within_horizon(times.quantile(probability)) for times in self._first]
        reached = -expm1(log1p(-probability) / self._size)
        value = estimates[0].value

        def band(share: float) -> Estimate:
            return self._time_of(share, reached, value)

        return self._banded(estimates, band, is_life=True)

    def failed(self, time: float) -> Banded:
        """Return the number that has ended before a time."""
        estimates = [_times(times.probability_below(time), self._size) for times in self._alone]

        def band(share: float) -> Estimate:
            return _times(self._unit_at(time, share), self._size)

        return self._banded(estimates, band)

    def at_most_allowed(self, time: float) -> Banded:
        """Return the probability that no more have ended before a time than allowed."""
        if self._allow >= self._size:
            return Banded(*3 * (Estimate(1.0, 1.0, 1.0),))
        estimates = [
            replace(p, value=1 - p.value, low=1 - p.high, high=1 - p.low)
            for times in self._beyond
            for p in [times.probability_below(time)]
        ]

        def band(share: float) -> Estimate:
            p = self._unit_at(time, 1 - share)
            kept = [self._probability_allowed(end) for end in p.numbers]
            return replace(p, value=kept[0], low=kept[2], high=kept[1])

        return self._banded(estimates, band)

    def _probability_allowed(self, p: float) -> float:
        return float(special.bdtr(self._allow, self._size, p)) if p == p else p

    def _banded(
        self,
        estimates: Sequence[Estimate],
        band: Callable[[float], Estimate],
        is_life: bool = False,
    ) -> Banded:
        estimate, *lost = estimates
        if self._varies and not isnan(estimate.value):
            # On a plateau the computed roots may cross.
            low, high = sorted((band(LOW), band(HIGH)), key=lambda end: end.value)
        else:
            low = high = (
                Estimate() if self._varies else replace(estimate, reason=estimate.reason or ALIKE)
            )
        self.ends.append((low, high))
        if not lost:
            return Banded(estimate, low, high)
        least, most = sorted(lost, key=lambda end: end.value)
        return Banded(estimate, low, high, bounds(estimate, least, most, is_life))

    def _within_horizon(self, estimate: Estimate) -> Estimate:
        """Return a time, or the reason why it is unknown: rows were censored before it."""
        element = self._units.element
        if not element.censored.any():
            return estimate
        horizon = element.values[element.censored].min()
        if estimate.value >= horizon:
            return Estimate(reason="rows were censored before that time")
        beyond = estimate.high >= horizon
        return replace(estimate, high=np.inf, beyond=("high",)) if beyond else estimate

    def _exceeding(self, time: float) -> random_effects.Exceeding:
        """Return the spread over worlds of P(a unit has ended before a time)."""
        if time not in self._spreads:
            self._spreads[time] = self._spread(time)
        return self._spreads[time]

    def _spread(self, time: float) -> random_effects.Exceeding:
        units, world = self._units, self._alone[0].element
        if not units.are_alike and units.worlds_repeat:
            return lambda probability: Estimate(reason=random_effects.REPEATED)
        if not units.are_alike and units.place.units == 1:
            why = f"{random_effects.ONE_UNIT}; {several('units', units.design)}"
            return lambda probability: Estimate(reason=why)
        if not units.are_alike:
            return random_effects.DeconvolvedProbability(
                units.ended(time), units.weights, self._dependence, units.of_worlds
            )
        kept = world.present
        dependence = self._dependence[kept]
        weights = None if units.of_worlds is None else units.of_worlds[kept]
        if units.end_together:
            return random_effects.certain(world.below(time)[kept], dependence, weights)
        return random_effects.noise_free(
            units.ended(time)[kept, 0], units.nodes, dependence, weights
        )

    def _unit_at(self, time: float, share: float) -> Estimate:
        """Return the quantile over worlds of the failure probability of a unit."""
        exceeding = self._exceeding(time)
        middle = exceeding(0.5)
        if isnan(middle.value):
            return middle

        def at(name: str) -> float:
            def excess(z: float) -> float:
                return float(getattr(exceeding(float(special.ndtr(z))), name)) - (1 - share)

            if isnan(least := excess(-_FARTHEST)):
                return nan
            if least <= 0:
                return 0.0
            if excess(_FARTHEST) >= 0:
                return 1.0
            return float(special.ndtr(root(excess, (-_FARTHEST, _FARTHEST), _SETTLED)))

        return _around(replace(middle, value=at("value"), low=at("low"), high=at("high")))

    def _time_of(self, share: float, probability: float, near: float) -> Estimate:
        """Return the time by which a share of worlds has a larger probability of a unit's end."""
        seen = [Estimate()]
        start = log(near) if 0 < near < inf else 0.0
        never = inf if self._units.element.never.any() else nan

        def at(name: str) -> float:
            def excess(x: float) -> float:
                seen.append(self._exceeding(exp(x))(probability))
                if isnan(value := float(getattr(seen[-1], name))):
                    raise _UnknownError
                return value - share

            try:
                side = 1.0 if excess(start) < 0 else -1.0
                bracket = first_step(start, 0.1 * side, lambda x: (excess(x) >= 0) == (side > 0))
                if bracket is None:
                    return never if side > 0 else 0.0 if name == "value" else nan
                return exp(root(excess, bracket, _SETTLED))
            except _UnknownError:
                return nan

        numbers = at("value"), at("high"), at("low")
        reason, assumes = (
            next(filter(None, (getattr(estimate, name) for estimate in seen)), "")
            for name in ("reason", "assumes")
        )
        return _around(Estimate(*numbers, reason, assumes))


class _UnknownError(ArithmeticError):
    """The distribution over worlds is unknown at this time."""


def _around(estimate: Estimate) -> Estimate:
    """Return an estimate inside its interval: on a plateau the roots found need not be in order."""
    low, high = np.minimum(estimate.low, estimate.value), np.maximum(estimate.high, estimate.value)
    return (
        estimate if isnan(estimate.value) else replace(estimate, low=float(low), high=float(high))
    )


def _times(estimate: Estimate, factor: float) -> Estimate:
    value, low, high = (factor * number for number in estimate.numbers)
    return replace(estimate, value=value, low=low, high=high)
