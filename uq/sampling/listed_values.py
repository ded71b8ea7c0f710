"""Laws of listed values: choices, integers, measured values or their histogram."""

from functools import lru_cache
from itertools import pairwise
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Self

import numpy as np
import scipy
from pydantic import Field, model_validator

from uq.contract import Floats
from uq.sampling.law import LIST, Law, Positive
from uq.text.numbers import counted

Numbers = Annotated[tuple[float, ...], LIST]

MAX_VALUES = 100_000
"""Largest number of values of an empirical law; a histogram describes more values equally well."""


class Steps(NamedTuple):
    """Discrete distribution with the methods of `scipy.stats` that are used here.

    It is faster than scipy's class, which compares each probability with each value.

    Attributes
    ----------
    values : ndarray, shape (k,)
        Ascending.
    cumulated : ndarray, shape (k,)
        Cumulative probability up to and including each value; the last entry is 1.
    """

    values: Floats
    cumulated: Floats

    def cdf(self, x: Any) -> Any:
        """Return P(X <= x)."""
        return np.append(0.0, self.cumulated)[np.searchsorted(self.values, x, side="right")]

    def sf(self, x: Any) -> Any:
        """Return P(X > x)."""
        return 1.0 - self.cdf(x)

    def ppf(self, p: Any) -> Any:
        """Return the least value with P(X <= value) >= p."""
        place = np.searchsorted(self.cumulated, p, side="left")
        return self.values[np.minimum(place, len(self.values) - 1)]

    def isf(self, q: Any) -> Any:
        """Return the least value with P(X > value) <= q."""
        return self.ppf(1.0 - np.asarray(q))


@lru_cache(maxsize=64)
def _steps(values: tuple[float, ...], weights: tuple[float, ...] | None) -> Steps:
    distinct, place = np.unique(values, return_inverse=True)
    cumulated = np.cumsum(np.bincount(place, weights))
    return Steps(distinct, cumulated / cumulated[-1])


class Listed(Law):
    """A discrete law."""

    discrete: ClassVar[bool] = True

    def between(self, low: float, high: float) -> tuple[float, float] | None:
        """Return the first and last value within two limits; None if there is none."""
        values = self.frozen().values
        inside = values[(low <= values) & (values <= high)]
        return (float(inside[0]), float(inside[-1])) if len(inside) else None

    def nearest(self, x: Floats) -> Floats:
        """Return the listed value nearest to each x, which removes rounding errors."""
        values = self.frozen().values
        nearest = values[np.searchsorted((values[1:] + values[:-1]) / 2, x)]
        return np.asarray(nearest)


class DiscreteChoice(Listed):
    """One of several values, each with its weight; equally likely if no weights are given."""

    pure = ("weights",)

    distribution: Literal["discrete-choice"]
    values: Annotated[Numbers, Field(min_length=1)]
    weights: Annotated[tuple[Positive, ...], LIST] | None = Field(
        None, description="how likely each value is, relative to the others"
    )

    @model_validator(mode="after")
    def _check_values(self) -> Self:
        if len(set(self.values)) < 2:
            raise ValueError("takes one value only; put the parameter into [fixed]")
        if self.weights is not None and len(self.weights) != len(self.values):
            values = counted(len(self.values), "value")
            raise ValueError(f"has {values} but {counted(len(self.weights), 'weight')}")
        return self

    def frozen(self) -> Steps:
        """Return the law before `truncate`."""
        return _steps(self.values, self.weights)


class IntegerRange(Listed):
    """A whole number between two ends, both included; all equally likely."""

    _ascending = ("lower", "upper")

    distribution: Literal["integer-range"]
    lower: int = Field(ge=-(2**53), le=2**53)
    upper: int = Field(ge=-(2**53), le=2**53)

    def frozen(self) -> Any:
        """Return the law before `truncate`."""
        return scipy.stats.randint(low=self.lower, high=self.upper + 1)

    def between(self, low: float, high: float) -> tuple[float, float] | None:
        """Return the first and last integer within two limits; None if there is none."""
        first, last = max(np.ceil(low), self.lower), min(np.floor(high), self.upper)
        return (float(first), float(last)) if first <= last else None

    def nearest(self, x: Floats) -> Floats:
        """Return the integer nearest to each x."""
        return np.rint(x)


class Empirical(Listed):
    """The values in a column of a CSV file, each equally likely to be drawn."""

    either = (("file", "column"), ("values",))
    pure = ("file", "column")

    distribution: Literal["empirical"]
    file: str | None = Field(None, description="CSV file with a header, beside the study file")
    column: str | None = Field(None, description="name of the column")
    values: Numbers | None = Field(None, description="the values themselves, instead of a file")

    @model_validator(mode="after")
    def _check_values(self) -> Self:
        if self.values is not None and (problem := values_problem(self.values)):
            raise ValueError(problem)
        return self

    def frozen(self) -> Steps:
        """Return the law before `truncate`."""
        assert self.values is not None, "the column has not been read"
        return _steps(self.values, None)


def values_problem(values: tuple[float, ...]) -> str | None:
    """Return the reason why values do not form an empirical law; None if they do."""
    if len(set(values)) < 2:
        return "needs at least two different values"
    if len(values) > MAX_VALUES:
        return f"has {len(values)} values (at most {MAX_VALUES}); use a histogram"
    return None


class Histogram(Law):
    """Counts of values in bins, uniform within each bin."""

    pure = ("counts",)

    distribution: Literal["histogram"]
    edges: Numbers = Field(description="ends of the bins, ascending, one more than counts")
    counts: Annotated[tuple[Annotated[float, Field(ge=0)], ...], LIST] = Field(
        description="number of values, or any weight, of each bin"
    )

    @model_validator(mode="after")
    def _check_bins(self) -> Self:
        if len(self.edges) != len(self.counts) + 1:
            sizes = f"{len(self.edges)} edges, {len(self.counts)} counts"
            raise ValueError(f"must have one edge more than counts: {sizes}")
        if not all(low < high for low, high in pairwise(self.edges)):
            raise ValueError("edges must ascend")
        if not sum(self.counts) > 0:
            raise ValueError("all counts are zero")
        return self

    def frozen(self) -> Any:
        """Return the law before `truncate` as a `scipy.stats.rv_histogram`."""
        return scipy.stats.rv_histogram(
            (np.array(self.counts), np.array(self.edges)), density=False
        )

    def kinks(self) -> tuple[float, ...]:
        """Return the bin edges."""
        return self.edges
