"""From which value of the input that decides an event the unwanted side is rare."""

from dataclasses import dataclass, field, replace
from math import inf, nan

from uq.analysis.event_curve import EventCurve
from uq.conclusions.words import Unit, called, sentence
from uq.estimate import Estimate

RARE = 0.05
"""The unwanted side of an event is rare below this probability."""


@dataclass(frozen=True)
class Limit:
    """A limit of an input, beyond which an event is rare; or why there is none.

    Attributes
    ----------
    over : str
        The input.
    said : str
        What is rare beyond it: ``end within 60 s``; or what is then frequent.
    is_wanted : bool
        Whether that is wanted, so that it is the frequent side.
    at : float
        Beyond this value it is rare; NaN where there is no limit.
    until : float
        Up to this value it is not; NaN where that is not known.
    is_lower : bool
        Whether the input has to be larger than the limit.
    share : Estimate
        How probable it is in the part of the input next to the limit, or where it is least.
    unit : Unit
        Of the input.
    why : str
        Why there is no limit, or "".
    """

    over: str
    said: str
    is_wanted: bool = False
    at: float = nan
    until: float = nan
    is_lower: bool = False
    share: Estimate = field(default_factory=lambda: Estimate(nan))
    unit: Unit = field(default_factory=Unit)
    why: str = ""

    @property
    def sentence(self) -> str:
        """The limit and what is known of its place, or why there is none."""
        if self.why:
            return sentence(self.why)
        where = f"where {called(self.over)} is {self.place}"
        text = f"surely {self.few} {where}"
        if self.until == self.until:
            low, high = sorted((self.at, self.until))
            ends = f"{self.unit.number(low, -inf)} and {self.unit.text(high, inf)}"
            text += f" (the limit lies between {ends})"
        return sentence(text)

    @property
    def place(self) -> str:
        """Where it is rare: ``at least 2.16``."""
        side, outwards = ("least", inf) if self.is_lower else ("most", -inf)
        return f"at {side} {self.unit.text(self.at, outwards)}"

    @property
    def few(self) -> str:
        """How many there are beyond the limit."""
        if self.is_wanted:
            return f"more than {100 * (1 - RARE):g} % {self.said}"
        return f"fewer than {100 * RARE:g} % {self.said}"


def limit_of(
    curve: EventCurve, over: str, unit: Unit, said: str, is_unwanted: bool
) -> Limit | None:
    """Return from which value of an input an event is rare, as far as its curve is settled.

    Parameters
    ----------
    curve : EventCurve
        The probability of the event in parts of the input.
    over : str
        The input.
    unit : Unit
        Of the input.
    said : str
        What happens, in words.
    is_unwanted : bool
        Whether that is unwanted; otherwise that it does not happen.

    Returns
    -------
    Limit or None
        None where it is rare everywhere. Where the probability falls steadily, it is smaller beyond
        a part than the mean over this part, and larger before it: so the limit lies between the
        first value before a part in which the mean is surely larger, and the last one behind a
        part from which on it is surely smaller, each with the interval of its part. Where each part
        is a value, it is that of the part itself.
    """
    shares = [one if is_unwanted else _opposite(one) for one in curve.shares]
    is_lower = shares[0].value > shares[-1].value
    edges = [float(edge) for edge in curve.edges]
    if not is_lower:  # from the unwanted to the wanted end
        shares, edges = shares[::-1], edges[::-1]
    best, names = shares[-1], called(over)
    plain = Limit(over, said, not is_unwanted, is_lower=is_lower, share=best, unit=unit)
    if all(one.high < RARE for one in shares):
        return None
    if any(one.high < later.low for i, one in enumerate(shares) for later in shares[i + 1 :]):
        why = f"no limit of {names}: how many {said} does not change steadily with it"
        return replace(plain, why=why)
    rare = len(shares)
    while shares[rare - 1].high < RARE:
        rare -= 1
    first = rare if curve.of_values else rare + 1
    if first >= len(shares):
        why = f"whether a value of {names} lets {plain.few} is not settled"
        if best.low > RARE:
            why = f"no value of {names} lets {plain.few}"
        return replace(plain, why=why)
    frequent = max((i for i, one in enumerate(shares) if one.low > RARE), default=-1)
    until = edges[frequent] if frequent > 0 else nan  # before the first part there are no rows
    if curve.of_values:  # between two values there are no rows
        until = nan
    return replace(plain, at=edges[first], until=until, share=shares[rare])


def _opposite(one: Estimate) -> Estimate:
    return Estimate(1 - one.value, 1 - one.high, 1 - one.low)
