"""Sample: what can be estimated from the rows of an element, whatever kind of rows they are."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass
from math import inf, isfinite, nan
from typing import NamedTuple

import numpy as np

from uq.assess.fact import Functions
from uq.contract import Floats, Mask, Status
from uq.result.element import Element
from uq.result.elements import flags
from uq.result.result import Result
from uq.stats import importance_weights, order_statistics
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.estimate import NOTHING, Estimate
from uq.stats.importance_weights import ImportanceWeights
from uq.stats.intervals import (
    CONFIDENCE,
    UNKNOWN,
    Ends,
    mean_interval,
    share_interval,
)
from uq.stats.moments import Moments, moments, sd_interval, standard_deviation
from uq.stats.weighted_means import moments_of_rows, weighted_moments


class SelectedRows(NamedTuple):
    """Numbers of the rows of a result, and which of them take part."""

    kept: Mask
    numbers: Floats


def with_value(element: Element) -> SelectedRows:
    """Return the values of an element, censored rows never ending."""
    return SelectedRows(element.present, np.where(element.censored, np.inf, element.values))


def value_and_censoring(element: Element) -> SelectedRows:
    """Return value and censoring of each row."""
    return SelectedRows(element.present, np.column_stack([element.values, element.censored]))


def in_categories(rows: Result, name: str) -> dict[str, SelectedRows]:
    """Return which rows are in each category, of those that did not fail without.

    The name is that of an output, or of one element of it.
    """
    codes = rows.codes(name)[name]
    kept = (codes >= 0) | (rows.dataset["status"].values == Status.OK)
    return {
        label: SelectedRows(kept, (codes == code).astype(float))
        for code, label in flags(rows.dataset[name.partition("[")[0]])
        if code >= 0
    }


@dataclass(frozen=True)
class Estimator:
    """A function of the rows that take part, and the influence of each row on it.

    Attributes
    ----------
    of : callable
        Rows -> estimate.
    relative_influence : callable
        Rows -> the influence of each, up to a factor; they sum to zero.
    sample : callable
        Element -> its rows; None where censored rows leave open which they are.
    is_share : bool
        Whether it is a share of rows, or the value beyond which such a share lies.
    counts_hits : bool
        Whether the numbers of the rows are 0 and 1.
    averages : bool
        Whether the estimate is the mean of the rows' numbers, probabilities between 0 and 1.
    is_scale : bool
        Whether two of them are also compared by their ratio.
    """

    of: Callable[[Floats], float]
    relative_influence: Callable[[Floats], Floats]
    sample: Callable[[Element], SelectedRows | None] = with_value
    is_share: bool = False
    counts_hits: bool = False
    averages: bool = False
    is_scale: bool = False

    def influence(self, x: Floats) -> Floats:
        """Return the influence of each row on the estimate, a mean or a standard deviation."""
        influence = self.relative_influence(x)
        return influence / (2 * x.std()) if self.is_scale else influence


def _centred(x: Floats) -> Floats:
    return x - x.mean()


def _sd(x: Floats) -> float:
    return float(x.std(ddof=1)) if len(x) > 1 else np.nan


MEAN = Estimator(np.mean, _centred)
SD = Estimator(_sd, lambda x: (x - x.mean()) ** 2 - x.var(), is_scale=True)


def share(sample: Callable[[Element], SelectedRows | None] = with_value) -> Estimator:
    """Return the estimator of the share of ones among the rows of a sample."""
    return Estimator(np.mean, _centred, sample, is_share=True, counts_hits=True)


def quantile(probability: float) -> Estimator:
    """Return the estimator of a quantile; a row's influence is whether it lies below."""

    def of(x: Floats) -> float:
        return order_statistics.quantile(x, probability)

    def relative_influence(x: Floats) -> Floats:
        below = x <= of(x)
        return below - below.mean()

    return Estimator(of, relative_influence, is_share=True)


class Curve(NamedTuple):
    """The share that outlives each time, and its pointwise interval; shapes (k,)."""

    survival: Floats
    low: Floats
    high: Floats


