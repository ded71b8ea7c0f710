"""What a comparison of two results holds."""

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import chain

from uq.analysis.input_changes import Change, Spread
from uq.analysis.statistics.statistic import Statistic
from uq.analysis.summary import Summary
from uq.estimate import Estimate


@dataclass(frozen=True)
class Side:
    """One of two results: its title, and its summary of what either study asks for."""

    title: str
    summary: Summary


@dataclass(frozen=True)
class OnlyChange:
    """The one input that two studies have different, with its spread in each."""

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
        Whether the rows are pairs, and both of each say the same: then there is no interval.
    ratio : Estimate, optional
        The second over the first, of a scale.
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
    """Two results held against each other.

    Attributes
    ----------
    first, second : Side
    changed : list of Change
        What the studies have different.
    only : OnlyChange, optional
        The one input that differs, if it is the only thing.
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
