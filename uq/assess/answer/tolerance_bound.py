"""Tolerance bound of an output, and its likely range."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from itertools import chain
from math import inf, isfinite, isnan, nan
from typing import Any

from uq.assess.answer.wording import DisplayUnit, rounded, sentence, share_text
from uq.assess.fact import Fact, Functions
from uq.result.elements import Element
from uq.stats import estimate_json
from uq.stats.estimate import NOTHING, Estimate
from uq.stats.intervals import CONFIDENCE
from uq.text.numbers import grouped, listed, percent

_ONE_END = (1 + CONFIDENCE) / 2
"""Confidence in one end of an interval."""

_LAST = ("smallest", "largest")

FAIL = "fail"
"""Verb for the end of a life, unless that is a success."""


def described_values(noun: str, undefined: float, rows_failed: bool = False) -> str:
    """Return the values that a statistic describes: `` of values``, `` of computed lives``.

    Parameters
    ----------
    noun : str
    undefined : float
        Share of the rows without a defined value.
    rows_failed : bool
        Whether there are rows without a value because they failed.
    """
    quality = "defined " if undefined > 0 else "computed " if rows_failed else ""
    return f" of {quality}{noun}"


def piles(
    element: Element, sides: tuple[bool, bool], coverage: float
) -> dict[int, tuple[float, float]]:
    """Return the sides on which too many rows share the extreme value for a tolerance bound.

    Parameters
    ----------
    element : Element
    sides : tuple of bool
        Whether a lower and an upper bound matter.
    coverage : float

    Returns
    -------
    dict of int to (float, float)
        Side, 0 or 1 -> the last value, and the share of the rows that have it.
    """
    values = element.for_thresholds[element.present]
    if element.is_lifetime or not len(values) or values.min() == values.max():
        return {}
    shares = {}
    for side, last in enumerate((values.min(), values.max())):
        count = int((values == last).sum())
        if sides[side] and count > 1 and count >= (1 - coverage) * len(values):
            shares[side] = (float(last), count / len(values))
    return shares


@dataclass(frozen=True)
class ToleranceBound:
    """A tolerance bound of an output, or conservative quantiles in its place.

    Attributes
    ----------
    coverage, confidence : float
        At least this share of all values is on the safe side of the bound, with this confidence.
    lower, upper : float
        Bounds; NaN if not available or not requested.
    quantiles : tuple of Estimate
        Quantiles of one less the coverage and of the coverage, without numbers if not requested.
    failed : tuple
        The same quantiles with failed rows at either side; None if none failed.
    reason : str
        Reason for a missing tolerance bound, or "".
    unit : DisplayUnit
    is_life, of_magnitude : bool
        Whether it bounds a life, or the magnitude of an angle.
    ends : {"fail", "succeed"}
        Verb for the end of a life.
    joint : tuple of str
        Outputs of the joint bounds, including this one; empty for a separate bound.
    rows_failed : bool
        Whether there are rows without a value because they failed.
    undefined : float
        Share of the rows without a defined value.
    recurs : bool
        Whether rows have equal values, so that many may equal a bound.
    ranks : tuple of int
        Ranks of the bounds among all rows, the smallest first; 0 without a bound.
    rows : int
        Number of all rows.
    piled : dict of int to (float, float)
        Sides without a bound, because too many rows share the extreme value: side, 0 or 1 -> this
        value, and the share of the rows that have it.
    by : tuple of callable
        The functions that compute the bounds.
    by_quantile : tuple of tuple of callable
        The functions that compute each quantile.
    """

    coverage: float
    confidence: float
    lower: float
    upper: float
    unit: DisplayUnit
    quantiles: tuple[Estimate, Estimate] = (NOTHING, NOTHING)
    failed: tuple[Estimate | None, Estimate | None] = (None, None)
    reason: str = ""
    is_life: bool = False
    of_magnitude: bool = False
    ends: str = FAIL
    joint: tuple[str, ...] = ()
    rows_failed: bool = False
    undefined: float = 0.0
    recurs: bool = False
    ranks: tuple[int, int] = (0, 0)
    rows: int = 0
    piled: Mapping[int, tuple[float, float]] = field(default_factory=dict)
    by: Functions = ()
    by_quantile: tuple[Functions, Functions] = ((), ())

    @property
    def sentence(self) -> str:
        """The bound in words, and the values at which rows pile up; "" if there is none."""
        piles = (
            f"{percent(share)} of the rows have the {_LAST[side]} value, {self.unit.text(value)}:"
            " values may be truncated there."
            for side, (value, share) in self.piled.items()
        )
        return " ".join(filter(None, (self._bound_sentence, *piles)))

    @property
    def fact(self) -> Fact:
        """The bound with its numbers."""
        low, high = self.quantiles
        numbers = {
            "coverage": self.coverage,
            "confidence": self.confidence,
            "lower": self.lower,
            "upper": self.upper,
            "lower_quantile": low.value,
            "lower_quantile_low": low.low,
            "upper_quantile": high.value,
            "upper_quantile_high": high.high,
        }
        ranks = zip(("lower_is_row", "upper_is_row"), self.ranks, strict=True)
        shares = {f"share_at_{_LAST[side]}": share for side, (_, share) in self.piled.items()}
        by_low, by_high = self.by_quantile
        return Fact(
            {"sentence": self.sentence, "reason": self.reason}
            | {name: estimate_json.number(value) for name, value in numbers.items()}
            | {name: rank for name, rank in ranks if rank}
            | shares
            | ({"joint": list(self.joint)} if self.joint else {}),
            tuple(dict.fromkeys((*self.by, *by_low, *by_high))),
            dict.fromkeys(("lower_quantile", "lower_quantile_low"), by_low)
            | dict.fromkeys(("upper_quantile", "upper_quantile_high"), by_high)
            | dict.fromkeys(shares, (piles,)),
            more={"unit": self.unit.name, "per": self.unit.per},
        )

    @property
    def probabilities(self) -> tuple[float, float]:
        """Probabilities of its quantiles."""
        return round(1 - self.coverage, 12), self.coverage

    @property
    def _bound_sentence(self) -> str:
        share = f"{100 * self.coverage:g} %"
        covered = f"{share}{self._of_values()}"
        bounds = [
            f"{self._side(i)} {self.unit.text(bound, (-inf, inf)[i])}"
            for i, bound in enumerate((self.lower, self.upper))
            if isfinite(bound)
        ]
        if bounds and self.joint:
            return f"{self._confidence}, at least {covered} {' and '.join(bounds)}{self._others}."
        if bounds:
            separately, joined = (
                " each" * (len(bounds) > 1),
                f", and at least {covered} ".join(bounds),
            )
            return f"{self._confidence}{separately}, at least {covered} {joined}."
        share += self._of_values(self.rows_failed)
        quantiles: list[str] = []
        for i, quantile in enumerate(self.quantiles):
            end = (quantile.low, quantile.high)[i]
            if not isfinite(quantile.value):
                continue
            text = f"{share} {self._side(i)} {self.unit.text(quantile.value)}"
            if isfinite(end):
                text += f" (conservative bound: {self.unit.text(end, (-inf, inf)[i])})"
            else:
                text = f"about {text}" if quantiles else f"About {text}"
            quantiles.append(text)
        return f"{'; '.join(quantiles)}." if quantiles else ""

    def of_quantile(self, probability: float) -> "ToleranceBound | None":
        """Return the bound with one of its two sides alone.

        None if there is no bound on that side, or an end of the 95 % interval of the quantile does
        not have the confidence of the bound.
        """
        if self.confidence > _ONE_END or self.joint or self.of_magnitude:
            return None
        if probability == self.coverage:
            return replace(self, lower=nan) if isfinite(self.upper) else None
        return replace(self, upper=nan) if isfinite(self.lower) else None

    def would_be(self, quantile: Estimate, before: Estimate) -> str:
        """Return a sentence on the changed end of the interval of the quantile.

        "" without an interval, or if its end is not better than now, as with too few rows.
        """
        is_upper = isfinite(self.upper)
        bound, now = ((estimate.low, estimate.high)[is_upper] for estimate in (quantile, before))
        if not (isfinite(bound) and (bound < now if is_upper else bound > now)):
            return ""
        return self.moved_end(bound, now)

    def moved_end(self, then: float, studied: float) -> str:
        """Return a sentence on an end of the interval of the bounded quantile, then and as studied.

        Another estimator gives the tolerance bound, so that the end is not called a bound.
        """
        is_upper = isfinite(self.upper)
        side, p = ("upper", self.coverage) if is_upper else ("lower", 1 - self.coverage)
        quantile = f"{100 * p:.3g} % quantile{' of magnitudes' * self.of_magnitude}"
        after, before = (self.unit.text(end, (-inf, inf)[is_upper]) for end in (then, studied))
        change = f"{after}, {'up' if then > studied else 'down'} from {before} by the same method"
        moved = f"remain {after}" if after == before else f"be {change}"
        return f"The {side} end of the 95 % interval of the {quantile} would {moved}."

    @property
    def _confidence(self) -> str:
        return f"With {100 * self.confidence:g} % confidence"

    @property
    def basis(self) -> str:
        """The kind of bound, or the reason why there is none."""
        if not (isfinite(self.lower) or isfinite(self.upper) or self.reason):
            return ""
        if not self.reason:
            several = isfinite(self.lower) and isfinite(self.upper)
            bound = f"{'joint ' * bool(self.joint)}tolerance bound{'s' * several}"
            ranks = [grouped(rank) for rank in self.ranks if rank]
            places = f"rank{'s' * several} {' and '.join(ranks)} of {grouped(self.rows)}"
            which = f" ({places})" if ranks else ""
            return f"{bound.capitalize()} from order statistics{which}, valid for any distribution."
        instead = " The conservative bound is the end of the 95 % interval of the quantile."
        bound = f"{'joint ' * bool(self.joint)}tolerance bound"
        return f"No {bound}: {self.reason}.{instead * self._has_interval}"

    @property
    def _others(self) -> str:
        """The outputs of the joint bounds; "" of a single one."""
        if len(self.joint) == 1:
            return ""
        return f", within the joint bounds of {listed(self.joint)}"

    def _of_values(self, rows_failed: bool = False) -> str:
        """Return the values that a bound describes; "" of all lives, which its verb implies.

        Failed rows count as beyond a tolerance bound, and need no mention there.
        """
        if self.is_life and not (self.undefined or rows_failed):
            return ""
        return described_values(noun_of(self), self.undefined, rows_failed)

    @property
    def _has_interval(self) -> bool:
        ends = (self.quantiles[0].low, self.quantiles[1].high)
        return any(isfinite(end) for end in ends)

    def _side(self, upper: int) -> str:
        if self.is_life and upper:
            return f"{self.ends} within"
        if self.is_life:
            return "last at least" if self.recurs else "last longer than"
        if self.recurs:
            return "are at most" if upper else "are at least"
        return "are below" if upper else "are above"


@dataclass(frozen=True)
class Range:
    """The likely range: quantiles of 5, 50 and 95 %, and the share of lives that never end.

    ``ends`` is the verb for the end of a life; see `ToleranceBound` for the other attributes.
    ``by`` has the functions that compute ``low``, ``median``, ``high`` and ``never``.
    """

    low: Estimate
    median: Estimate
    high: Estimate
    unit: DisplayUnit
    of_magnitude: bool = False
    ends: str = FAIL
    never: Estimate = NOTHING
    rows_failed: bool = False
    undefined: float = 0.0
    is_life: bool = False
    by: Mapping[str, Functions] = field(default_factory=dict)

    @property
    def fact(self) -> Fact:
        """The range with its numbers."""
        members: dict[str, Any] = {"sentence": self.sentence}
        for name in ("low", "median", "high"):
            estimate = getattr(self, name)
            members[name] = estimate_json.number(estimate.value)
            members |= estimate_json.flag(f"{name}_", estimate, "value")
        if not isnan(self.never.value):
            members["never"] = self.never.value
            for end, at in estimate_json.ends(self.never).items():
                members[f"never_{end}"] = at
        by_member = {
            member: self.by[name]
            for name in self.by
            for member in members
            if member.partition("_")[0] == name
        }
        quantiles = (self.by.get(name, ()) for name in ("low", "median", "high"))
        by = tuple(dict.fromkeys(chain.from_iterable(quantiles)))
        return Fact(members, by, by_member, more={"unit": self.unit.name, "per": self.unit.per})

    @property
    def sentence(self) -> str:
        """Range, median, and share that never ends, as far as known."""
        parts = []
        of_values = described_values(noun_of(self), self.undefined, self.rows_failed)
        if isfinite(self.low.value) and isfinite(self.high.value):
            ends = self.unit.between(self.low.value, self.high.value, " and ")
            parts.append(f"90 %{of_values} are between {ends}")
        elif isfinite(self.low.value) and self.high.value == inf:
            parts.append(f"5 %{of_values} are below {self.unit.text(self.low.value)}")
            if "value" in self.high.beyond:
                parts.append("more than 5 % exceed the horizon")
        if isfinite(self.median.value):
            parts.append(f"median {self.unit.text(self.median.value)}")
        parts.append(self._never)
        if self.undefined > 0:
            parts.append(f"{percent(self.undefined)} of the rows have no value")
        return sentence("; ".join(filter(None, parts))) if any(parts) else ""

    @property
    def _never(self) -> str:
        """Share that never ends; "" if unknown, or not of a life."""
        if self.never.value == 0 and self.never.has_interval:
            most = rounded(100 * self.never.high, inf)
            never = "survive" if self.ends == FAIL else f"never {self.ends}"
            return f"all {self.ends} (at most {most} % {never}, 95 % limit)"
        return f"{share_text(self.never)} never {self.ends}" if self.never.value > 0 else ""


def noun_of(described: ToleranceBound | Range) -> str:
    """Return the noun for the values that a bound or a range describes."""
    if described.is_life:
        return "lives" if described.ends == FAIL else "times"
    return "magnitudes" if described.of_magnitude else "values"
