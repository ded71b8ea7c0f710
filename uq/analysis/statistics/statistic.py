"""A statistic of an output: what it is called, what it is, and how each reader shows it."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import isfinite, isnan
from typing import Any

import xarray as xr

from uq import json_form
from uq.analysis.estimators import Estimator
from uq.estimate import Estimate
from uq.intervals import Replicates
from uq.rows.elements import Element
from uq.study.file import AnalysisTable
from uq.wording import known, number

JSON, COLUMNS, TERMINAL, REPORT, COMPARED, RUNNING = (
    "json",
    "columns",
    "terminal",
    "report",
    "compared",
    "running",
)
EVERYWHERE = frozenset((JSON, COLUMNS, TERMINAL, REPORT, COMPARED, RUNNING))
"""Who reads a statistic: also `uq compare`, and the estimates as rows came in."""


@dataclass(frozen=True)
class Context:
    """What a statistic may need besides the element of an output that it describes.

    Attributes
    ----------
    rows : xarray.Dataset
        The independent rows of a result.
    analysis : AnalysisTable
        What the study asks for.
    replicate : ndarray of int, shape (n,), or None
        Of each row; None where rows are independent.
    """

    rows: xr.Dataset
    analysis: AnalysisTable
    replicate: Replicates

    def present(self, element: Element) -> Replicates:
        """Return the replicates of the rows in which the element has a value."""
        return None if self.replicate is None else self.replicate[element.present]


@dataclass(frozen=True)
class Listing:
    """A table of a report: outputs in lines, statistics in columns.

    Attributes
    ----------
    caption : str
    first : str
        Heading of the first column, the name of the output.
    by : str
        What tells several lines of an output apart (`Statistic.at`), instead of the unit.
    keeps_empty : bool
        Whether columns without a number stay.
    of_lives : bool
        Whether it stands with the figures of lifetimes.
    """

    caption: str = "Statistics, with 95 % intervals"
    first: str = "output"
    by: str = ""
    keeps_empty: bool = False
    of_lives: bool = False


def entry(one: "Statistic") -> dict[str, Any]:
    """Return an estimate as JSON has it, with all that stands beside it."""
    found = json_form.whole(one.estimate)
    if one.rows_needed is not None:
        found["rows_needed"] = one.rows_needed
    if one.of:
        found["of"] = one.of
    if one.otherwise is not None:
        found["kaplan_meier"] = entry(one.otherwise)
    return found | json_form.failed(one.failed)


def entries(group: Sequence["Statistic"]) -> dict[str, Any]:
    """Return each statistic under the last part of its key."""
    return {one.key[-1]: one.kind.entry(one) for one in group}


def counts(group: Sequence["Statistic"]) -> dict[str, int]:
    """Return numbers of rows."""
    return {one.key[-1]: int(one.estimate.value) for one in group}


def facts(group: Sequence["Statistic"]) -> dict[str, Any]:
    """Return what the statistics state in so many words."""
    return {name: fact for one in group for name, fact in one.facts.items()}


def rows_in_words(value: float) -> str:
    """Return a number of rows; nothing for none."""
    return f"{value:.0f}" if value else ""


@dataclass(frozen=True)
class Kind:
    """How statistics of one sort are shown.

    Attributes
    ----------
    name : str
        Of several, at the start of a sentence.
    entry : callable
        Statistic -> its JSON alone.
    write : callable
        Statistics whose keys differ in the last part alone -> their JSON.
    shown : callable
        Value -> words.
    is_count : bool
        Whether it is a number of rows.
    has_interval : bool
    listing : Listing
        The table of a report in which it stands.
    readers : frozenset of str
    """

    name: str = "These"
    entry: Callable[["Statistic"], dict[str, Any]] = entry
    write: Callable[[Sequence["Statistic"]], dict[str, Any]] = entries
    shown: Callable[[float], str] = number
    is_count: bool = False
    has_interval: bool = True
    listing: Listing = field(default_factory=Listing)
    readers: frozenset[str] = EVERYWHERE


ESTIMATE = Kind()
COUNT = Kind(
    write=counts,
    shown=rows_in_words,
    is_count=True,
    has_interval=False,
    readers=EVERYWHERE - {COMPARED, RUNNING},
)
FACT = Kind(write=facts, has_interval=False, readers=frozenset((JSON, COLUMNS)))


@dataclass(frozen=True)
class Statistic:
    """A statistic of an element of an output.

    Attributes
    ----------
    key : tuple of str
        Path of its entry in JSON.
    label : str
        What it is called on a terminal, and wherever nothing else is given; "" is not shown there.
    estimate : Estimate
    unit : str
        ``rows`` of a number of rows.
    kind : Kind
    column, heading : str, optional
        Its name in pandas and in a report; "" if it is not there.
    failed : Estimate, optional
        The ends of its interval with the failed rows at best and at worst, where rows failed.
    otherwise : Statistic, optional
        The same under an assumption, where the rows alone leave it open.
    rows_needed : int, optional
        To know it at all.
    falls : bool
        Whether it falls as the values rise.
    at : float, optional
        The value of the output that it is about.
    of : str
        The number that it is of, if not of the output itself.
    sentence : str
        For the top of a report; ``{brief}``, ``{number}`` and ``{share}`` are its value, ``{at}``
        as above.
    more : str
        Small print in a report.
    notes : tuple of str
        Sentences below the table on a terminal.
    facts : dict
        What JSON has of a `FACT`.
    estimator : Estimator, optional
        What it makes of the rows, for the difference of two studies that share some.
    """

    key: tuple[str, ...]
    label: str
    estimate: Estimate
    unit: str = "1"
    kind: Kind = ESTIMATE
    column: str | None = None
    heading: str | None = None
    failed: Estimate | None = None
    otherwise: "Statistic | None" = None
    rows_needed: int | None = None
    falls: bool = False
    at: float | None = None
    of: str = ""
    sentence: str = ""
    more: str = ""
    notes: tuple[str, ...] = ()
    facts: Mapping[str, Any] = field(default_factory=dict)
    estimator: Estimator | None = None

    def is_read_by(self, reader: str) -> bool:
        """Whether it is shown there."""
        return reader in self.kind.readers

    @property
    def best(self) -> "Statistic":
        """Itself, or what there is under an assumption where nothing is known without."""
        if self.otherwise is None or not isnan(self.estimate.value):
            return self
        return replace(self.otherwise, label=self.label)

    def words(self, per: float = 1.0) -> str:
        """Return its value in units of length `per`, or why there is none."""
        value = self.estimate.value
        if isfinite(value):
            return self.kind.shown(value / per)
        if self.rows_needed is not None:
            return f"needs {self.rows_needed} rows"
        return "-" if self.otherwise else known(self.estimate)  # it may lie within the horizon


Maker = Callable[[Element, Context], Iterable[Statistic]]
"""Yields some statistics of an element."""
