"""The comparison of two results as records."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain

from uq.analysis.input_changes import Change, Spread
from uq.analysis.statistics.statistic import Statistic
from uq.analysis.summary import Summary
from uq.estimate import Estimate


@dataclass(frozen=True)
class Side:
    """One of two results: its title, and a summary of what either study asks for."""

    title: str
    summary: Summary


@dataclass(frozen=True)
class OnlyChange:
    """The only input that differs between two studies, with its spread in each."""

    name: str
    units: str
    first: Spread
    second: Spread


@dataclass(frozen=True)
class Compared:
    """A statistic of two results.

    Attributes
    ----------
    first, second : Statistic
    difference : Estimate
        The second less the first.
    identical : bool
        Whether the rows are paired and both rows of each pair agree: then there is no interval.
    ratio : Estimate, optional
        The second over the first, for a scale.
    """

    first: Statistic
    second: Statistic
    difference: Estimate
    identical: bool = False
    ratio: Estimate | None = None


@dataclass(frozen=True)
class ComparedOutput:
    """An element of an output: name in the table of statistics -> what is compared of it."""

    units: str
    parts: Mapping[str, tuple[Compared, ...]]

    @property
    def statistics(self) -> tuple[Compared, ...]:
        """All of them in order."""
        return tuple(chain.from_iterable(self.parts.values()))


@dataclass(frozen=True)
class Comparison:
    """The comparison of two results.

    Attributes
    ----------
    first, second : Side
    changed : list of Change
        Differences between the studies.
    only : OnlyChange, optional
        The input that differs, if nothing else does.
    pairing : str
        ``rows``, ``replicates``, ``strangers`` or ``unknown``.
    regimes : dict of str to Compared
    outputs : dict of str to ComparedOutput
    notes : list of str
    """

    first: Side
    second: Side
    changed: list[Change]
    only: OnlyChange | None
    pairing: str
    regimes: Mapping[str, Compared]
    outputs: Mapping[str, ComparedOutput]
    notes: list[str]
