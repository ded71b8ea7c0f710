"""Findings: everything that tables and figures show of a result, each computed once."""

from collections.abc import Collection, Iterator, Mapping
from functools import cached_property
from itertools import chain
from typing import TYPE_CHECKING

from uq.assess.components_by_level import ByLevel, by_level
from uq.assess.effects import Regressors
from uq.assess.fleet import Fleet, fleet_of
from uq.assess.regimes import boundary
from uq.assess.row_inputs import independent_inputs
from uq.assess.sensitivities import Sensitivities, TargetIndices, sensitivities
from uq.assess.statistic import Statistic
from uq.assess.summary import Described, Summary, summarise
from uq.contract import Floats
from uq.errors import InputError
from uq.result.element import Element
from uq.result.result import Result
from uq.stats.order_statistics import mid_ranks
from uq.study.file import AnalysisTable

if TYPE_CHECKING:
    import pandas as pd


class Findings:
    """Results of an assessment, each computed once when first needed.

    Parameters
    ----------
    result : Result
    """

    def __init__(self, result: Result):
        self.result = result
        self._sensitivities: dict[str, Sensitivities] = {}
        self._indices: dict[tuple[str, str], TargetIndices] = {}

    @cached_property
    def rows(self) -> Result:
        """The independent rows."""
        return self.result.independent

    @cached_property
    def ranked(self) -> "Findings":
        """Findings on the rows that rank inputs (`uq.result.nesting.ranked_rows`)."""
        ranked = self.result.ranked
        return self if ranked is self.result else Findings(ranked)

    @cached_property
    def absent(self) -> frozenset[str]:
        """The outputs without a value in any independent row."""
        names = self.rows.output_names
        occurring = (
            element.output for element in self.rows.elements(names) if element.present.any()
        )
        return frozenset(names) - frozenset(occurring)

    @cached_property
    def input_ranks(self) -> dict[str, Floats]:
        """The rank of each input within the independent rows, from 0 to 1."""
        return {name: mid_ranks(column) for name, column in independent_inputs(self.rows).items()}

    @cached_property
    def regressors(self) -> Regressors:
        """The inputs of the independent rows, as regressors of any output."""
        return Regressors(independent_inputs(self.rows))

    @cached_property
    def summary(self) -> Summary:
        """The summary (`uq.assess.summary.summarise`)."""
        return summarise(self.result)

    def beside(self, analysis: AnalysisTable, parts: Collection[str]) -> Mapping[str, Described]:
        """Return other statistics of the outputs, computed with the summary if it is not yet."""
        if not parts:
            return {}
        if "summary" in self.__dict__:
            return summarise(self.result, analysis, parts=parts).outputs
        self.summary = summarise(self.result, beside=(analysis, parts))
        return self.summary.beside

    @cached_property
    def boundary(self) -> Statistic | None:
        """The boundary between regimes (`uq.assess.regimes.boundary`)."""
        return boundary(self.result)

    @cached_property
    def running(self) -> "pd.DataFrame":
        """The `uq.running_estimates`; if refused, no lines, and the reason in ``attrs``."""
        import pandas as pd

        from uq.assess.convergence import COLUMNS, running_table

        try:
            return running_table(self.result, summary=self.summary)
        except InputError as refused:
            nothing = pd.DataFrame(columns=COLUMNS)
            nothing.attrs["refused"] = str(refused)
            return nothing

    @cached_property
    def levels(self) -> ByLevel:
        """The variance components (`uq.assess.components_by_level.by_level`)."""
        return by_level(self.result)

    @cached_property
    def fleets(self) -> list[Fleet]:
        """The fleet of each life, of as many units as a sample has; empty where that is one."""
        units = self.rows.nesting.units
        shown = self.rows.shown_outputs(self.rows.analysis) if units > 1 else ()
        lives = [element for element in self.rows.elements(shown) if element.is_lifetime]
        return list(chain.from_iterable(_fleets(self.result, units, life) for life in lives))

    def sensitivities(self, method: str) -> Sensitivities:
        """Return the indices of all targets by a method (`uq.assess.sensitivities.sensitivities`).

        Raises
        ------
        InputError
            When the method does not apply to this result.
        """
        if method not in self._sensitivities:
            self._sensitivities[method] = sensitivities(self.result, method)
        return self._sensitivities[method]

    def indices(self, method: str, target: str) -> TargetIndices:
        """Return the indices of one target, also of one that must be asked for by name.

        Raises
        ------
        InputError
            When the method does not apply to this result, or there is no such target.
        """
        cached = self._sensitivities[method].targets if method in self._sensitivities else {}
        if target in cached:
            return cached[target]
        if (method, target) not in self._indices:
            computed = sensitivities(self.result, method, target).targets
            self._indices |= {
                (method, name): target_indices for name, target_indices in computed.items()
            }
        return self._indices[method, target]


def _fleets(result: Result, units: int, life: Element) -> Iterator[Fleet]:
    """Yield the fleet of a life, unless its rows are censored too early."""
    try:
        yield fleet_of(result, units, output=life.name)
    except InputError:
        return
