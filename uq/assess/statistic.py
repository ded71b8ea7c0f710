"""A statistic of an output: its name, its estimate, and how each reader shows it."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import KW_ONLY, dataclass, field, replace
from enum import Flag, auto
from functools import cached_property
from math import inf, isfinite, isinf, isnan
from typing import Any, NamedTuple

from uq.assess.fact import Functions
from uq.assess.joint_bounds import JointBound, joint_bounds
from uq.assess.sample import Estimator, Sample
from uq.assess.weighted_mixture import as_sample
from uq.result.element import Element
from uq.result.result import Result
from uq.stats.estimate import Estimate, interval_text, value_text
from uq.stats.importance_weights import ImportanceWeights
from uq.study.file import AnalysisTable
from uq.text.numbers import number, percent, percent_interval


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
    """Inputs of a statistic other than the element that it describes.

    Attributes
    ----------
    rows : Result
        The independent rows of a result.
    analysis : AnalysisTable
        What the study asks for.
    weights : ImportanceWeights, optional
        Of the rows with nothing integrated, where they stand for another study.
    samples : dict of int to Sample
        The sample of the element that is described, by the identity of the element. All statistics
        share it, as it keeps what it has computed.
    """

    rows: Result
    analysis: AnalysisTable
    weights: ImportanceWeights | None = None
    samples: dict[int, Sample] = field(default_factory=dict, compare=False, repr=False)

    @cached_property
    def joint_bounds(self) -> list[JointBound]:
        """The bounds of all elements that hold at once."""
        return joint_bounds(self.rows, self.analysis)

    def sample(self, element: Element) -> Sample:
        """Return the rows of an element as a sample."""
        sample = self.samples.get(id(element))
        if sample is None:
            self.samples.clear()  # one element at a time in memory
            sample = as_sample(element, self.rows.dependence, weights=self.weights)
            self.samples[id(element)] = sample
        return sample


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


@dataclass(frozen=True, kw_only=True)
class StatisticKind:
    """Presentation of the statistics of one kind.

    Attributes
    ----------
    name : str
        In the plural, at the start of a sentence.
    form : str
        Of its JSON (`uq.assess.summary_facts`): ``estimate``; ``moment``, the number, its interval
        beside it; ``bound``, the number, and why there is none beside it; ``side`` of a threshold;
        ``share`` of a category; ``count``; ``number``; ``facts``, those of the statistic; "" for
        none of its own.
    text : str
        Format of its value; by default to five digits.
    is_share : bool
        Whether its value is written in per cent.
    without : str, optional
        Written in place of a value that is not above zero.
    is_count : bool
        Whether it is a number of rows.
    listing : Listing
        The table of a report that holds it.
    readers : Reader
        One or several.
    """

    name: str = "These"
    form: str = "estimate"
    text: str = ""
    is_share: bool = False
    without: str | None = None
    is_count: bool = False
    listing: Listing = field(default_factory=Listing)
    readers: Reader = ~Reader(0)

    @property
    def has_interval(self) -> bool:
        """Return whether its value has an interval."""
        return self.form in ("estimate", "moment", "side", "share")

    def words(self, value: float) -> str:
        """Return a value in words."""
        if self.without is not None and not value > 0:
            return self.without
        if self.is_share:
            return percent(value)
        return self.text.format(value) if self.text else number(value)


ESTIMATE = StatisticKind()
COUNT = StatisticKind(
    form="count",
    text="{:.0f}",
    without="",
    is_count=True,
    readers=~(Reader.COMPARED | Reader.RUNNING),
)
FACT = StatisticKind(form="facts", readers=Reader.JSON | Reader.COLUMNS)


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
        The JSON of a statistic of the form ``facts``.
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
    by: Functions = ()
    resolution: float = 0.0

    def is_read_by(self, reader: Reader) -> bool:
        """Return whether this reader shows it."""
        return reader in self.kind.readers

    def is_value_in(self, unit: str) -> bool:
        """Return whether it is a value of an output in this unit, not a share, count or shape."""
        of_output = self.kind.form in ("estimate", "moment", "bound") and not self.kind.is_share
        return of_output and self.unit == unit

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
            return self.kind.words(value / per)
        if self.rows_needed is not None:
            never = isinf(self.rows_needed)
            return "too many invalid" if never else f"needs {self.rows_needed:.0f} rows"
        return "-" if self.otherwise else value_text(self.estimate)  # it may be within the horizon

    def interval(self, per: float = 1.0) -> str:
        """Return its interval in units of length `per`; "" where it has none."""
        low, high = self.estimate.low, self.estimate.high
        if self.kind.is_share:
            return percent_interval(low, high) if self.estimate.has_interval else ""
        return interval_text(self.estimate, per, self.resolution)


Maker = Callable[[Element, Context], Iterable[Statistic]]
"""Yields some statistics of an element."""


class Placement(NamedTuple):
    """Place of the statistics of a maker in JSON and pandas; by default last, as in the table.

    Attributes
    ----------
    json, columns : float
        Rank of the first ones in the promised order.
    absent : {"", "null", "{}"}
        JSON where they do not apply to an output; "" leaves them out.
    """

    json: float = inf
    columns: float = inf
    absent: str = ""


_PLACES: dict[Maker, Placement] = {}


def placed(json: float = inf, columns: float = inf, absent: str = "") -> Callable[[Maker], Maker]:
    """Give a maker its place in JSON and pandas; the outermost decorator."""

    def place(make: Maker) -> Maker:
        _PLACES[make] = Placement(json, columns, absent)
        return make

    return place


def place_of(make: Maker) -> Placement:
    """Return the place of the statistics of a maker."""
    return _PLACES.get(make, Placement())
