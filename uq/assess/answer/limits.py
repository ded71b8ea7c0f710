"""Ranges of the leading input in which the unwanted side of an event is rare on average."""

from dataclasses import dataclass, field, replace
from math import inf, nan

from uq.assess.answer.wording import DisplayUnit, called, sentence
from uq.assess.effects import EventCurve, event_curve
from uq.assess.fact import Fact
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.stats.intervals import share_interval
from uq.text.numbers import percent_range

RARE = 0.05
"""The unwanted side of an event is rare below this probability."""

CURVE_FUNCTIONS = (event_curve, share_interval)
"""Functions that compute the probability of an event over an input."""


@dataclass(frozen=True)
class Limit:
    """A range of an input over which an event is rare on average, or the reason for none.

    Attributes
    ----------
    over : str
        The input.
    predicate : str
        The event that is rare in it, or frequent if wanted: ``fail within 60 s``.
    is_wanted : bool
        Whether the event is wanted, so that it is the frequent side.
    at : float
        Inner end of the range, the limit; NaN without one.
    end : float
        Outer end of the range, the last value in the rows; NaN without a limit.
    is_lower : bool
        Whether the input has to be larger than the limit.
    of_values : bool
        Whether the input has few values, so that nothing is averaged.
    share : Estimate
        Probability of the event in the part of the input next to the limit, or in the last part.
    unit : DisplayUnit
        Of the input.
    why : str
        Reason for a missing limit, or "".
    """

    over: str
    predicate: str
    is_wanted: bool = False
    at: float = nan
    end: float = nan
    is_lower: bool = False
    of_values: bool = False
    share: Estimate = field(default_factory=lambda: Estimate(nan))
    unit: DisplayUnit = field(default_factory=DisplayUnit)
    why: str = ""

    @property
    def fact(self) -> Fact:
        """The range with its sentence."""
        return Fact(
            {
                "sentence": self.sentence,
                "is_lower": self.is_lower,
                "at": estimate_json.number(self.at),
                "end": estimate_json.number(self.end),
            }
            | estimate_json.numbers(self.share),
            (limit_of, *CURVE_FUNCTIONS),
            mentions=(("value",),) if self.why else (("at",),),
            more={"unit": self.unit.name, "per": self.unit.per},
        )

    @property
    def sentence(self) -> str:
        """The range, or the reason for none."""
        if self.why:
            return sentence(self.why)
        condition = f"if {called(self.over)} is {self.place}"
        text = f"with 95 % confidence, {self.few} {self.predicate}{self.averaged} {condition}"
        return sentence(text)

    @property
    def place(self) -> str:
        """Return the range in which the event is rare: ``between 2.16 and 3.01``."""
        if self.of_values:
            side, inwards = ("least", inf) if self.is_lower else ("most", -inf)
            return f"at {side} {self.unit.text(self.at, inwards)}"
        low, high = sorted((self.at, self.end))
        return f"between {self.unit.between(low, high, ' and ')}"

    @property
    def averaged(self) -> str:
        """Note that the probability is averaged over the range; "" for single values."""
        return "" if self.of_values else " on average"

    @property
    def few(self) -> str:
        """Bound on the probability in the range."""
        return _few(self.is_wanted)


def _few(is_wanted: bool) -> str:
    return f"more than {100 * (1 - RARE):g} %" if is_wanted else f"fewer than {100 * RARE:g} %"


def limit_of(
    curve: EventCurve, over: str, unit: DisplayUnit, predicate: str, is_unwanted: bool
) -> Limit | None:
    """Return the range of an input over which an event is rare on average, with 95 % confidence.

    Parameters
    ----------
    curve : EventCurve
        The probability of the event in parts of the input.
    over : str
        The input.
    unit : DisplayUnit
        Of the input.
    predicate : str
        The event, in words.
    is_unwanted : bool
        Whether the event is unwanted; otherwise its opposite is.

    Returns
    -------
    Limit or None
        None if the event is rare in all parts. The range extends from the wanted end of the input
        over those parts whose mean probabilities are confidently below the limit. Parts are tested
        in this fixed order until one fails, which preserves the confidence without correction for
        multiple tests [1]_. Rows estimate means only: within a part, a single value may have any
        probability, unless each part is a value.

    References
    ----------
    .. [1] W. Maurer, L. A. Hothorn, W. Lehmacher, "Multiple comparisons in drug clinical trials and
       preclinical assays: a-priori ordered hypotheses", in J. Vollmar (ed.), Biometrie in der
       chemisch-pharmazeutischen Industrie 6, Fischer, 3-18 (1995).
    """
    shares = [share if is_unwanted else _opposite(share) for share in curve.shares]
    is_lower = shares[0].value > shares[-1].value
    edges = [float(edge) for edge in curve.edges]
    if not is_lower:  # from the unwanted to the wanted end
        shares, edges = shares[::-1], edges[::-1]
    best, names = shares[-1], called(over)
    plain = Limit(
        over,
        predicate,
        not is_unwanted,
        is_lower=is_lower,
        of_values=curve.of_values,
        share=best,
        unit=unit,
    )
    if all(share.high < RARE for share in shares):
        return None
    if any(share.high < later.low for i, share in enumerate(shares) for later in shares[i + 1 :]):
        why = f"no limit of {names}: the share that {predicate} is not monotonic in it"
        return replace(plain, why=why)
    rare = len(shares)
    while shares[rare - 1].high < RARE:
        rare -= 1
    if rare < len(shares):
        return replace(plain, at=edges[rare], end=edges[-1], share=shares[rare])
    last = replace(plain, at=edges[-2], end=edges[-1])
    if not best.has_interval:
        few = f"{plain.few} {predicate} if {names} is {last.place}"
        return replace(plain, why=f"it is not settled whether {few}")
    shown = best if is_unwanted else _opposite(best)
    many = f"{percent_range(shown.low, shown.high)} {predicate}"
    low, high = sorted(edges[-2:])
    ends = unit.between(low, high)
    extreme = "highest" if is_lower else "lowest"  # other parts may have a smaller share by chance
    why = f"in the {extreme} of {len(shares)} parts of {names} ({ends}), {many}{plain.averaged}"
    if curve.of_values:
        why = f"if {names} is {last.place}, {many}"
    if best.low <= RARE:
        why += f"; it is not settled whether {plain.few} do"
    return replace(plain, why=why)


def _opposite(share: Estimate) -> Estimate:
    return Estimate(1 - share.value, 1 - share.high, 1 - share.low)
