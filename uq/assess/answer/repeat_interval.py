"""Prediction interval: where the same study with another seed would most likely end."""

from dataclasses import dataclass, field
from math import isfinite, nan, sqrt

from uq.assess.answer.contributions import Ranking
from uq.assess.answer.tolerance_bound import Range, ToleranceBound
from uq.assess.answer.wording import DisplayUnit, called, joined
from uq.stats.estimate import Estimate
from uq.text.numbers import percent_interval

AGAIN = sqrt(2)
"""An estimate from other rows differs from this one so many times as much as the truth does."""

MOST_NAMED = 3


@dataclass(frozen=True)
class PredictionInterval:
    """Prediction interval of a repetition of the study with another seed.

    Attributes
    ----------
    subject : str
        ``the 5 % quantile``, or the event of a share: ``end within 24 hours``; "" for none.
    low, high : float
        Ends of the 95 % prediction interval.
    is_share : bool
    unit : DisplayUnit
    ranking : str
        The leading input of the repetition, in words; "" if unknown.
    """

    subject: str = ""
    low: float = nan
    high: float = nan
    is_share: bool = False
    unit: DisplayUnit = field(default_factory=DisplayUnit)
    ranking: str = ""

    @property
    def sentence(self) -> str:
        """The prediction in words; "" if unknown."""
        number = ""
        if self.subject and self.is_share:
            number = f"{percent_interval(self.low, self.high)} would {self.subject} (95 %)"
        elif self.subject:
            number = f"{self.subject} would {self._verb_phrase} (95 %)"
        text = "; ".join(filter(None, (number, self.ranking)))
        return f"With another seed, {text}." if text else ""

    @property
    def _verb_phrase(self) -> str:
        first, last = self.unit.text(self.low), self.unit.text(self.high)
        if first == last:  # to the digits shown
            return f"again be {first}"
        return f"lie between {self.unit.between(self.low, self.high, ' and ')}"


def found_again(estimate: Estimate, is_positive: bool) -> tuple[float, float]:
    """Return between which values an estimate from as many other rows lies with 95 %.

    Parameters
    ----------
    estimate : Estimate
        With its 95 % interval.
    is_positive : bool
        Whether it is a life, whose logarithm scatters evenly.

    Returns
    -------
    low, high : float
        NaN where the interval is not known.

    References
    ----------
    G. J. Hahn, W. Q. Meeker, "Statistical Intervals" (Wiley, 1991): the difference of two
    independent estimates has twice the variance of one.
    """
    if not (estimate.has_interval and isfinite(estimate.value)):
        return nan, nan
    value, low, high = estimate.numbers
    if is_positive and low > 0:
        return value * (low / value) ** AGAIN, value * (high / value) ** AGAIN
    return value - AGAIN * (value - low), value + AGAIN * (high - value)


def repeated_quantile(
    promise: ToleranceBound | None, likely: Range | None, ranking: Ranking | None
) -> PredictionInterval:
    """Return the prediction interval of the quantile that a promise bounds, and of the ranking.

    A low quantile is no larger than the upper end of the likely range, which matters where values
    jump, and a high one no smaller than its lower end.
    """
    order = _ranked_again(ranking)
    if promise is not None:
        for p, quantile in zip(promise.probabilities, promise.quantiles, strict=True):
            low, high = found_again(quantile, promise.is_life)
            if isfinite(low):
                if likely is not None and p < 0.5:
                    high = min(high, max(likely.high.value, quantile.high))
                elif likely is not None:
                    low = max(low, min(likely.low.value, quantile.low))
                of_magnitudes = " of the magnitudes" if promise.of_magnitude else ""
                subject = f"the {100 * p:.3g} % quantile{of_magnitudes}"
                return PredictionInterval(subject, low, high, False, promise.unit, order)
    return PredictionInterval(ranking=order)


def repeated_share(predicate: str, share: Estimate, ranking: Ranking | None) -> PredictionInterval:
    """Return the prediction interval of the probability of an event, and of the ranking."""
    low, high = found_again(share, False)
    subject = predicate if isfinite(low) else ""
    return PredictionInterval(
        subject, max(low, 0.0), min(high, 1.0), True, ranking=_ranked_again(ranking)
    )


def _ranked_again(ranking: Ranking | None) -> str:
    """Return the leading input of a repetition, in words; "" if unknown."""
    if ranking is None or ranking.denies_a_leader:
        return ""
    if ranking.leader is None:
        return "the order of the inputs could differ" if isfinite(ranking.rows_factor) else ""
    names = [called(name) for name in ranking.rivals]
    if len(names) > MOST_NAMED:
        return "the order of the inputs could differ"
    again = "again " if len(names) == 1 else ""
    return f"{joined(names, 'or')} would {again}contribute most" if names else ""
