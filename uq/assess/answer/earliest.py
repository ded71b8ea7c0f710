"""The rows that end first, their distinguishing inputs and regimes, in sentences."""

import shlex
from dataclasses import dataclass, replace

import numpy as np

from uq.assess.answer.wording import (
    DisplayUnit,
    called,
    joined,
    sentence,
    share_text,
    unit_of_input,
)
from uq.assess.distinguishing_inputs import (
    FEWEST,
    RankShift,
    RegimeOfFirst,
    earliest_rows,
    inputs_apart,
    regimes_of_first,
)
from uq.assess.fact import Fact
from uq.assess.findings import Findings
from uq.errors import InputError
from uq.result.elements import Element
from uq.result.row_choice import lowest_rows
from uq.stats import estimate_json
from uq.stats.dependent_rows import Dependence
from uq.stats.intervals import share_interval
from uq.text.numbers import grouped, percent

_MOST_ROWS = 3
_MOST_INPUTS = 3


@dataclass(frozen=True)
class Earliest:
    """The rows that fail first, and their distinguishing inputs and regimes.

    Attributes
    ----------
    element : str
    rows : tuple of int
        The numbers of the first, of all rows of the result.
    lives : tuple of float
        Their lives.
    size, total : int
        Numbers of the earliest rows, and of all that have a life.
    inputs : tuple of RankShift, or None
        Inputs whose values differ, the most different first; None if undetermined.
    units : tuple of DisplayUnit
        Their units.
    regimes : tuple of RegimeOfFirst
        Regimes more frequent among the earliest than among all, else their most frequent.
    unit : DisplayUnit
        Of the lives.
    command : str
        Command that shows the first of them.
    """

    element: str
    rows: tuple[int, ...]
    lives: tuple[float, ...]
    unit: DisplayUnit
    command: str
    size: int = 0
    total: int = 0
    inputs: tuple[RankShift, ...] | None = None
    units: tuple[DisplayUnit, ...] = ()
    regimes: tuple[RegimeOfFirst, ...] = ()

    @property
    def fact(self) -> Fact:
        """Rows, inputs and regimes with their sentence."""
        lives = {str(row): life for row, life in zip(self.rows, self.lives, strict=True)}
        inputs = {
            difference.name: {
                "direction": difference.direction,
                "outwards": difference.outwards,
                "median": difference.median,
                "median_of_others": difference.others,
                "rank": difference.rank.value,
                "rank_low": estimate_json.number(difference.rank.low),
                "rank_high": estimate_json.number(difference.rank.high),
            }
            for difference in self.inputs or ()
        }
        regimes = {
            regime.label: estimate_json.numbers(regime.share)
            | {"overall": regime.overall, "is_more_frequent": regime.is_more_frequent}
            for regime in self.regimes
        }
        return Fact(
            {
                "sentence": self.sentence,
                "first": self.first,
                "command": self.command,
                "lives": Fact(lives, (lowest_rows,), words=self.first),
                "size": self.size,
                "of": self.total,
                "inputs": Fact(inputs, (inputs_apart,)),
                "regimes": Fact(regimes, (regimes_of_first, share_interval)),
            },
            (earliest_rows,),
            mentions=(
                ("size",),
                *(("inputs", name) for name in inputs),
                *(("regimes", label) for label in regimes),
            ),
        )

    @property
    def first(self) -> str:
        """The rows that fail first."""
        named = [
            f"{number} ({self.unit.text(life)})"
            for number, life in zip(self.rows, self.lives, strict=True)
        ]
        rows, verb = ("row", "fails") if len(named) == 1 else ("rows", "fail")
        return sentence(f"{rows} {joined(named)} {verb} first")

    @property
    def why(self) -> str:
        """The distinguishing inputs of the earliest rows; "" if undetermined."""
        if self.inputs is None:
            return ""
        share = f"{100 * self.size / self.total:.2g} %"
        who = f"the earliest {share} ({grouped(self.size)} rows)"
        if not self.inputs:
            return f"No input differs measurably between {who} and the others."
        pairs = list(zip(self.inputs, self.units, strict=True))[:_MOST_INPUTS]
        text = f"{who} have {joined([_in_words(*pair, i == 0) for i, pair in enumerate(pairs)])}"
        return sentence(text)

    @property
    def where(self) -> str:
        """The most frequent regime of the earliest rows, compared with all rows."""
        if not self.regimes:
            return ""
        regime = self.regimes[0]
        by_chance = regime.share.low <= regime.overall <= regime.share.high
        also = ": the difference is not significant" * by_chance
        return (
            f"{share_text(regime.share)} of them are {regime.label}, against"
            f" {percent(regime.overall)} of all rows{also}."
        )

    @property
    def sentence(self) -> str:
        """The distinguishing inputs of the earliest rows, and their regime."""
        return " ".join(filter(None, (self.why, self.where)))

    @property
    def lines(self) -> list[str]:
        """All sentences."""
        return [*filter(None, (self.sentence, f"{self.first} Show the first: {self.command}"))]


def earliest(
    findings: Findings, element: Element, unit: DisplayUnit, dependence: Dependence
) -> Earliest | None:
    """Return the rows that fail first and their distinguishing inputs; None if none fails.

    Parameters
    ----------
    findings : Findings
    element : Element
        A life, in the independent rows.
    unit : DisplayUnit
        Of its lives.
    dependence : Dependence
        Of the independent rows.
    """
    try:
        chosen = lowest_rows(findings.result, element.name, _MOST_ROWS)
    except InputError:
        return None
    rows, lives = tuple(row for row, _ in chosen), tuple(life for _, life in chosen)
    if not rows or (len(rows) > 1 and not np.ptp(element.values[element.present])):
        return None
    result, lowest = findings.result, shlex.quote(element.name)
    command = f"uq row {result.file} --lowest {lowest}{result.model_option}"
    lowest_lives = Earliest(element.name, rows, lives, unit, command)
    places = earliest_rows(element)
    if len(places) < FEWEST:
        return lowest_lives
    inputs = inputs_apart(findings.rows, places, findings.input_ranks, dependence)
    return replace(
        lowest_lives,
        size=len(places),
        total=int(element.present.sum()),
        inputs=None if inputs is None else tuple(inputs),
        units=tuple(unit_of_input(findings.result, difference.name) for difference in inputs or ()),
        regimes=tuple(regimes_of_first(findings.rows, places, dependence)),
    )


def _in_words(difference: RankShift, unit: DisplayUnit, is_first: bool) -> str:
    name = called(difference.name)
    if difference.direction == 0:
        place = "away from" if difference.outwards > 0 else "near"
        return f"values of {name} {place} the middle of its range"
    side = "higher" if difference.direction > 0 else "lower"
    of_others = " for the others" if is_first else ""
    against = f"{unit.number(difference.median)} against {unit.text(difference.others)}"
    return f"a {side} {name} (median {against}{of_others})"
