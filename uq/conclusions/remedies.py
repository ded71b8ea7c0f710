"""What could be done: what a tighter tolerance would change, and each piece of advice."""

from dataclasses import dataclass, field

from uq.conclusions.words import Unit, called_together
from uq.estimate import NOTHING, Estimate
from uq.wording import percent, percent_interval


@dataclass(frozen=True)
class Tightened:
    """What half the scatter of an input would change.

    Attributes
    ----------
    inputs : tuple of str
    what : str
        The number that changes: ``the 5 % quantile``.
    before, after : Estimate
    is_share : bool
    unit : Unit
    reason : str
        Why the rows cannot show it, or "".
    effective_rows : float
    key : str
        Of `after`, for ``uq trace``; "" where it is not known.
    wants_more : bool or None
        Whether a larger number is better; None where that is not known.
    """

    inputs: tuple[str, ...]
    what: str
    before: Estimate = NOTHING
    after: Estimate = NOTHING
    is_share: bool = False
    unit: Unit = field(default_factory=Unit)
    reason: str = ""
    effective_rows: float = float("nan")
    key: str = ""
    wants_more: bool | None = None

    @property
    def is_seen(self) -> bool:
        """Whether the number differs to the digits shown."""
        text = percent if self.is_share else self.unit.text
        return text(self.before.value) != text(self.after.value)

    @property
    def helps(self) -> bool:
        """Whether the number moves to its better side, or none is known to be better."""
        return self.wants_more in (None, self.after.value > self.before.value)

    @property
    def sentence(self) -> str:
        """What would change, or why the rows cannot show it."""
        words = called_together(self.inputs)
        if self.reason:
            return f"Tightening {words}: {self.reason}."
        text = percent if self.is_share else self.unit.text
        first, then = text(self.before.value), text(self.after.value)
        ends = ""
        if self.after.has_interval:
            low, high = self.after.low, self.after.high
            both = percent_interval(low, high) if self.is_share else self.unit.between(low, high)
            ends = f" ({both})"
        return f"Half the scatter of {words} would move {self.what} from {first} to {then}{ends}."


@dataclass(frozen=True)
class Advice:
    """One thing to do.

    Attributes
    ----------
    rule : {"rows", "measure", "known", "tighten", "keep", "nothing", "failed"}
    text : str
        The sentence.
    inputs : tuple of str
    rows : int or None
        How many there should be in all, where more help.
    tightened : Tightened or None
    key : str
        Of its number, for ``uq trace``; "" if it has none.
    others : tuple of str
        What else is not settled, in sentences.
    """

    rule: str
    text: str
    inputs: tuple[str, ...] = ()
    rows: int | None = None
    tightened: Tightened | None = None
    key: str = ""
    others: tuple[str, ...] = ()
