"""Tolerance bound that can be promised of an output, and its likely range."""

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


def described_values(noun: str, undefined: float, rows_failed: bool = False) -> str:
    """Return which values a statistic describes: ``of the computed lives``; "" for all.

    Parameters
    ----------
    noun : str
    undefined : float
        Share of the rows without a defined value.
    rows_failed : bool
        Whether there are rows without a value because they failed.
    """
    if undefined > 0:
        return f"of the defined {noun}"
    return f"of the computed {noun}" if rows_failed else ""


def piles(
    element: Element, sides: tuple[bool, bool], coverage: float
) -> dict[int, tuple[float, float]]:
    """Return the sides on which more rows have the last value than a bound would leave out.

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
    """A tolerance bound that can be promised, or conservative quantiles.

    Attributes
    ----------
    coverage, confidence : float
        At least this share of all lies on the right side of the bound, with this confidence.
    lower, upper : float
        Bounds; NaN where there is none, or it is not asked for.
    quantiles : tuple of Estimate
        Where there is no tolerance bound: quantiles of one less the coverage and of the coverage,
        those that are asked for (else without numbers).
    failed : tuple
        The same quantiles with failed rows at either side; None where none failed.
    reason : str
        Reason for a missing tolerance bound, or "".
    unit : DisplayUnit
    is_life, of_magnitude : bool
        Whether it is a life that ends; whether it is the magnitude of an angle.
    ends : str
        Verb for the end of a life.
    joint : tuple of str
        Outputs whose bounds hold at once, this one's among them; none for a bound of its own.
    rows_failed : bool
        Whether there are rows without a value because they failed.
    undefined : float
        Share of the rows without a defined value.
    recurs : bool
        Whether rows have equal values, so that many may equal a bound.
    ranks : tuple of int
        Places of the bounds among all rows, the smallest first; 0 without one.
    rows : int
        Number of all rows.
    piled : dict of int to (float, float)
        Instead of a bound, where too many rows share the smallest or the largest value: its side,
        0 or 1 -> this value, and the share of the rows that have it.
    by : tuple of callable
        The functions that compute the bounds.
    by_quantile : tuple of tuple of callable
        Those that compute each quantile.
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
    ends: str = "end"
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
        """The promise, and the values at which rows pile up; "" if there is none."""
        piles = (
            f"{percent(share)} of the rows share the {_LAST[side]} value, {self.unit.text(value)},"
            " at which values may be cut off."
            for side, (value, share) in self.piled.items()
        )
        return " ".join(filter(None, (self._promised, *piles)))

    @property
    def fact(self) -> Fact:
        """The promise with its numbers."""
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
    def _promised(self) -> str:
        share = f"{100 * self.coverage:g} %"
        covered = " ".join(filter(None, (share, self._of_bounded)))
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
        share = " ".join(
            filter(None, (share, described_values(_noun(self), self.undefined, self.rows_failed)))
        )
        cautious: list[str] = []
        for i, quantile in enumerate(self.quantiles):
            end = (quantile.low, quantile.high)[i]
            if not isfinite(quantile.value):
                continue
            text = f"{share} {self._side(i)} {self.unit.text(quantile.value)}"
            if isfinite(end):
                text += f", cautiously {self.unit.text(end, (-inf, inf)[i])}"
            else:
                text = f"about {text}" if cautious else f"About {text}"
            cautious.append(text)
        return f"{'; '.join(cautious)}." if cautious else ""

    def of_quantile(self, probability: float) -> "ToleranceBound | None":
        """Return it with the bound of one quantile alone.

        None where there is none, or an end of the interval of the quantile would not bound it with
        this confidence.
        """
        if self.confidence > _ONE_END or self.joint or self.of_magnitude:
            return None
        if probability == self.coverage:
            return replace(self, lower=nan) if isfinite(self.upper) else None
        return replace(self, upper=nan) if isfinite(self.lower) else None

    def would_be(self, quantile: Estimate, before: Estimate) -> str:
        """Return a sentence on the new end of the interval of the quantile, beside the present one.

        "" without it, or where it is no better than now: the rows may be too few.
        """
        is_upper = isfinite(self.upper)
        bound, now = ((estimate.low, estimate.high)[is_upper] for estimate in (quantile, before))
        if not (isfinite(bound) and (bound < now if is_upper else bound > now)):
            return ""
        return self.moved_end(bound, now)

    def moved_end(self, then: float, studied: float) -> str:
        """Return a sentence on an end of the interval of the bounded quantile, then and as studied.

        It is called an end, not a bound with this coverage, which is of another estimator.
        """
        is_upper = isfinite(self.upper)
        side, p = ("upper", self.coverage) if is_upper else ("lower", 1 - self.coverage)
        quantile = f"{100 * p:.3g} % quantile{' of magnitudes' * self.of_magnitude}"
        ends = (self.unit.text(end, (-inf, inf)[is_upper]) for end in (then, studied))
        opening = f"The {side} end of the interval of the {quantile} would then be"
        return f"{opening} {'; as studied, '.join(ends)}."

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
            places = f"{'s' * several} {' and '.join(ranks)} of {grouped(self.rows)} in order"
            which = f": value{places}" if ranks else ""
            return f"{bound.capitalize()} from order statistics{which}, valid for any distribution."
        end = " Instead, conservatively: the end of the 95 % interval." if self._is_cautious else ""
        bound = f"{'joint ' * bool(self.joint)}tolerance bound"
        return f"No {bound}: {self.reason}.{end}"

    @property
    def _others(self) -> str:
        """With which other outputs the bounds hold at once."""
        if len(self.joint) == 1:
            return ""
        return f", within the joint bounds of {listed(self.joint)}"

    @property
    def _of_bounded(self) -> str:
        """Values that a tolerance bound describes: failed rows count as beyond it."""
        return described_values(_noun(self), self.undefined)

    @property
    def _is_cautious(self) -> bool:
        ends = (self.quantiles[0].low, self.quantiles[1].high)
        return any(isfinite(end) for end in ends)

    def _side(self, upper: int) -> str:
        if self.of_magnitude:
            return "stay within" if upper else "are at least" if self.recurs else "exceed"
        if self.is_life and upper:
            return f"{self.ends} within"
        if self.is_life:
            return "reach" if self.recurs else "last longer than"
        if self.recurs:
            return "do not exceed" if upper else "do not fall below"
        return "stay below" if upper else "stay above"


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
    ends: str = "end"
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
        of_values = described_values(_noun(self), self.undefined, self.rows_failed)
        of_values = of_values or "of the magnitudes" * self.of_magnitude
        subject = f"{of_values} " if of_values else ""
        if isfinite(self.low.value) and isfinite(self.high.value):
            ends = self.unit.between(self.low.value, self.high.value, " and ")
            parts.append(f"90 % {subject}lie between {ends}")
        elif isfinite(self.low.value) and self.high.value == inf:
            parts.append(f"5 % {subject}{self.ends} within {self.unit.text(self.low.value)}")
            if "value" in self.high.beyond:
                parts.append("more than 5 % exceed the horizon")
        if isfinite(self.median.value):
            parts.append(f"median {self.unit.text(self.median.value)}")
        parts.append(self._never)
        if self.undefined > 0:
            parts.append(f"{percent(self.undefined)} of the rows have none")
        return sentence("; ".join(filter(None, parts))) if any(parts) else ""

    @property
    def _never(self) -> str:
        """Share that never ends; "" if unknown, or not of a life."""
        if self.never.value == 0 and self.never.has_interval:
            most = rounded(100 * self.never.high, inf)
            verb = self.ends + "s"
            return f"every row {verb} (at most {most} % never {self.ends})"
        return f"{share_text(self.never)} never {self.ends}" if self.never.value > 0 else ""


def _noun(described: ToleranceBound | Range) -> str:
    """Return the noun for the values that a bound or a range describes."""
    return "magnitudes" if described.of_magnitude else "lives" if described.is_life else "values"
