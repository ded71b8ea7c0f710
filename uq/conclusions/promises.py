"""What can be promised of an output, and its likely range."""

from dataclasses import dataclass
from math import inf, isfinite

from uq.conclusions.words import Unit, rounded, sentence, share_text
from uq.estimate import NOTHING, Estimate
from uq.wording import listed


@dataclass(frozen=True)
class Promise:
    """A value that can be promised.

    Attributes
    ----------
    coverage, confidence : float
        At least this share of all lies on the right side of the bound, with this confidence.
    lower, upper : float
        Bounds; NaN where there is none, or it is not asked for.
    quantiles : tuple of Estimate
        Where there is no tolerance bound: quantiles of one less the coverage and of the coverage,
        those that are asked for (else without numbers).
    reason : str
        Why there is no tolerance bound, or "".
    unit : Unit
    is_life, of_magnitude : bool
        Whether it is a life that ends; whether it is the magnitude of an angle.
    ends : str
        What a life does at its end.
    joint : tuple of str
        Outputs whose bounds hold at once, this one's among them; none for a bound of its own.
    """

    coverage: float
    confidence: float
    lower: float
    upper: float
    unit: Unit
    quantiles: tuple[Estimate, Estimate] = (NOTHING, NOTHING)
    reason: str = ""
    is_life: bool = False
    of_magnitude: bool = False
    ends: str = "end"
    joint: tuple[str, ...] = ()

    @property
    def sentence(self) -> str:
        """What can be promised; "" where nothing can."""
        share = f"{100 * self.coverage:g} %"
        bounds = [
            f"{self._side(i)} {self.unit.text(bound, (-inf, inf)[i])}"
            for i, bound in enumerate((self.lower, self.upper))
            if isfinite(bound)
        ]
        if bounds:
            sure = f"With {100 * self.confidence:g} % confidence"
            if self.joint:
                return f"{sure}, at least {share} {' and '.join(bounds)}{self._others}."
            each = " each" if len(bounds) > 1 else ""
            return f"{sure}{each}, at least {share} {f', and at least {share} '.join(bounds)}."
        cautious = []
        for i, one in enumerate(self.quantiles):
            end = (one.low, one.high)[i]
            if not isfinite(one.value):
                continue
            text = f"{share} {self._side(i)} {self.unit.text(one.value)}"
            if isfinite(end):
                text += f", cautiously {self.unit.text(end, (-inf, inf)[i])}"
            cautious.append(text)
        return f"{'; '.join(cautious)}." if cautious else ""

    @property
    def why(self) -> str:
        """Why there is no tolerance bound; "" where there is one."""
        if not self.reason:
            return ""
        end = " Cautiously: the end of the 95 % interval." if self._is_cautious else ""
        bound = "joint bound" if self.joint else "tolerance bound"
        return f"No {bound}: {self.reason}.{end}"

    @property
    def _others(self) -> str:
        """With which other outputs the bounds hold at once."""
        if len(self.joint) == 1:
            return ""
        return f", within the joint bounds of {listed(self.joint)}"

    @property
    def _is_cautious(self) -> bool:
        ends = (self.quantiles[0].low, self.quantiles[1].high)
        return any(isfinite(end) for end in ends)

    def _side(self, upper: int) -> str:
        if self.of_magnitude:
            return "stay within" if upper else "exceed"
        if self.is_life:
            return f"{self.ends} within" if upper else "last longer than"
        return "stay below" if upper else "stay above"


@dataclass(frozen=True)
class Range:
    """The likely range: quantiles of 5, 50 and 95 %, and the share of lives that never end.

    ``ends`` is what a life does at its end.
    """

    low: Estimate
    median: Estimate
    high: Estimate
    unit: Unit
    of_magnitude: bool = False
    ends: str = "end"
    never: Estimate = NOTHING

    @property
    def sentence(self) -> str:
        """Range, median, and how many never end, as far as they are known."""
        parts = []
        what = "of the magnitudes " if self.of_magnitude else ""
        if isfinite(self.low.value) and isfinite(self.high.value):
            ends = self.unit.between(self.low.value, self.high.value, " and ")
            parts.append(f"90 % {what}lie between {ends}")
        elif isfinite(self.low.value) and self.high.value == inf:
            parts.append(f"5 % {self.ends} within {self.unit.text(self.low.value)}")
            if "value" in self.high.beyond:
                parts.append("more than 5 % exceed the horizon")
        if isfinite(self.median.value):
            parts.append(f"median {self.unit.text(self.median.value)}")
        parts.append(self._never)
        return sentence("; ".join(filter(None, parts))) if any(parts) else ""

    @property
    def _never(self) -> str:
        """How many never end; "" where that is not known, or it is no life."""
        if self.never.value == 0 and self.never.has_interval:
            most = rounded(100 * self.never.high, inf)
            return f"at most {most} % never {self.ends} (no row does)"
        return f"{share_text(self.never)} never {self.ends}" if self.never.value > 0 else ""