@dataclass(frozen=True)
class Sample(ABC):
    """The rows of an element that take part in its statistics.

    Rows are independent, in replicates of a design or in clusters; they count alike, or have
    weights; each is a number, or the law of a life.

    Attributes
    ----------
    element : Element
    dependence : Dependence
    confidence : float
        Of intervals.
    weights : ImportanceWeights, optional
        Of the rows with lives as computed, where they have weights.
    """

    element: Element
    dependence: Dependence = INDEPENDENT
    confidence: float = CONFIDENCE
    weights: ImportanceWeights | None = None

    @property
    def is_simple_random(self) -> bool:
        """Return whether rows are independent and unweighted, as exact bounds and tests need."""
        return self.dependence.is_none and self.element.weights is None

    @property
    def by(self) -> dict[str, Functions]:
        """The functions that compute each estimate, by its name here."""
        weighted = (weighted_moments, moments_of_rows)
        return {
            "mean": (moments, mean_interval) if self.weights is None else weighted,
            "sd": (standard_deviation, sd_interval) if self.weights is None else weighted,
        }

    # Of the lives as computed, whatever is integrated in their laws

    def moments(self) -> Moments:
        """Estimate mean, standard deviation and tail; unknown where rows never end or are censored.

        The tail rules out of weighted rows what it does without weights.
        """
        element, by = self.element, self.weights
        if not len(element.at_least) or element.never.any() or element.censored.any():
            return Moments(NOTHING, NOTHING, None, None)
        kept = element.present
        dependence = self.dependence[kept]
        plain = moments(element.at_least, dependence, self.confidence, element.ascending)
        if by is None:
            return plain
        mean, sd = (
            Estimate(estimate.value if isfinite(other.value) else nan, reason=other.reason)
            if other.reason
            else estimate
            for estimate, other in zip(
                weighted_moments(element.values[kept], by.weights[kept], dependence, by.most),
                (plain.mean, plain.sd),
                strict=True,
            )
        )
        if by.refusal:
            mean = sd = Estimate(reason=by.refusal)
        return Moments(mean, sd, plain.tail, plain.caution)

    def tolerance_bounds(self, coverage: float, confidence: float) -> dict[str, Estimate]:
        """Return one-sided tolerance bounds; failed rows count as the worst on each side.

        Returns
        -------
        dict of str to Estimate
            ``lower`` and ``upper``, of an angle also ``magnitude``; NaN with too few rows. Empty
            unless rows are a simple random sample.
        """
        if not self.is_simple_random:
            return {}
        element, failed = self.element, int(self.element.failed.sum())
        asked = failed, coverage, confidence
        early = late = order_statistics.tolerance_bounds(element.ascending, *asked, is_sorted=True)
        if element.censored.any():
            late = order_statistics.tolerance_bounds(element.at_most, *asked)
        bounds = {
            "lower": whenever_censored_rows_end((early[0], early[0])),
            "upper": whenever_censored_rows_end((early[1], late[1])),
        }
        if element.is_angle:
            largest = order_statistics.tolerance_bounds(np.abs(element.at_most), *asked)[1]
            bounds["magnitude"] = Estimate(largest)
        return bounds

    def never_ending(self) -> Estimate:
        """Estimate the probability that a life never ends.

        Only an interval is known where censored rows may not end either.
        """
        element = self.element
        never, may_be, kept = element.never, element.never | element.censored, ~element.failed
        if element.censored.any() and not element.declared.never_known_at_once:
            low, high = (share_of(mask[kept], self.dependence[kept]) for mask in (never, may_be))
            return Estimate(nan, low.low, high.high, reason="censored rows may never end")
        return self._share_never_ending(~element.failed)

    def _share_never_ending(self, kept: Mask) -> Estimate:
        return share_of(self.element.never[kept], self.dependence[kept])

    @property
    def effective_rows(self) -> float | None:
        """Kish's number of equal rows, or samples, that are worth as much; None of equal ones."""
        if self.element.weights is None:
            return None
        kept = self.element.present
        of_samples = self.dependence[kept].sums_of_samples(self.element.weights[kept])
        return importance_weights.effective_rows(of_samples)

    # By each strategy in its own way

    @abstractmethod
    def probability_below(self, threshold: float) -> Estimate:
        """Estimate P(Y < threshold), with the reason where it is unknown."""

    @abstractmethod
    def probability_above(self, threshold: float) -> Estimate:
        """Estimate P(Y > threshold), with the reason where it is unknown."""

    @abstractmethod
    def quantile(self, probability: float) -> Estimate:
        """Estimate a quantile without any assumption on censored rows."""

    @abstractmethod
    def survival(self, time: Floats) -> Curve:
        """Estimate P(T > t) at times that ascend, with pointwise intervals."""

    @property
    def most_times(self) -> float:
        """Number of times of a survival curve that shows enough of it."""
        return inf

    @property
    @abstractmethod
    def times(self) -> Floats:
        """Times of a survival curve, at which rows ended or were censored; they ascend."""

    def life_quantile(self, probability: float) -> Estimate:
        """Estimate the time by which a share has ended, where needed by Kaplan-Meier."""
        return self.quantile(probability)

    def ended_by(self, time: float) -> tuple[Estimate, Estimate] | None:
        """Estimate P(T > t) and P(T < t) under an assumption on censored rows, where one helps."""
        return None

    def rows_needed(self, probability: float) -> int | None:
        """Return the number of rows that a quantile requires; None if there are enough, or none."""
        return None

    def integration_gain(self, probability: float) -> float:
        """Return the variance reduction factor of P(T < quantile) against plain Monte Carlo.

        NaN where nothing is integrated, or it is not known.
        """
        return nan

    # For the difference between two studies

    @abstractmethod
    def share_estimator(self, threshold: float, side: str) -> Estimator:
        """Return the estimator of P(Y > threshold) or P(Y < threshold): ``above`` or ``below``."""

    @abstractmethod
    def quantile_estimator(self, probability: float) -> Estimator:
        """Return the estimator of a quantile."""


def on_side(threshold: float, side: str) -> Callable[[Element], SelectedRows | None]:
    """Return a function from elements to the probability that each row is on a side."""

    def rows(element: Element) -> SelectedRows | None:
        if element.law is None and element.unknown_sides(threshold).any():
            return None
        numbers = (element.above if side == "above" else element.below)(threshold)
        return SelectedRows(~element.failed, numbers)

    return rows


def share_of(
    hits: Mask, dependence: Dependence = INDEPENDENT, confidence: float = CONFIDENCE
) -> Estimate:
    """Estimate the share of rows that are hits."""
    share = float(hits.mean()) if len(hits) else nan
    return Estimate(share, *share_interval(hits, dependence, confidence))


def censored_before(unknown: Mask) -> str:
    """Return why a probability is unknown, from the mask of rows whose side is."""
    return f"{unknown.sum()} of {unknown.size} rows were censored before that time"


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
