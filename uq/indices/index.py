"""Results of a sensitivity method: kinds of indices, with an estimate for every input."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import isfinite, nan
from typing import Literal

from uq.stats.estimate import NOTHING, Estimate


@dataclass(frozen=True)
class IndexKind:
    """A kind of sensitivity index.

    Attributes
    ----------
    key : str
        Name in tables and JSON.
    words : str
        Name in the legend of a figure.
    unit : {"variance", "1", "output", "p-value"}
        A share of the variance, another dimensionless number, a number in the output's unit, or a
        p-value, which does not measure the size of an effect.
    of_pairs : bool
        Whether the index belongs to pairs of inputs, named ``"first,second"``.
    """

    key: str
    words: str
    unit: Literal["variance", "1", "output", "p-value"] = "1"
    of_pairs: bool = False

    def text(self, value: float) -> str:
        """Return a value as text for a table: three decimals, or digits in the output's unit."""
        if not isfinite(value):
            return "-"
        if self.unit == "output":
            return f"{value:.3g}"
        if self.unit == "p-value" and value < 0.001:
            return "< 0.001"
        return f"{round(value, 3) + 0.0:.3f}"  # no minus sign before zero

    def interval(self, estimate: Estimate) -> str:
        """Return the ends of an interval as text for a table; "" if it is missing."""
        ends = [self.text(end) for end in (estimate.low, estimate.high)]
        return "" if ends == ["-", "-"] else " to ".join(ends)


S1 = IndexKind("S1", "alone (S1)", "variance")
ST = IndexKind("ST", "with all interactions (ST)", "variance")
S2 = IndexKind("S2", "in pairs (S2)", "variance", of_pairs=True)
SHAPLEY = IndexKind("shapley", "Shapley effect", "variance")


@dataclass(frozen=True)
class Null:
    """Null limits: quantiles of the same estimator for inputs without effect.

    Attributes
    ----------
    limit : float
        Limit that the index of a single input without effect exceeds with probability `exceeded`.
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
    """All sensitivity indices of one output.

    Attributes
    ----------
    values : dict of IndexKind to dict
        Input (``"first,second"`` for a pair) -> Estimate. Of the kinds that are not of pairs, the
        last one ranks the inputs.
    notes : tuple of str
        Sentences on missing numbers, and the reasons.
    nulls : dict of IndexKind to Null
        Null limits, if the method has no intervals.
    noise : Estimate or None
        Share of the variance that remains given all inputs, if the rows determine it.
    by_correlation : tuple of str
        Inputs whose index is due only to correlated inputs: they have no effect of their own.
    half_products : dict of (str, str) to float
        Covariance of the errors of the indices of two inputs, times the square of the quantile of
        their 95 % intervals; for one input it is the square of its half-width. The second input is
        not listed before the first. Present if one set of rows gives all indices.
    rows_factors : dict of str to float
        Input whose index lacks an interval -> factor of the sample size that would give one.
    unexplained : Estimate
        For first-order indices: share of the variance that no single input explains, if its error
        can be estimated.
    """

    values: Mapping[IndexKind, Mapping[str, Estimate]]
    notes: tuple[str, ...] = ()
    nulls: Mapping[IndexKind, Null] = field(default_factory=dict)
    noise: Estimate | None = None
    by_correlation: tuple[str, ...] = ()
    half_products: Mapping[tuple[str, str], float] = field(default_factory=dict)
    rows_factors: Mapping[str, float] = field(default_factory=dict)
    unexplained: Estimate = NOTHING

    @property
    def with_possible_ends(self) -> "Indices":
        """The indices, with intervals of shares of the variance that reach from 0 to 1.

        An index near 0 may be estimated significantly below 0, which no share can be: its interval
        ends at 0, since the share of an input without effect must be in it. Differences of two
        shares, labelled ``"x1 - x2"``, may be negative.
        """
        values = {
            kind: {
                label: index if " - " in label else _possible(index)
                for label, index in indices.items()
            }
            if kind.unit == "variance"
            else indices
            for kind, indices in self.values.items()
        }
        return replace(self, values=values, unexplained=_possible(self.unexplained))


def _possible(share: Estimate) -> Estimate:
    """Return a share with an interval that contains a number from 0 to 1."""
    return replace(share, low=min(share.low, 1.0), high=max(share.high, 0.0))


BY_CORRELATION = "by correlation alone"
"""Label of an index that is due to correlation alone."""


class RefusedError(Exception):
    """Raised if the indices of an output cannot be estimated.

    Parameters
    ----------
    why : str
        Reason, as a sentence.
    rows_factor : float
        Factor of the sample size that would give indices; NaN if unknown.
    """

    def __init__(self, why: str, rows_factor: float = nan):
        super().__init__(why)
        self.rows_factor = rows_factor


ALL_NOISE = "no input changes it at one seed: all of its variance is noise"
"""Reason why an output of a random model has no shares if compared rows share a seed."""
