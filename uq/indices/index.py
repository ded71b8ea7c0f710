"""The results of a sensitivity method: kinds of indices, each an estimate for every input."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import isfinite, nan
from typing import Literal

from uq.stats.estimate import NOTHING, Estimate


@dataclass(frozen=True)
class IndexKind:
    """One kind of index.

    Attributes
    ----------
    key : str
        Its name in tables and JSON.
    words : str
        What the legend of a figure calls it.
    unit : {"variance", "1", "output", "p-value"}
        A share of the variance, another number without a unit, a number in the output's unit, or a
        probability that is no size of an effect.
    of_pairs : bool
        Whether it belongs to pairs of inputs, named ``"first,second"``.
    """

    key: str
    words: str
    unit: Literal["variance", "1", "output", "p-value"] = "1"
    of_pairs: bool = False

    def text(self, value: float) -> str:
        """Return a value for a table: to three decimals, or digits in the unit of the output."""
        if not isfinite(value):
            return "-"
        if self.unit == "output":
            return f"{value:.3g}"
        if self.unit == "p-value" and value < 0.001:
            return "< 0.001"
        return f"{round(value, 3) + 0.0:.3f}"  # no minus sign before what is zero

    def interval(self, estimate: Estimate) -> str:
        """Return the ends of an interval for a table; nothing where there is none."""
        ends = [self.text(end) for end in (estimate.low, estimate.high)]
        return "" if ends == ["-", "-"] else " to ".join(ends)


S1 = IndexKind("S1", "alone (S1)", "variance")
ST = IndexKind("ST", "with all interactions (ST)", "variance")
S2 = IndexKind("S2", "in pairs (S2)", "variance", of_pairs=True)
SHAPLEY = IndexKind("shapley", "Shapley effect", "variance")


@dataclass(frozen=True)
class Null:
    """Limits of the index of inputs without effect, by the same estimator.

    Attributes
    ----------
    limit : float
        The index of a single input without effect exceeds it with probability `exceeded`.
    largest : float
        Upper 95 % limit of the largest index if no input has an effect; NaN if not estimated.
    exceeded : float
        Share of inputs without effect that exceed `limit`.
    """

    limit: float
    largest: float = nan
    exceeded: float = 0.05


@dataclass(frozen=True)
class Indices:
    """All indices of one output.

    Attributes
    ----------
    values : dict of IndexKind to dict
        Input (``"first,second"`` for a pair) -> Estimate; the kind that inputs are ranked by last
        of those that are not of pairs.
    notes : tuple of str
        Sentences on what is missing, and why.
    nulls : dict of IndexKind to Null
        Where the method has no intervals.
    noise : Estimate or None
        Share of the variance that remains once all inputs are known, where the rows determine it.
    by_correlation : tuple of str
        Inputs that have an index but no effect of their own: it is that of inputs they are
        correlated with.
    half_products : dict of (str, str) to float
        Covariance of the errors of the indices of two inputs, the second not listed before the
        first, times the square of the quantile that makes their 95 % intervals: of one input the
        square of its half-width. Where one set of rows gives all indices.
    rows_factors : dict of str to float
        Input whose index lacks an interval -> how many times the rows would give one.
    unexplained : Estimate
        Of first-order indices, the share of the variance that no single input explains, if its
        error is known.
    """

    values: Mapping[IndexKind, Mapping[str, Estimate]]
    notes: tuple[str, ...] = ()
    nulls: Mapping[IndexKind, Null] = field(default_factory=dict)
    noise: Estimate | None = None
    by_correlation: tuple[str, ...] = ()
    half_products: Mapping[tuple[str, str], float] = field(default_factory=dict)
    rows_factors: Mapping[str, float] = field(default_factory=dict)
    unexplained: Estimate = NOTHING


BY_CORRELATION = "by correlation alone"
"""Label beside the index of an input whose share is due to correlation alone."""


class RefusedError(Exception):
    """An output has no indices.

    Parameters
    ----------
    why : str
        A sentence.
    rows_factor : float
        How many times the rows would give indices; NaN where that is not known.
    """

    def __init__(self, why: str, rows_factor: float = nan):
        super().__init__(why)
        self.rows_factor = rows_factor


ALL_NOISE = "no input changes it at one seed: all of its variance is noise"
"""Why an output of a random model has no shares if the compared rows share a seed."""
