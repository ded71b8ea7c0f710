"""One element of an output: one plain array, with the outcome of every row."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask, Output
from uq.text.element_names import Place
from uq.text.element_names import places as places


class RowLaw(Protocol):
    """Conditional law of a life in each row, given the inputs that are not integrated."""

    @property
    def inputs(self) -> tuple[str, ...]:
        """The integrated inputs."""

    @property
    def spread(self) -> float:
        """Standard deviation of log lives due to the integrated inputs."""

    def below(self, lives: Floats, time: float) -> Floats:
        """Return P(T < time) of each row, shape (n,), from its life; 0 where that is NaN."""


@dataclass(frozen=True)
class Element:
    """One number per row: an output, or one element of an output that has dimensions.

    Attributes
    ----------
    name : str
        ``work_rate[site=left]``.
    output : str
        ``work_rate``.
    declared : Output
        The declaration of the output; not a category.
    place : dict of str to object
        Dimension -> coordinate; empty for an output without dimensions.
    values : ndarray, shape (n,)
        NaN where missing; +inf for a life that never ends.
    censored : ndarray of bool, shape (n,)
        Where the value is only a lower bound.
    failed : ndarray of bool, shape (n,)
        Where the value is missing because the row failed.
    law : RowLaw, optional
        Conditional law of the life in each row, if the inputs that scale it are integrated.
    weights : ndarray, shape (n,), optional
        Weights of the rows, if they represent a posterior or another study.
    most : float
        The largest weight that a row can have.
    high : ndarray, shape (n,), optional
        Upper bounds of censored lives that are known to end between two times, else infinite.
    entered : ndarray, shape (n,), optional
        Times from which rows were under observation: late entry.
    causes : ndarray of int8, shape (n,), optional
        Index into the causes of the life; -1 where it has not ended.
    """

    name: str
    output: str
    declared: Output
    place: dict[str, Any]
    values: Floats
    censored: Mask
    failed: Mask
    law: RowLaw | None = None
    weights: Floats | None = None
    most: float = inf
    high: Floats | None = None
    entered: Floats | None = None
    causes: NDArray[np.int8] | None = None

    @property
    def units(self) -> str:
        """CF unit string."""
        return self.declared.unit

    @property
    def meaning(self) -> str:
        """One line that describes the output."""
        return self.declared.meaning

    @property
    def is_lifetime(self) -> bool:
        """Whether the output is the time until an event."""
        return self.declared.is_lifetime

    @property
    def is_angle(self) -> bool:
        """Whether its sign is a direction."""
        return self.declared.is_angle

    @property
    def for_thresholds(self) -> Floats:
        """The values, for an angle their magnitudes, shape (n,)."""
        return self.declared.for_thresholds(self.values)

    @property
    def undefined(self) -> Mask:
        """Mask of valid rows whose value is undefined."""
        return np.isnan(self.values) & ~self.failed

    @property
    def never(self) -> Mask:
        """Mask of rows whose life never ends."""
        return np.isposinf(self.values) & ~self.censored

    @cached_property
    def present(self) -> Mask:
        """Mask of rows with a value."""
        return ~np.isnan(self.values)

    def unknown_sides(self, threshold: float) -> Mask:
        """Return the mask of rows censored below a threshold, whose side is unknown."""
        if not self.censored.any():
            return self.censored
        unknown = self.censored & (self.values < threshold)
        return unknown if self.high is None else unknown & (self.high >= threshold)

    @property
    def within_interval(self) -> Mask:
        """Mask of rows whose life is known to end between two times."""
        if self.high is None:
            return np.zeros_like(self.censored)
        return self.censored & np.isfinite(self.high)

    @property
    def has_intervals_or_entries(self) -> bool:
        """Whether lives are known within intervals, or rows entered late."""
        return self.entered is not None or bool(self.within_interval.any())

    @property
    def is_plain(self) -> bool:
        """Whether rows are unweighted and have exact values, not conditional laws."""
        return self.law is None and self.weights is None

    @property
    def plain(self) -> "Element":
        """The same rows with their computed lives instead of conditional laws."""
        return replace(self, law=None)

    def below(self, threshold: float, signed: bool = False) -> Floats:
        """Return the probability that each row is below a threshold, shape (n,).

        Of an angle its magnitude counts, unless `signed`.
        """
        if self.law is not None:
            return self.law.below(self.values, threshold)
        values = self.values if signed else self.for_thresholds
        with np.errstate(invalid="ignore"):
            below = (values < threshold) & ~self.censored
            if self.high is not None:
                below |= self.censored & (self.high < threshold)
            return below.astype(float)

    def above(self, threshold: float) -> Floats:
        """Return the probability that each row is above a threshold, shape (n,)."""
        if self.law is not None:
            return np.where(self.present, 1 - self.law.below(self.values, threshold), 0.0)
        values = self.for_thresholds
        with np.errstate(invalid="ignore"):
            return ((values > threshold) | (self.censored & (values == threshold))).astype(float)

    @cached_property
    def at_least(self) -> Floats:
        """The values, shape (present,), with censored ones at their lower bound."""
        return self.values[self.present]

    @cached_property
    def ascending(self) -> Floats:
        """The values in order, shape (present,), sorted once for all quantiles."""
        return np.sort(self.at_least)

    @property
    def at_most(self) -> Floats:
        """The values, shape (present,), with censored ones at their upper bound or infinity."""
        latest = np.inf if self.high is None else self.high
        return np.where(self.censored, latest, self.values)[self.present]


def elements_in(
    name: str,
    declared: Output,
    values: Any,
    censored: Any,
    coordinates: Mapping[str, Any],
    failed: Mask,
    weights: Floats | None = None,
    most: float = inf,
    where: Iterable[Place] | None = None,
    beside: Mapping[str, Any] | None = None,
) -> Iterator[Element]:
    """Yield the elements of one output, in order.

    Parameters
    ----------
    name : str
    declared : Output
        Not a category.
    values : array, shape (n, *dims)
        Read one element at a time.
    censored : array of bool or int, shape (n, *dims), or None
        None if no life can be censored.
    coordinates : dict of str to array
        Of each dimension.
    failed : ndarray of bool, shape (n,)
        The rows that failed.
    weights : ndarray, shape (n,), optional
        Of the rows.
    most : float
        The largest weight that a row can have.
    where : iterable of Place, optional
        Which elements; by default all.
    beside : dict of str to array, shape (n, *dims)
        Companions of a life, by their names in `Element`: ``high``, ``entered``, ``causes``.

    Yields
    ------
    Element
    """
    if where is None:
        where = places(name, {dim: coordinates[dim] for dim in declared.dims})
    for label, index, place in where:
        column = np.asarray(values[(slice(None), *index)])
        absent = declared.is_absent(column)
        cut = np.zeros(len(column), dtype=bool)
        if censored is not None:
            cut = np.asarray(censored[(slice(None), *index)]).astype(bool) & ~absent
        of_place: dict[str, Any] = {
            key: np.asarray(array[(slice(None), *index)]) for key, array in (beside or {}).items()
        }
        yield Element(
            label,
            name,
            declared,
            place,
            np.where(absent, np.nan, column),
            cut,
            absent & failed,
            weights=weights,
            most=most,
            **of_place,
        )
