"""Sample of rows of equal weight: estimates from counts, order statistics, Kaplan-Meier."""

from dataclasses import dataclass
from functools import cached_property
from math import nan

import numpy as np

from uq.assess.fact import Functions
from uq.assess.sample import (
    Curve,
    Estimator,
    Sample,
    censored_before,
    on_side,
    quantile,
    share,
    share_of,
    whenever_censored_rows_end,
)
from uq.contract import Floats, Mask
from uq.stats import order_statistics
from uq.stats.estimate import NOTHING, Estimate
from uq.stats.intervals import (
    Ends,
    scattered_share_interval,
    share_interval,
    upper_probability,
)
from uq.stats.quantile_functions import normal
from uq.stats.survival_curves import BetaProducts, SurvivalCurve, kaplan_meier, outliving

ASSUMES = "that censoring is non-informative"
"""Assumption of the Kaplan-Meier estimate (independent censoring)."""

_FEW_ENDS = 5
_FEW_AT_RISK = 10


@dataclass(frozen=True)
class CountedRows(Sample):
    """The rows of an element that take part in its statistics, each counted once."""

    @property
    def by(self) -> dict[str, Functions]:
        """The functions that compute each estimate, by its name here."""
        return super().by | {
            "probability_above": (share_of, share_interval),
            "probability_below": (share_of, share_interval),
            "quantile": (order_statistics.quantile, order_statistics.quantile_interval),
            "life_quantile": (CountedRows.life_quantile, kaplan_meier),
            "never_ending": (share_interval,),
            "ended_by": (CountedRows.ended_by, kaplan_meier, CountedRows.survival),
        }

    def probability_below(self, threshold: float) -> Estimate:
        """Estimate P(Y < threshold); unknown where rows were censored below it."""
        return self._share(threshold, self.element.below(threshold))

    def probability_above(self, threshold: float) -> Estimate:
        """Estimate P(Y > threshold); unknown where rows were censored below it."""
        return self._share(threshold, self.element.above(threshold))

    def quantile(self, probability: float) -> Estimate:
        """Estimate a quantile that is valid whenever the censored rows end.

        NaN, with the reason, where there are too few rows; one end may still bound it.
        """
        element, dependence = self.element, self.dependence[self.element.present]

        def estimate(values: Floats, ascending: Floats) -> tuple[float, Ends]:
            ends = order_statistics.quantile_interval(
                values, probability, dependence, self.confidence, ascending
            )
            return order_statistics.quantile(ascending, probability, is_sorted=True), ends

        value, early = latest, late = estimate(element.at_least, element.ascending)
        if element.censored.any():
            ending_late = element.at_most
            latest, late = estimate(ending_late, np.sort(ending_late))
        rows, needed = len(element.at_least), self.rows_needed(probability)
        return whenever_censored_rows_end(
            (value, np.inf if value < latest else value),
            (early[0], early[0]),
            (early[1], late[1]),
            f"{rows} rows are too few for the {probability:g} quantile: {needed} are required"
            if needed
            else "",
        )

    def life_quantile(self, probability: float) -> Estimate:
        """Estimate the time by which a share of the rows has ended.

        Returns
        -------
        Estimate
            A plain quantile as long as it does not depend on when the censored rows end. Otherwise
            the time at which the Kaplan-Meier curve, or an end of its pointwise interval [1]_,
            crosses the share; it states what it assumes.

        References
        ----------
        .. [1] R. Brookmeyer, J. Crowley, "A confidence interval for the median survival time",
           Biometrics 38, 29-41 (1982).
        """
        plain = self.quantile(probability)
        if "value" not in plain.beyond:
            return plain
        curve = self._kaplan_meier
        first_end = _first(curve.survival < 1, self.times)
        value, low, high = (_first(share <= 1 - probability, self.times) for share in curve)
        if low == first_end:  # earlier times carry no information
            low = nan
        return Estimate(value, low, high, assumes=ASSUMES) if np.isfinite(value) else plain

    def ended_by(self, time: float) -> tuple[Estimate, Estimate] | None:
        """Estimate P(T > t) and P(T < t) by Kaplan-Meier, where rows were censored before t.

        Returns
        -------
        above, below : Estimate
            NaN where `time` is after the last observation; with the reason where there is no
            interval. None where no row was censored before.
        """
        if not self.element.unknown_sides(time).any():
            return None
        times, curve = self.times, self._kaplan_meier

        def share(place: int) -> Estimate:
            if place < 0:
                return Estimate(1.0)
            if time > times[-1]:
                return NOTHING
            value, low, high = (float(numbers[place]) for numbers in curve)
            return Estimate(value, low, high)

        above = share(int(np.searchsorted(times, time, side="right")) - 1)
        not_below = share(int(np.searchsorted(times, time, side="left")) - 1)
        below = Estimate(1 - not_below.value, 1 - not_below.high, 1 - not_below.low)
        return _explained(above, len(times)), _explained(below, len(times))

    def survival(self, time: Floats) -> Curve:
        """Estimate P(T > t) by Kaplan-Meier at times that ascend.

        Parameters
        ----------
        time : ndarray, shape (k,)
            In the unit of the life.

        Returns
        -------
        Curve
            With pointwise intervals: of independent rows those of `_pointwise`, else from the
            scatter of replicates.
        """
        element = self.element
        values, censored = element.at_least, element.censored[element.present]
        if len(values) == 0:
            return Curve(*np.full((3, len(time)), np.nan))
        known_at_once = element.declared.never_known_at_once
        estimate = outliving(values, censored, time, known_at_once=known_at_once)
        if self.dependence.is_none:
            return Curve(estimate.share, *self._pointwise(values, censored, time, estimate))
        group = self.dependence[element.present].groups()
        shares = [
            outliving(
                values[group == r], censored[group == r], time, known_at_once=known_at_once
            ).share
            for r in np.unique(group)
        ]
        seen = len(values) - np.searchsorted(np.sort(values[censored]), time, side="right")
        at_risk = np.where((estimate.share > 0) & (estimate.share < 1), seen, np.nan)
        interval = scattered_share_interval(
            estimate.share,
            np.array(shares),
            None,
            self.confidence,
            rows=at_risk,
            samples=self.dependence.samples,
        )
        return Curve(estimate.share, *interval)

    def rows_needed(self, probability: float) -> int | None:
        """Return the number of rows that a quantile requires; None if there are enough, or none."""
        rows = len(self.element.at_least)
        if rows == 0 or order_statistics.is_within(probability, rows):
            return None
        return order_statistics.rows_to_reach(probability)

    def share_estimator(self, threshold: float, side: str) -> Estimator:
        """Return the estimator of P(Y > threshold) or P(Y < threshold): ``above`` or ``below``."""
        return share(on_side(threshold, side))

    def quantile_estimator(self, probability: float) -> Estimator:
        """Return the estimator of a quantile."""
        return quantile(probability)

    def _share(self, threshold: float, hits: Floats) -> Estimate:
        unknown = self.element.unknown_sides(threshold)
        if unknown.any():
            return Estimate(reason=censored_before(unknown))
        kept = ~self.element.failed
        return share_of(hits[kept] > 0, self.dependence[kept], self.confidence)

    @cached_property
    def times(self) -> Floats:
        """The times at which rows have ended or were censored, shape (k,)."""
        return np.unique(self.element.values[np.isfinite(self.element.values)])

    @cached_property
    def _kaplan_meier(self) -> Curve:
        """The survival curve at these times."""
        return self.survival(self.times)

    def _pointwise(
        self, values: Floats, censored: Mask, time: Floats, estimate: SurvivalCurve
    ) -> Ends:
        """Return the interval that is symmetric about the logarithm of -log(share).

        Where few rows have ended, or are still at risk, it is that of `BetaProducts`, which is
        conservative: there the other misses in up to 47 % of samples.
        """
        share, deviation = estimate.share, np.sqrt(estimate.variance)
        upper = upper_probability(self.confidence)
        with np.errstate(divide="ignore", invalid="ignore"):
            middle = np.log(-np.log(share))
            half = normal(upper) * deviation / (share * -np.log(share))
            low, high = (np.exp(-np.exp(middle + side * half)) for side in (1, -1))
        inside = (share > 0) & (share < 1) & np.isfinite(deviation)
        known_at_once = self.element.declared.never_known_at_once
        law = BetaProducts(values, censored, known_at_once=known_at_once)
        ended, left = law.rows_ended_by(time), law.at_risk_after(time)
        few = (ended < _FEW_ENDS) | (left < _FEW_AT_RISK)
        low[few] = 1 - law.ended_after(time[few]).quantile(upper)
        high[few] = 1 - law.ended_by(time[few]).quantile(1 - upper)
        return np.where(inside, low, np.nan), np.where(inside, high, np.nan)


def _explained(share: Estimate, times: int) -> Estimate:
    """Return a Kaplan-Meier share, with the reason where there is no interval."""
    reason = ""
    if np.isnan(share.low) and np.isnan(share.high):
        if not times:
            reason = "there are no rows"
        elif np.isnan(share.value):
            reason = "it is after the last observation"
        elif share.value in (0.0, 1.0):
            reason = "no row ended before it"
        else:
            reason = "its scatter is unknown"
    return Estimate(*share.numbers, reason, ASSUMES)


def _first(passed: Mask, time: Floats) -> float:
    return float(time[np.argmax(passed)]) if passed.any() else nan
