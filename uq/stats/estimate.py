"""A number with its interval, or why it is missing; differences and ratios of two."""

from dataclasses import dataclass, replace
from math import floor, inf, isfinite, log10, nan

import numpy as np

from uq.text.numbers import TO_THESE_DIGITS, number, percent, percent_interval


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number with its 95 % confidence interval.

    Attributes
    ----------
    value, low, high : float
        NaN if the number cannot be estimated; infinite if it is known to be infinite.
    reason : str
        Why the value or its interval is missing; "" if neither is.
    assumes : str
        Assumptions behind the numbers beyond the rows themselves; "" if there are none.
    beyond : tuple of str
        Names of the numbers that are infinite only because rows are censored: their true values
        exceed the horizon.
    """

    value: float = nan
    low: float = nan
    high: float = nan
    reason: str = ""
    assumes: str = ""
    beyond: tuple[str, ...] = ()

    @property
    def numbers(self) -> tuple[float, float, float]:
        """Value, lower end and upper end."""
        return self.value, self.low, self.high

    @property
    def finite(self) -> "Estimate":
        """The estimate with NaN in place of every number that is not finite."""
        value, low, high = (number if isfinite(number) else nan for number in self.numbers)
        return Estimate(value, low, high, self.reason, self.assumes)

    def over(self, size: float) -> "Estimate":
        """Return the estimate divided by the size of a unit."""
        value, low, high = (number / size for number in self.numbers)
        return replace(self, value=value, low=low, high=high)

    @property
    def has_interval(self) -> bool:
        """Whether both ends are finite."""
        return isfinite(self.low) and isfinite(self.high)


NOTHING = Estimate()


def value_text(
    estimate: Estimate, end: str = "value", per: float = 1.0, resolution: float = 0.0
) -> str:
    """Return one number of an estimate as text, or the reason why it is missing.

    Parameters
    ----------
    estimate : Estimate
    end : {"value", "low", "high"}
    per : float
        Divisor of the number: the length of a unit.
    resolution : float
        Resolution of the digits, as in `number`, before the division.

    Returns
    -------
    str
    """
    value = getattr(estimate, end)
    if isfinite(value):
        return number(value / per, resolution / per)
    if value != inf:
        return "-"
    return "beyond the horizon" if end in estimate.beyond else "never"


def interval_text(estimate: Estimate, per: float = 1.0, resolution: float = 0.0) -> str:
    """Return the ends of an interval as text; "" if both are unknown, or both are "never"."""
    ends = [value_text(estimate, end, per, resolution) for end in ("low", "high")]
    return "" if ends == ["-", "-"] or ends[0] == "never" else " to ".join(ends)


def failed_bounds_text(bounds: Estimate | None, per: float = 1.0) -> str:
    """Return the best-case and worst-case bounds for failed rows; "" if no row failed."""
    if bounds is None:
        return ""
    low, high = (value_text(bounds, end, per) for end in ("low", "high"))
    if low == "-":
        return "no bound" if high == "-" else f"up to {high}"
    return f"from {low} on" if high == "-" else f"{low} to {high}"


def rounded_text(estimate: Estimate, per: float = 1.0) -> tuple[str, str]:
    """Return an estimate and its interval to three digits, more if the interval is narrower.

    Parameters
    ----------
    estimate : Estimate
    per : float
        Divisor of the numbers: the length of a unit.

    Returns
    -------
    tuple of str
        Value and interval as text; the interval is "" if it is missing. The largest of the three
        numbers has three digits, and the others as many decimals.
    """
    scaled = estimate.over(per)
    largest = max((abs(number) for number in scaled.numbers if isfinite(number)), default=0.0)
    decimals = 2 - floor(log10(largest)) if largest else 0
    if scaled.has_interval and scaled.high > scaled.low:
        decimals = max(decimals, -floor(log10((scaled.high - scaled.low) / 3)))
    value, low, high = (
        _rounded(number, decimals) if isfinite(number) else value_text(scaled, name)
        for name, number in zip(("value", "low", "high"), scaled.numbers, strict=True)
    )
    return value, f"{low} to {high}" * bool(interval_text(scaled))


def _rounded(value: float, decimals: int) -> str:
    rounded = round(value, decimals) + 0.0  # no minus sign before zero
    return f"{rounded:.{decimals}f}" if value and 0 <= decimals <= 6 else number(rounded)


def share_text(estimate: Estimate) -> str:
    """Return a share in per cent with its interval, as text."""
    text = percent(estimate.value)
    if not estimate.has_interval:
        return text
    ends = percent_interval(estimate.low, estimate.high)
    return f"{text} ({'95 % interval ' * (ends != TO_THESE_DIGITS)}{ends})"


def difference(first: Estimate, second: Estimate, correlation: float) -> Estimate:
    """Return the difference, second minus first, with its confidence interval.

    Parameters
    ----------
    first, second : Estimate
    correlation : float
        Correlation of the two estimates; -1 gives a conservative interval.

    Returns
    -------
    Estimate
        Interval by the method of variance estimates recovery (MOVER) [1]_; for shares of
        independent rows it is Newcombe's method [2]_.

    References
    ----------
    .. [1] G. Y. Zou, A. Donner, "Construction of confidence limits about effect measures: a
       general approach", Stat. Med. 27, 1693-1702 (2008).
    .. [2] R. G. Newcombe, "Interval estimation for the difference between independent proportions:
       comparison of eleven methods", Stat. Med. 17, 873-890 (1998).
    """

    def reach(margin: float, other: float) -> float:
        # At least (margin - other)^2; negative values are rounding errors.
        return float(np.sqrt(max(margin**2 + other**2 - 2 * correlation * margin * other, 0.0)))

    value = second.value - first.value
    down = reach(second.value - second.low, first.high - first.value)
    up = reach(second.high - second.value, first.value - first.low)
    return Estimate(value, value - down, value + up)


def ratio(first: Estimate, second: Estimate, correlation: float) -> Estimate:
    """Return the ratio second / first of positive estimates; parameters as in `difference`."""
    if not (first.value > 0 and second.value > 0):
        return NOTHING

    def logarithm(number: float) -> float:
        return float(np.log(number)) if number > 0 else np.nan

    below, above = (
        Estimate(logarithm(estimate.value), logarithm(estimate.low), logarithm(estimate.high))
        for estimate in (first, second)
    )
    return Estimate(*np.exp(difference(below, above, correlation).numbers).tolist())
