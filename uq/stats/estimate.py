"""One number with its interval, or the reason why there is none."""

from dataclasses import dataclass, replace
from math import isfinite, nan


@dataclass(frozen=True, slots=True)
class Estimate:
    """A number with its 95 % interval.

    Attributes
    ----------
    value, low, high : float
        NaN where it is not known; infinite where it is known to be.
    reason : str
        Why the value or its interval is missing; "" if neither is.
    assumes : str
        What they assume beyond the rows; "" if nothing.
    beyond : tuple of str
        Which of the three are infinite only because rows are censored: they lie beyond the
        horizon.
    """

    value: float = nan
    low: float = nan
    high: float = nan
    reason: str = ""
    assumes: str = ""
    beyond: tuple[str, ...] = ()

    @property
    def numbers(self) -> tuple[float, float, float]:
        """Value and both ends."""
        return self.value, self.low, self.high

    @property
    def finite(self) -> "Estimate":
        """The same, with NaN for every number that is not finite."""
        value, low, high = (number if isfinite(number) else nan for number in self.numbers)
        return Estimate(value, low, high, self.reason, self.assumes)

    def over(self, size: float) -> "Estimate":
        """Return the same in units of this size."""
        value, low, high = (number / size for number in self.numbers)
        return replace(self, value=value, low=low, high=high)

    @property
    def has_interval(self) -> bool:
        """Whether both ends are finite."""
        return isfinite(self.low) and isfinite(self.high)


NOTHING = Estimate()
