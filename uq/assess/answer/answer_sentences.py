"""The answer in sentences and as a tree of facts, its parts in reading order."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any

from uq.assess.answer.events import Event
from uq.assess.answer.leading_level import VarianceComponents
from uq.assess.answer.piece_of_advice import Advice
from uq.assess.answer.quantities import Quantity
from uq.assess.answer.sufficiency import SampleSizeAssessment
from uq.assess.answer.wording import share_text
from uq.assess.fact import Fact
from uq.assess.summary import status_counts
from uq.result.result import Result
from uq.stats.variance_components import nested_shares
from uq.text.numbers import grouped

RARE = 0.01
MOST_REGIMES = 3
"""Rarer regimes, and more of them, are left to the table."""


@dataclass(frozen=True, repr=False)
class Answer:
    """The answer of a study.

    Attributes
    ----------
    title : str
    rows, failed : int
    quantities : tuple of Quantity
        The subject of the study first.
    regimes : tuple of Event
        Shares of the regimes, the most frequent first.
    advice : tuple of Advice
    notes : tuple of str
        Missing results and their reasons.
    regimes_first : bool
        Whether the study is about the regimes: it names them before all other outputs.
    levels : VarianceComponents or None
        Variance components of the subject of the study, where samples have several rows.
    starts_alike : str
        Sentence on a start that is equal in all rows but might decide the regime, or "".
    enough : SampleSizeAssessment
        Sufficiency of the sample size.
    unmeasured : dict of str to Fact
        Assumed laws and fixed values, and laws without a source
        (`uq.assess.answer.wording.assumptions`).
    ties : str
        Sentence on inputs tied to a leading input, or "".
    mixing : Fact
        Intermingling of the regimes, of a study about them; without members where not known.
    result : Result or None
        The result that it describes.
    """

    title: str
    rows: int
    failed: int
    quantities: tuple[Quantity, ...]
    regimes: tuple[Event, ...]
    advice: tuple[Advice, ...]
    notes: tuple[str, ...] = ()
    regimes_first: bool = False
    levels: VarianceComponents | None = None
    starts_alike: str = ""
    enough: SampleSizeAssessment = field(default_factory=SampleSizeAssessment)
    unmeasured: Mapping[str, Fact] = field(default_factory=dict)
    ties: str = ""
    mixing: Fact = field(default_factory=lambda: Fact({}))
    result: Result | None = None

    @cached_property
    def fact(self) -> Fact:
        """The answer as a tree of facts, in the units of the outputs.

        Returns
        -------
        Fact
            The numbers of a sentence are members beside its ``sentence``.

            - ``rows``, ``failed``: numbers of all rows and of failed rows.
            - ``quantities``: element -> ``words``, ``promise``, ``range``, ``own_error`` (the
              promise if every value were wrong by its stated error), ``events`` (target -> event),
              ``earliest`` (of a life), ``another_seed`` (prediction interval) and ``ranking``.
            - ``regimes``: label -> event.
            - ``assumptions``: sentences.
            - ``enough``: sufficiency of the rows. ``others``: sentences on further unsettled
              results; ``expected``: prediction interval of a probability with another seed;
              ``own_error`` and ``sampling_error``, where the numerical error of the subject exceeds
              its sampling error.
            - ``intermingled``, if the regimes are: ``uncertainty_exponent`` of their boundary, and
              ``left``, the share of uncertain outcomes that stay so with inputs known twice as
              well.
            - ``levels``: ``shares`` of the variance, and the probability of ``another_regime``.
            - ``advice``: rule -> ``text``, ``inputs``, ``rows``, and ``tolerances``: for each
              compared one, the number ``what`` ``before`` and ``after`` the scatter of ``inputs``
              is halved. A second piece of advice of a rule is under ``rows_2``, and so on.

            A promise has the ranks of its bounds among all rows (``lower_is_row``) and, where too
            many rows share the last value for a bound, their share (``share_at_largest``). An event
            has its ``share``, its main driver (``decided_by``), its probability in ``parts`` of the
            range of the input ``over``, and the ``limit`` of this input: the unwanted side of the
            event is rare on average from ``at`` to ``end``; ``value`` is the probability in the
            part next to ``at``. A ranking has ``contributions``: ``inputs`` -> index, and
            ``effects`` -> change with a ``step`` of the input, in ``unit`` or, if that is "", in
            the unit of the output. Where first-order indices rank, it also has the share of the
            variance ``unexplained`` by any single input, and the total indices of an expansion
            (``totals``) if interactions could change the order. The earliest rows have ``lives``
            (row -> life), the ``inputs`` that distinguish them, and their ``regimes``.

            Not in the JSON: ``title``; ``unmeasured``, assumed laws and fixed values, and laws
            without a source; ``b_lives`` of a quantity, and the assumed quantities it is
            ``scaled_by``; the ``unit`` in which a promise, range, limit or tolerance is shown, and
            its length ``per``; ``settled``, whether the rows are enough for the question of the
            study; ``asked``, the path of the subject of the study, a quantity or the regimes.
        """
        result = self.result
        members: dict[str, Any] = {
            "rows": self.rows,
            "failed": self.failed,
            "quantities": Fact({entry.name: entry.fact(result) for entry in self.quantities}),
            "regimes": Fact({regime.predicate: regime.fact(result) for regime in self.regimes}),
            "assumptions": list(self.assumptions),
            "enough": self.enough.fact(result),
        }
        if self.mixing.members:
            members["intermingled"] = self.mixing
        members["levels"] = self.levels and self.levels.fact
        members["advice"] = Fact({key: advice.fact for key, advice in self.advice_by_key.items()})
        of_lead = [] if self.lead is None else ["quantities", self.lead.name]
        more = {
            "title": self.title,
            "asked": ["regimes"] if self.regimes_first else of_lead,
            "unmeasured": Fact(self.unmeasured),
        }
        by_member = dict.fromkeys(("rows", "failed"), (status_counts,))
        return Fact(
            members,
            by_member=by_member | {"levels": (nested_shares,)},
            words=self.rows_sentence,
            mentions=(("rows",), ("failed",)),
            more=more,
        )

    @property
    def advice_by_key(self) -> dict[str, Advice]:
        """Advice by its key in JSON: the rule, with a number from the second of a rule on."""
        by_key: dict[str, Advice] = {}
        for advice in self.advice:
            count = 1 + sum(earlier.rule == advice.rule for earlier in by_key.values())
            by_key[advice.rule if count == 1 else f"{advice.rule}_{count}"] = advice
        return by_key

    @property
    def assumptions(self) -> tuple[str, ...]:
        """Sentences on assumed laws and fixed values."""
        return tuple(fact.sentence for fact in self.unmeasured.values())

    @property
    def rows_sentence(self) -> str:
        """Sentence on the number of computed rows."""
        if self.failed:
            return f"{grouped(self.failed)} of {grouped(self.rows)} rows are invalid."
        return (
            f"All {grouped(self.rows)} rows were computed." if self.rows else "There are no rows."
        )

    @property
    def main_regimes(self) -> tuple[Event, ...]:
        """The regimes that are not rare."""
        return tuple(regime for regime in self.regimes if regime.share.value >= RARE)[:MOST_REGIMES]

    @property
    def asked_events(self) -> tuple[Event, ...]:
        """The events that the study is about."""
        if self.regimes_first:
            return self.main_regimes
        return () if self.lead is None else self.lead.events

    @property
    def events(self) -> list[Event]:
        """All events, regimes last."""
        return [event for quantity in self.quantities for event in quantity.events] + [
            *self.regimes
        ]

    @property
    def regimes_sentence(self) -> str:
        """The shares of the main regimes; "" if there is at most one."""
        shares = [f"{share_text(regime.share)} {regime.predicate}" for regime in self.main_regimes]
        return f"{', '.join(shares)}." if shares else ""

    @property
    def regime_causes(self) -> list[Event]:
        """The main regimes with a leading input; the most frequent only if no other has one."""
        ranked = [
            regime
            for regime in self.main_regimes
            if regime.ranking is not None and regime.ranking.leader is not None
        ]
        others = [regime for regime in ranked if regime is not self.main_regimes[0]]
        return others or ranked

    @property
    def lines(self) -> list[str]:
        """The answer in a few sentences."""
        lead = self.lead
        sentences = [] if not self.failed and lead else [self.rows_sentence]
        regimes = [regime.with_cause for regime in self.main_regimes]
        of_lead = [] if lead is None else lead.lines
        general = [*self.level_lines, self.enough.sentence]
        if self.regimes_first:
            sentences += [*regimes, self.mixing.sentence, *general, *of_lead]
        else:
            sentences += [*of_lead, *general, *regimes]
        sentences += [
            self.starts_alike,
            *([] if lead is None else [lead.ranking_sentence]),
            self.ties,
        ]
        if lead is not None and lead.earliest is not None:
            sentences += lead.earliest.lines
        return [*filter(None, sentences), *(advice.text for advice in self.advice)]

    @property
    def level_lines(self) -> list[str]:
        """Sentences on the variance components; none if unknown."""
        if self.levels is None:
            return []
        return [*filter(None, (self.levels.sentence, self.levels.switching))]

    def __repr__(self) -> str:
        """Return the answer in sentences, one a line."""
        return "\n".join([self.title, *self.lines])

    def _repr_html_(self) -> str:
        """Return the answer as a notebook shows it."""
        from uq.render.html.answer import notebook

        return notebook(self)

    @property
    def lead(self) -> Quantity | None:
        """The quantity that the study is about."""
        return self.quantities[0] if self.quantities else None
