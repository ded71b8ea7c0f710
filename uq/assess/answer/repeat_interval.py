"""Prediction interval of an estimate for a repeat of the study with another seed."""

from math import isfinite, nan
from typing import Any

from uq.assess.answer.compared_indices import AGAIN
from uq.assess.answer.rankings import Ranking
from uq.assess.answer.tolerance_bound import Range, ToleranceBound
from uq.assess.answer.wording import called, joined
from uq.assess.fact import Fact, Functions
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.text.numbers import percent_interval

OPENING = "In a repeat with another seed, "

MOST_NAMED = 3


def found_again(estimate: Estimate, is_positive: bool) -> tuple[float, float]:
    """Return the 95 % prediction interval of an estimate from as many other rows.

    Parameters
    ----------
    estimate : Estimate
        With its 95 % interval.
    is_positive : bool
        Whether it is a life, whose interval is symmetric on the logarithm.

    Returns
    -------
    low, high : float
        NaN without an interval.

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
    tolerance_bound: ToleranceBound | None, likely: Range | None, ranking: Ranking | None
) -> Fact:
    """Return the prediction interval of the quantile that is bounded, and of the ranking.

    A low quantile is cut at the upper end of the likely range, and a high one at its lower end,
    which matters where values jump.

    Returns
    -------
    Fact
        With the ends as ``expected`` if they are known, and the leading input in its sentence.
    """
    if tolerance_bound is not None:
        quantiles = zip(
            tolerance_bound.probabilities,
            tolerance_bound.quantiles,
            tolerance_bound.by_quantile,
            strict=True,
        )
        for p, quantile, by in quantiles:
            low, high = found_again(quantile, tolerance_bound.is_life)
            if isfinite(low):
                if likely is not None and p < 0.5:
                    high = min(high, max(likely.high.value, quantile.high))
                elif likely is not None:
                    low = max(low, min(likely.low.value, quantile.low))
                of_magnitudes = " of the magnitudes" if tolerance_bound.of_magnitude else ""
                subject = f"the {100 * p:.3g} % quantile{of_magnitudes}"
                first, last = tolerance_bound.unit.text(low), tolerance_bound.unit.text(high)
                # equal to the digits shown
                both = tolerance_bound.unit.between(low, high)
                number = f"again be {first}" if first == last else f"be {both}"
                return _repeated(f"{subject} would {number}", (low, high), ranking, by)
    return _repeated("", (nan, nan), ranking)


def repeated_share(
    predicate: str, share: Estimate, ranking: Ranking | None, by: Functions = ()
) -> Fact:
    """Return the prediction interval of the probability of an event, and of the ranking.

    Parameters
    ----------
    predicate : str
        The event, in words.
    share : Estimate
    ranking : Ranking or None
    by : tuple of callable
        The functions that compute the share.

    Returns
    -------
    Fact
        As of `repeated_quantile`.
    """
    low, high = found_again(share, False)
    low, high = max(low, 0.0), min(high, 1.0)
    number = f"{percent_interval(low, high)} would {predicate}" if isfinite(low) else ""
    return _repeated(number, (low, high), ranking, by)


def _repeated(
    number: str, ends: tuple[float, float], ranking: Ranking | None, by: Functions = ()
) -> Fact:
    clauses = (f"{number} (95 %)" if number else "", _ranked_again(ranking))
    text = "; ".join(filter(None, clauses))
    members: dict[str, Any] = {"sentence": f"{OPENING}{text}." if text else ""}
    if not number:
        return Fact(members, mentions=())
    members["expected"] = dict(zip(("low", "high"), map(estimate_json.number, ends), strict=True))
    return Fact(members, (found_again, *by), mentions=(("expected",),))


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
