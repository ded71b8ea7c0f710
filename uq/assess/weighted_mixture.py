"""Sample of rows with weights or laws of lives: the weighted mixture of the laws of the rows."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from functools import cache, cached_property
from itertools import repeat
from math import ceil, exp, inf, isfinite, isnan, log, nan

import numpy as np

from uq.assess.counted_rows import CountedRows
from uq.assess.fact import Functions
from uq.assess.observed_lives import ObservedLives
from uq.assess.sample import (
    Curve,
    Estimator,
    Sample,
    SelectedRows,
    censored_before,
    on_side,
    share,
)
from uq.assess.scale_laws import ConditionalScale, IndependentScale, posterior_terms
from uq.contract import Floats, Mask
from uq.result.element import Element
from uq.stats.dependent_rows import Dependence
from uq.stats.estimate import Estimate
from uq.stats.importance_weights import ImportanceWeights, effective_rows
from uq.stats.intervals import (
    CONFIDENCE,
    ROUNDING,
    is_constant,
    share_interval,
    upper_probability,
)
from uq.stats.quantile_functions import root
from uq.stats.weighted_means import (
    EXACT,
    binomial_sizes,
    fewest_rows,
    if_reliable,
    weighted_part_means,
    weighted_share,
)

_TOLERANCE = 1e-12
_FARTHEST = 60  # steps of growing length from a quantile to the end of its interval
_SHOW_VARIANCE = 30  # independent parts, at least
_LATEST = 1e300
_MOST_TIMES = 500  # of a survival curve
_RARE = 1e-4  # share of the weight that ends before the first time, and after the last
_CENSORED = "rows were censored before that time"


@dataclass(frozen=True)
class WeightedMixture(Sample):
    """Rows of an element with weights, or with the law of a life each: a weighted mixture.

    References
    ----------
    J. M. Hammersley, "Conditional Monte Carlo", J. ACM 3, 73-76 (1956): a row is the law of a life
    given all that is not integrated exactly.
    """

    @property
    def by(self) -> dict[str, Functions]:
        """The functions that compute each estimate, by its name here."""
        return super().by | {
            "probability_above": (WeightedMixture.probability_above, WeightedMixture),
            "probability_below": (WeightedMixture.probability_below, WeightedMixture),
            "quantile": (WeightedMixture.quantile, WeightedMixture),
            "never_ending": (share_interval,) if self.weights is None else BY_WEIGHTS,
        }

    def probability_below(self, threshold: float) -> Estimate:
        """Estimate P(Y < threshold); unknown where rows were censored below it."""
        unknown = self.element.unknown_sides(threshold)
        return Estimate(reason=censored_before(unknown)) if unknown.any() else self.below(threshold)

    def probability_above(self, threshold: float) -> Estimate:
        """Estimate P(Y > threshold); unknown where rows were censored below it."""
        unknown = self.element.unknown_sides(threshold)
        return Estimate(reason=censored_before(unknown)) if unknown.any() else self.above(threshold)

    def below(self, threshold: float) -> Estimate:
        """Estimate P(Y < threshold), undefined rows on neither side."""
        kept = ~self.element.failed
        numbers = self.element.below(threshold)
        estimate = self._share(numbers, kept, self._dependence(kept, threshold))
        return self._cautious(estimate, lambda plain: plain.below(threshold), kept)

    def above(self, threshold: float) -> Estimate:
        """Estimate P(Y > threshold), undefined rows on neither side."""
        kept = ~self.element.failed
        numbers = self.element.above(threshold)
        estimate = self._share(numbers, kept, self._dependence(kept, threshold, -1))
        return self._cautious(estimate, lambda plain: plain.above(threshold), kept)

    def outliving(self, time: float, above: Floats | None = None) -> Estimate:
        """Estimate P(T > time) among the rows that have a life; unknown once rows were censored.

        Parameters
        ----------
        time : float
        above : ndarray, shape (n,), optional
            The probability of each row, if already computed.
        """
        if self.element.unknown_sides(time).any():
            return Estimate(reason=_CENSORED)
        kept = self.element.present
        above = self.element.above(time) if above is None else above
        return self._share(above, kept, self._dependence(kept, time, -1))

    def quantile(self, probability: float) -> Estimate:
        """Estimate a quantile.

        Its interval holds all values at which the interval of P(Y < y) holds the probability.
        """
        if probability not in self._quantiles:
            self._quantiles[probability] = self._quantile(probability)
        return self._quantiles[probability]

    def _quantile(self, probability: float) -> Estimate:
        if not self.element.present.any():
            return Estimate()
        search = self._along_time if self.element.law is not None else self._along_values
        estimate = search(probability)
        if not isfinite(estimate.value):
            return estimate
        return self._trusted(estimate, self.element.present)

    @cached_property
    def _quantiles(self) -> dict[float, Estimate]:
        """Quantiles so far: those of the answer are among those of the tables."""
        return {}

    @cached_property
    def _averages(self) -> dict[float, float]:
        """Estimates of P(Y < y) so far: all quantiles are sought from the same places."""
        return {}

    def survival(self, time: Floats) -> Curve:
        """Estimate P(T > t) at times that ascend, with pointwise intervals."""
        law = self.element.law
        of_rows: Iterable[Floats | None] = repeat(None)
        if isinstance(law, IndependentScale):
            of_rows = law.above_each(self.element.values, time)
        estimates = map(self.outliving, time, of_rows)
        return Curve(*np.array([estimate.numbers for estimate in estimates]).reshape(-1, 3).T)

    @property
    def most_times(self) -> float:
        """Number of times of a survival curve that shows enough of it."""
        return _MOST_TIMES if self.element.weights is None else inf

    @property
    def times(self) -> Floats:
        """Times at which rows ended, or between which equal shares of the weight have ended."""
        ended, weights = np.isfinite(self.element.values), self.element.weights
        if weights is None:
            return np.unique(self.element.values[ended])
        order = np.argsort(self.element.values[ended], kind="stable")
        time, share = self.element.values[ended][order], np.cumsum(weights[ended][order])
        if not len(time):
            return time
        wanted = np.linspace(_RARE, 1 - _RARE, min(_MOST_TIMES, len(time))) * share[-1]
        return np.asarray(time[np.searchsorted(share, wanted)])

    def integration_gain(self, probability: float) -> float:
        """Return the variance reduction factor of P(Y < quantile) against plain Monte Carlo.

        NaN where it is exact, where too few independent parts show it, or rows have weights.
        """
        kept = ~self.element.failed
        if self.element.weights is not None or not kept.any():
            return nan
        threshold = self.middle(probability)
        dependence = self.dependence[kept]
        integrated, plain = (
            weighted_part_means(rows.below(threshold)[kept], None, dependence)
            for rows in (self.element, self.element.plain)
        )
        if len(integrated) < _SHOW_VARIANCE or is_constant(integrated):
            return nan
        return float(plain.var() / integrated.var())

    def share_estimator(self, threshold: float, side: str) -> Estimator:
        """Return the estimator of P(Y > threshold) or P(Y < threshold): ``above`` or ``below``."""
        return replace(share(on_side(threshold, side)), counts_hits=False, averages=True)

    def quantile_estimator(self, probability: float) -> Estimator:
        """Return the estimator of a quantile, located anew in each study compared."""

        def rows(other: Element) -> SelectedRows:
            at = WeightedMixture(other).middle(probability)
            return SelectedRows(other.present, other.below(at))

        return replace(share(rows), counts_hits=False)

    def _share_never_ending(self, kept: Mask) -> Estimate:
        if self.element.weights is None:
            return super()._share_never_ending(kept)
        return self._share(self.element.never.astype(float), kept, self.dependence[kept])

    def _share(self, numbers: Floats, kept: Mask, dependence: Dependence) -> Estimate:
        """Estimate a probability, or give the reason why the weights do not support it."""
        estimate = weighted_share(
            _selected(numbers, kept), self._weights(kept), dependence, None, self.confidence
        )
        return self._trusted(estimate, kept)

    def _cautious(
        self, estimate: Estimate, hits_of: Callable[[Element], Floats], kept: Mask
    ) -> Estimate:
        """Return a probability with an interval as wide as few hits of the rows make it.

        Where an input is integrated given another one that it depends on, rows that carry a rare
        event may all be absent, and the others seem to agree. Then the end away from 0, or 1, is no
        nearer than that of the plain rows: for up to 10 effective hits, fading out at 20.
        """
        if not isinstance(self.element.law, ConditionalScale) or not estimate.has_interval:
            return estimate
        hits = hits_of(self.element.plain)
        plain = self._share(hits, kept, self.dependence[kept])
        weights, is_rare = self._weights(kept), estimate.value < 0.5
        carried = (hits if is_rare else 1 - hits)[kept] * (1.0 if weights is None else weights)
        extent = float(np.clip(2 - effective_rows(carried) / 10, 0.0, 1.0))
        if not (extent > 0 and plain.has_interval):
            return estimate
        if is_rare:
            high = estimate.high + extent * max(plain.high - estimate.high, 0.0)
            return replace(estimate, high=high)
        return replace(estimate, low=estimate.low - extent * max(estimate.low - plain.low, 0.0))

    def _weights(self, kept: Mask) -> Floats | None:
        """Return the weights of some rows."""
        weights = self.element.weights
        return None if weights is None else _selected(weights, kept)

    def _dependence(self, kept: Mask, time: float, side: int = 1) -> Dependence:
        """Return the dependence of some rows, for the variance of P(T < time).

        Where rows are means over a law estimated from all of them, the influence of this law is
        the covariance of its terms and T < time within each row.
        """
        dependence, weights = self.dependence[kept], self._weights(kept)
        if dependence.shared is None or weights is None:
            return dependence
        terms = posterior_terms(self.element.law, self.element.values, time)
        if terms is None:
            return dependence
        of_row, times_below = (of_rows[kept] for of_rows in terms)
        worth = weights / weights.sum()
        covariance = worth @ times_below - (worth @ self.element.below(time, signed=True)[kept]) * (
            worth @ of_row
        )
        shared = dependence.shared.with_covariance(side * covariance)
        return replace(dependence, shared=shared)

    def _trusted(self, estimate: Estimate, kept: Mask) -> Estimate:
        """Return an estimate, or why the weights of the rows behind it do not allow one.

        Numbers up to 1 have no tail of their own: where few rows carry them, their interval says
        so.
        """
        weights = self.element.weights
        if weights is None or not kept.any():
            return estimate
        return if_reliable(estimate, weights[kept], self.dependence[kept], self.element.most)

    def _near(self, value: float) -> tuple[Callable[[float], Estimate], float]:
        """Return a function that estimates P(Y < y) among the rows that have a value.

        It is for all y as cautious as it must be at a quantile: else ends would only be given
        where rows happen to agree. With it the fewest rows of which it has the interval of hits.
        """
        kept = self.element.present
        weights, dependence = self._weights(kept), self._dependence(kept, value)
        hits = binomial_sizes(self.element.below(value, signed=True)[kept], weights, dependence)

        @cache  # both ends of an interval are sought from the same places
        def share(y: float) -> Estimate:
            numbers = _selected(self.element.below(y, signed=True), kept)
            estimate = weighted_share(numbers, weights, dependence, hits, self.confidence)
            return self._cautious(estimate, lambda plain: plain.below(y, signed=True), kept)

        return share, fewest_rows(hits)

    def _why_open(self, probability: float, low: float, high: float, rows: float) -> str:
        """Return why a quantile lacks an end of its interval, or ""."""
        missing = [name for name, end in (("lower", low), ("upper", high)) if isnan(end)]
        if not missing:
            return ""
        without_hits = min(1 - probability if name == "lower" else probability for name in missing)
        needed = ceil(log(1 - upper_probability(self.confidence)) / log(without_hits))
        ends = f"no {' or '.join(missing)} end"
        if not rows < needed:
            return f"{ends}: too few rows carry it"
        return f"{ends}: {rows:.3g} effective rows, and {needed} are required"

    def _average(self, value: float) -> float:
        if value not in self._averages:
            kept = self.element.present
            below = _selected(self.element.below(value, signed=True), kept)
            self._averages[value] = float(np.average(below, weights=self._weights(kept)))
        return self._averages[value]

    def middle(self, probability: float) -> float:
        """Return the estimate of a quantile without its interval."""
        if not self.element.present.any():
            return nan
        if self.element.law is not None:
            return self._middle(probability)
        return self._along_values(probability).value

    def _middle(self, probability: float) -> float:
        @cache
        def reached(at: float) -> float:
            return self._average(exp(at)) - probability

        if (place := self._typical) is None:
            return np.inf
        start, unit = place
        side = 1.0 if reached(start) < 0 else -1.0
        there = first_step(start, side * unit, lambda at: (reached(at) >= 0) == (side > 0))
        if there is None:
            return np.inf if side > 0 else 0.0
        return exp(root(reached, there, _TOLERANCE))

    @property
    def _never(self) -> float:
        """The time that is not reached: infinite where some lives never end, else unknown."""
        return np.inf if self.element.never.any() else nan

    @cached_property
    def _typical(self) -> tuple[float, float] | None:
        """Return the logarithm of a typical life, and the scatter of logarithms."""
        lives = self.element.values[self.element.present]
        lives = lives[(lives > 0) & (lives < np.inf)]
        if not len(lives):
            return None
        return log(np.median(lives)), max(float(np.log(lives).std()), 0.01)

    def _along_time(self, probability: float) -> Estimate:
        """Return a quantile of lives with laws, by root finding in the logarithm of time."""
        value = self._middle(probability)
        if isnan(value) or (place := self._typical) is None:
            return Estimate(value)
        inside = min(max(value, 1 / _LATEST), _LATEST)
        share, rows = self._near(inside)
        middle = share(inside)
        if isnan(middle.low):
            return Estimate(value, reason=middle.reason)

        def end(start: float, unit: float, name: str) -> float:
            def excess(x: float) -> float:
                estimate = share(exp(x))
                exact = estimate.reason == EXACT  # its interval is a point
                return float(estimate.value if exact else getattr(estimate, name)) - probability

            below = excess(start) < 0
            step = unit if below else -unit
            there = first_step(start, step, lambda x: (excess(x) >= 0) == below)
            if there is None:
                return self._never if below else nan
            return exp(root(excess, there, _TOLERANCE))

        start, unit = place
        if 0 < value < np.inf:
            start, unit = log(value), unit / 30
        low = 0.0 if value == 0 else min(end(start, unit, "high"), value)
        high = value if value == np.inf else max(end(start, unit, "low"), value)
        return Estimate(value, low, high, self._why_open(probability, low, high, rows))

    def _along_values(self, probability: float) -> Estimate:
        """Return a quantile of known values, which is one of them."""
        weights, values = self._weights(self.element.present), self.element.at_most
        values = np.unique(values if weights is None else values[weights > 0])
        values = values[np.isfinite(values)]
        if not len(values):
            return Estimate(self._never)
        after = np.append(values[1:], np.inf)  # P(Y <= value) is P(Y < y) up to the next value

        def least(share: Callable[[float], Estimate], name: str) -> float:
            def reached(place: int) -> bool:
                return getattr(share(float(after[place])), name) >= probability - ROUNDING

            place = _least(len(values), reached)
            return self._never if place is None else float(values[place])

        value = least(lambda y: Estimate(self._average(y)), "value")
        cut = self.element.values[self.element.censored]
        if len(cut) and value >= cut.min():
            return Estimate(reason=_CENSORED)
        beside = float(after[np.searchsorted(values, value)]) if isfinite(value) else np.inf
        share, rows = self._near(beside)
        low, high = least(share, "high"), least(share, "low")
        if share(float(values[0])).high >= probability:  # all rows may lie above the quantile
            low = nan
        return Estimate(value, low, high, self._why_open(probability, low, high, rows))


def _selected(numbers: Floats, kept: Mask) -> Floats:
    """Return the numbers of some rows, without a copy where these are all."""
    return numbers if kept.all() else numbers[kept]


BY_WEIGHTS: Functions = (WeightedMixture,)
"""The functions that compute the estimates of a mixture from weights and laws of its rows."""


def as_sample(
    element: Element,
    dependence: Dependence,
    confidence: float = CONFIDENCE,
    weights: ImportanceWeights | None = None,
) -> Sample:
    """Return the rows of an element as a sample, by the strategy that suits them.

    `CountedRows` where all rows are of equal weight and have the lives that were computed;
    `ObservedLives` where lives are known within intervals or rows entered late;
    `WeightedMixture` where rows have weights, or an input of a life is integrated exactly.

    Parameters
    ----------
    element : Element
    dependence : Dependence
    confidence : float, optional
        Of intervals.
    weights : ImportanceWeights, optional
        Of the rows with lives as computed.
    """
    strategy: type[Sample] = CountedRows if element.is_plain else WeightedMixture
    if strategy is CountedRows and element.is_lifetime and element.has_intervals_or_entries:
        strategy = ObservedLives
    return strategy(element, dependence, confidence, weights)


def first_step(
    start: float, step: float, reached: Callable[[float], bool]
) -> tuple[float, float] | None:
    """Return the ends of the first growing step in which something is reached."""
    before = start
    for _ in range(_FARTHEST):
        at = before + step
        if not -700 < at < 700:
            return None
        if reached(at):
            return before, at
        before, step = at, 1.3 * step
    return None


def _least(count: int, reached: Callable[[int], bool]) -> int | None:
    """Return the least place at which something is reached, from then on."""
    low, high = 0, count
    while low < high:
        middle = (low + high) // 2
        if reached(middle):
            high = middle
        else:
            low = middle + 1
    return low if low < count else None
