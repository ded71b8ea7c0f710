"""A statistic of an output: its name, its estimate, and how each reader shows it."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace
from enum import Flag, auto
from functools import cached_property
from math import isfinite, isinf, isnan
from typing import Any

from uq.assess.estimators import Estimator
from uq.assess.joint_bounds import JointBound, joint_bounds
from uq.assess.population import as_sample
from uq.assess.sample import Sample
from uq.result.element import Element
from uq.result.result import Result
from uq.stats import estimate_json
from uq.stats.estimate import Estimate
from uq.stats.estimate_text import interval_text, value_text
from uq.stats.importance_weights import Smoothed
from uq.stats.intervals import Replicates
from uq.study.file import AnalysisTable
from uq.text.numbers import number


class Reader(Flag):
    """A reader of statistics; RUNNING are the estimates from growing numbers of rows."""

    JSON = auto()
    COLUMNS = auto()
    TERMINAL = auto()
    REPORT = auto()
    COMPARED = auto()
    RUNNING = auto()


@dataclass(frozen=True)
class Context:
    """What a statistic may need besides the element that it describes.

    Attributes
    ----------
    rows : Result
        The independent rows of a result.
    analysis : AnalysisTable
        What the study asks for.
    weights : Smoothed, optional
        Of the rows with nothing integrated, where they stand for another study.
    """

    rows: Result
    analysis: AnalysisTable
    weights: Smoothed | None = None

    @property
    def replicate(self) -> Replicates:
        """The replicate of each row, shape (n,); None where rows are independent."""
        return self.rows.replicates

    @cached_property
    def joint_bounds(self) -> list[JointBound]:
        """The bounds of all elements that hold at once."""
        return joint_bounds(self.rows, self.analysis)

    def sample(self, element: Element) -> Sample:
        """Return the rows of an element as a sample."""
        return as_sample(element, self.replicate, weights=self.weights)


@dataclass(frozen=True)
class Listing:
    """A table of a report: outputs in lines, statistics in columns.

    Attributes
    ----------
    caption : str
    first : str
        Heading of the first column, the name of the output.
    by : str
        Heading of the column that distinguishes several lines of an output (`Statistic.at`).
    keeps_empty : bool
        Whether columns without a number are kept.
    """

    caption: str = "Statistics, with 95 % intervals"
    _: KW_ONLY
    first: str = "output"
    by: str = ""
    keeps_empty: bool = False


def entry(statistic: "Statistic") -> dict[str, Any]:
    """Return a statistic as JSON."""
    document = estimate_json.whole(statistic.estimate)
    if statistic.rows_needed is not None:
        document["rows_needed"] = statistic.rows_needed
    if statistic.of:
        document["of"] = statistic.of
    if statistic.otherwise is not None:
        document["kaplan_meier"] = entry(statistic.otherwise)
    return document | estimate_json.failed(statistic.failed)


def entries(group: Sequence["Statistic"]) -> dict[str, Any]:
    """Return each statistic under the last part of its key."""
    return {statistic.key[-1]: statistic.kind.entry(statistic) for statistic in group}


def counts(group: Sequence["Statistic"]) -> dict[str, int | None]:
    """Return numbers of rows; None where no number will do."""
    numbers = {statistic.key[-1]: statistic.estimate.value for statistic in group}
    return {name: int(count) if isfinite(count) else None for name, count in numbers.items()}


def facts(group: Sequence["Statistic"]) -> dict[str, Any]:
    """Return the facts of the statistics."""
    return {name: fact for statistic in group for name, fact in statistic.facts.items()}


def count_in_words(value: float) -> str:
    """Return a number of rows, or "" for zero."""
    return f"{value:.0f}" if value else ""


@dataclass(frozen=True, kw_only=True)
class StatisticKind:
    """How statistics of one kind are shown.

    Attributes
    ----------
    name : str
        In the plural, at the start of a sentence.
    entry : callable
        Statistic -> its own JSON.
    write : callable
        Statistics whose keys differ only in the last part -> their JSON.
    shown : callable
        Value -> words.
    ends : callable
        Estimate, length of the unit -> its interval in words.
    is_count : bool
        Whether it is a number of rows.
    has_interval : bool
    listing : Listing
        The table of a report that holds it.
    readers : Reader
        One or several.
    """

    name: str = "These"
    entry: Callable[["Statistic"], dict[str, Any]] = entry
    write: Callable[[Sequence["Statistic"]], dict[str, Any]] = entries
    shown: Callable[[float], str] = number
    ends: Callable[[Estimate, float], str] = interval_text
    is_count: bool = False
    has_interval: bool = True
    listing: Listing = field(default_factory=Listing)
    readers: Reader = ~Reader(0)


ESTIMATE = StatisticKind()
COUNT = StatisticKind(
    write=counts,
    shown=count_in_words,
    is_count=True,
    has_interval=False,
    readers=~(Reader.COMPARED | Reader.RUNNING),
)
FACT = StatisticKind(write=facts, has_interval=False, readers=Reader.JSON | Reader.COLUMNS)


@dataclass(frozen=True)
class Statistic:
    """A statistic of an element of an output.

    Attributes
    ----------
    key : tuple of str
        Path of its entry in JSON, or where that would be; no two of an output are equal.
    label : str
        Its name on a terminal, and wherever no other is given; "" is not shown there.
    estimate : Estimate
    unit : str
        ``rows`` for a number of rows.
    kind : StatisticKind
    column, heading : str, optional
        Its name in pandas and in a report; "" if it is not shown there.
    failed : Estimate, optional
        The ends of its interval with the failed rows at best and at worst, where rows failed.
    otherwise : Statistic, optional
        The same under an assumption, where the rows alone do not decide it.
    rows_needed : float, optional
        The least number that gives a value; infinite where too many rows fail.
    falls : bool
        Whether it decreases as the values increase.
    at : float, optional
        The value of the output that it refers to.
    of : str
        The quantity that it describes, if not the output itself.
    more : str
        Small print in a report.
    notes : tuple of str
        Sentences below the table on a terminal.
    facts : dict
        The JSON of a `FACT`.
    estimator : Estimator, optional
        How it depends on the rows, for the difference between two studies with paired rows.
    by : tuple of callable
        The functions that compute it, whose docstrings state what they estimate and cite the
        source; by default its maker.
    resolution : float
        The smallest difference that its digits must show; 0 where five digits suffice.
    """

    key: tuple[str, ...]
    label: str
    estimate: Estimate
    unit: str = "1"
    kind: StatisticKind = ESTIMATE
    _: KW_ONLY
    column: str | None = None
    heading: str | None = None
    failed: Estimate | None = None
    otherwise: "Statistic | None" = None
    rows_needed: float | None = None
    falls: bool = False
    at: float | None = None
    of: str = ""
    more: str = ""
    notes: tuple[str, ...] = ()
    facts: Mapping[str, Any] = field(default_factory=dict)
    estimator: Estimator | None = None
    by: tuple[Callable[..., Any], ...] = ()
    resolution: float = 0.0

    def is_read_by(self, reader: Reader) -> bool:
        """Whether this reader shows it."""
        return reader in self.kind.readers

    @property
    def best(self) -> "Statistic":
        """Itself, or the estimate under an assumption where there is none without."""
        if self.otherwise is None or not isnan(self.estimate.value):
            return self
        return replace(self.otherwise, label=self.label)

    def words(self, per: float = 1.0) -> str:
        """Return its value in units of length `per`, or why there is none."""
        value = self.estimate.value
        if isfinite(value):
            if self.resolution:
                return number(value / per, self.resolution / per)
            return self.kind.shown(value / per)
        if self.rows_needed is not None:
            never = isinf(self.rows_needed)
            return "too many failed" if never else f"needs {self.rows_needed:.0f} rows"
        return "-" if self.otherwise else value_text(self.estimate)  # it may be within the horizon

    def interval(self, per: float = 1.0) -> str:
        """Return its interval in units of length `per`; "" where it has none."""
        if self.resolution:
            return interval_text(self.estimate, per, self.resolution)
        return self.kind.ends(self.estimate, per)


Maker = Callable[[Element, Context], Iterable[Statistic]]
"""Yields some statistics of an element."""
