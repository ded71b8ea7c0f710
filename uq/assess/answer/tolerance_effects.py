"""Effect of a tighter tolerance on one statistic, before and after, with its sentence."""

from dataclasses import dataclass, field
from math import isfinite

from uq.assess.answer.tolerance_bound import ToleranceBound
from uq.assess.answer.wording import DisplayUnit, called_together
from uq.assess.fact import Fact
from uq.assess.what_if import what_if
from uq.stats import estimate_json
from uq.stats.estimate import NOTHING, Estimate
from uq.text.numbers import percent, percent_interval


@dataclass(frozen=True)
class TighterTolerance:
    """Effect of halving the scatter of inputs on one statistic.

    Attributes
    ----------
    inputs : tuple of str
    statistic : str
        The number that changes: ``the 5 % quantile``.
    before, after : Estimate
    is_share : bool
    unit : DisplayUnit
    reason : str
        Reason why the rows cannot show it, or "".
    effective_rows : float
    key : str
        Key of `after` for ``uq trace``; "" if unknown.
    wants_more : bool or None
        Whether a larger number is better; None if unknown.
    law : str
        The halved scatter: ``sd 0.5 mm instead of 1``.
    tolerance_bound : ToleranceBound or None
        The current bound of the same quantile; None if an end of the interval of `after` cannot
        replace it.
    failed : Estimate or None
        The ends of that interval with failed rows at worst, where rows failed.
    """

    inputs: tuple[str, ...]
    statistic: str
    before: Estimate = NOTHING
    after: Estimate = NOTHING
    is_share: bool = False
    unit: DisplayUnit = field(default_factory=DisplayUnit)
    reason: str = ""
    effective_rows: float = float("nan")
    key: str = ""
    wants_more: bool | None = None
    law: str = ""
    tolerance_bound: ToleranceBound | None = None
    failed: Estimate | None = None

    @property
    def fact(self) -> Fact:
        """The number before and after, and how the scatter is halved."""
        return Fact(
            {
                "inputs": list(self.inputs),
                "law": self.law,
                "what": self.statistic,
                "before": estimate_json.numbers(self.before),
                "after": estimate_json.numbers(self.after),
                "promised": self.bound_sentence,
                "key": self.key,
            },
            (what_if,),
            words=self.sentence,
            mentions=(("before",), ("after",)),
            more={"is_share": self.is_share, "unit": self.unit.name, "per": self.unit.per},
        )

    @property
    def is_seen(self) -> bool:
        """Return whether the number differs in the digits shown."""
        return self.text(self.before) != self.text(self.after)

    @property
    def helps(self) -> bool:
        """Return whether the number improves, or whether no direction is known to be better."""
        return self.wants_more in (None, self.rises)

    @property
    def may_stay(self) -> bool:
        """Return whether the interval of the new number contains the old one."""
        return self.after.has_interval and self.after.low <= self.before.value <= self.after.high

    @property
    def harms(self) -> bool:
        """Return whether the number worsens with confidence."""
        is_sure = self.after.has_interval and not self.may_stay
        return not self.helps and is_sure and self.is_seen

    @property
    def rises(self) -> bool:
        """Return whether the number increases."""
        return self.after.value > self.before.value

    @property
    def gain(self) -> float:
        """Change of the number towards its better side; its size if neither side is better."""
        moved = self.after.value - self.before.value
        return abs(moved) if self.wants_more is None else moved if self.wants_more else -moved

    @property
    def half(self) -> float:
        """Half the width of the interval; 0 without one."""
        return (self.after.high - self.after.low) / 2 if self.after.has_interval else 0.0

    def text(self, estimate: Estimate) -> str:
        """Return one of the numbers with its unit."""
        return percent(estimate.value) if self.is_share else self.unit.text(estimate.value)

    @property
    def after_in_words(self) -> str:
        """The new number, named if it is a quantile."""
        prefix = "" if self.is_share else f"{self.statistic.removeprefix('the ')} "
        return f"{prefix}{self.text(self.after)}"

    @property
    def interval(self) -> str:
        """The interval of the new number; "" without one."""
        if not self.after.has_interval:
            return ""
        low, high = self.after.low, self.after.high
        return percent_interval(low, high) if self.is_share else self.unit.between(low, high)

    @property
    def sentence(self) -> str:
        """The change, or the reason why the rows cannot show it."""
        words = called_together(self.inputs)
        if self.reason:
            return f"Tightening {words}: {self.reason}."
        law = f" ({self.law})" if self.law else ""
        first = percent(self.before.value) if self.is_share else self.unit.number(self.before.value)
        changed = f"change {self.statistic} from {first} to {self._new_number}"
        return f"Halving the scatter of {words}{law} would {changed}."

    @property
    def bound_sentence(self) -> str:
        """The new bound, an end of the interval with failed rows beyond it; "" without one."""
        if self.tolerance_bound is None:
            return ""
        before = self.tolerance_bound.failed[isfinite(self.tolerance_bound.upper)] or self.before
        return self.tolerance_bound.would_be(self.failed or self.after, before)

    @property
    def besides(self) -> str:
        """The adverse change of another statistic."""
        verb = "rise" if self.rises else "fall"
        return f"But {self.statistic} would {verb} to {self._new_number}."

    @property
    def _new_number(self) -> str:
        if not self.after.has_interval:
            return self.text(self.after)
        bare = self.unit.bare_between(self.after.low, self.after.high)
        return f"{self.text(self.after)} ({self.interval if self.is_share else bare})"
