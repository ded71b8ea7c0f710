"""A piece of advice: its rule, its sentence, and the effects of the tolerance that it names."""

from dataclasses import dataclass
from typing import Any

from uq.assess.answer.sufficiency import unsettled
from uq.assess.answer.tolerance_effects import TighterTolerance
from uq.assess.answer.wording import called_together, joined
from uq.assess.fact import Fact
from uq.text.numbers import capitalized


@dataclass(frozen=True)
class Advice:
    """One piece of advice.

    Attributes
    ----------
    rule : str
        ``failed``, ``finer``, ``unknown``, ``chance``, ``source``, ``measure``, ``known``,
        ``tighten``, ``keep``, ``rows`` or ``nothing`` (`uq.assess.answer.advice`).
    sentence : str
        The advice, without alternatives of about the same effect.
    inputs : tuple of str
    rows : int or None
        Recommended total number, if more rows help.
    tightened : TighterTolerance or None
    key : str
        Of its number, for ``uq trace``; "" if it has none.
    alike : tuple of TighterTolerance
        Other tolerances of about the same effect.
    tolerances : tuple of TighterTolerance
        All that were compared: of each tolerance, every number that it would change.
    place : str
        Range of the input that is to be kept.
    there : str
        What happens to rows in that range: ``fewer than 5 % fail within 24 h on average``.
    """

    rule: str
    sentence: str
    inputs: tuple[str, ...] = ()
    rows: int | None = None
    tightened: TighterTolerance | None = None
    key: str = ""
    alike: tuple[TighterTolerance, ...] = ()
    tolerances: tuple[TighterTolerance, ...] = ()
    place: str = ""
    there: str = ""

    @property
    def fact(self) -> Fact:
        """The advice with its numbers."""
        members: dict[str, Any] = {"text": self.text, "inputs": list(self.inputs)}
        if self.rows is not None:
            members["rows"] = self.rows
        if self.tolerances:
            members["tolerances"] = [tolerance.fact for tolerance in self.tolerances]
        mentions = (("rows",),) if self.rows is not None else ()
        return Fact(members, (unsettled,), mentions=mentions)

    @property
    def also(self) -> str:
        """Sentence on other tolerances of about the same effect; "" for none."""
        named = [
            f"{called_together(tolerance.inputs)} ({tolerance.after_in_words})"
            for tolerance in self.alike
        ]
        return f"{capitalized(joined(named, 'or'))} would help about as much." if named else ""

    @property
    def effects(self) -> list[TighterTolerance]:
        """Effects of the advised tolerance on all statistics."""
        advised_inputs = None if self.tightened is None else self.tightened.inputs
        return [tolerance for tolerance in self.tolerances if tolerance.inputs == advised_inputs]

    @property
    def sure(self) -> TighterTolerance | None:
        """The first effect with a new tolerance bound."""
        return next((tolerance for tolerance in self.effects if tolerance.bound_sentence), None)

    @property
    def harmed(self) -> list[TighterTolerance]:
        """Effects of the advised tolerance for the worse."""
        return [tolerance for tolerance in self.effects if tolerance.harms]

    @property
    def text(self) -> str:
        """All sentences of the advice."""
        sure = "" if self.sure is None else self.sure.bound_sentence
        worse = [tolerance.besides for tolerance in self.harmed]
        return " ".join(filter(None, (self.sentence, sure, *worse, self.also)))
