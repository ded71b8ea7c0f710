"""Sensitivity methods: the data of a method, its required rows, and its estimates."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.indices.index import IndexKind, Indices, RefusedError
from uq.sampling.designs import PLAIN, Layout
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.intervals import CONFIDENCE, is_constant, sized
from uq.text.numbers import counted

NO_EFFECT = "the same value in all rows: nothing depends on the inputs"
NO_VARIANCE = "the same value in all rows: there is no variance to apportion"
UNSEEN = (
    "the same value in all independent rows, though not in those between them: they show no"
    " variance to apportion; more samples are needed"
)


@dataclass(frozen=True)
class DesignSample:
    """Rows of a result for a sensitivity method: inputs, output and grouping by the design.

    Attributes
    ----------
    values : ndarray, shape (n,) or (n, e)
        Output of each row, NaN if missing; with a column for each element of an output.
    inputs : dict of str to ndarray, shape (n,)
        Inputs that vary by their own law.
    groups : ndarray of int, shape (R, N, k)
        Rows of each replicate and group; in a plain sample each row is a group.
    blocks : tuple of str
        Labels of the rows of a group in the design, or labels of the groups if the rows of a block
        form a group.
    direction : ndarray, shape (R, N, k - 1, d)
        For designs that change one input at a time: 1 if a step (third axis) increases the
        probability of an input (last axis), -1 if it decreases it, otherwise 0. Empty for other
        designs.
    correlated : dict of str to tuple of str
        Input -> correlated inputs, if the study states rank correlations.
    scores : ndarray, shape (R, N, k, d)
        For paths, the normal scores of the inputs: standard normal quantiles of their
        probabilities. NaN for discrete inputs, and for inputs correlated with a discrete one.
    matrix : ndarray, shape (d, d)
        Correlation matrix of the normal scores.
    random : bool
        Whether the model's rows depend on their seeds.
    quantiles : dict of str to float
        Name -> probability of each quantile, for quantile-oriented indices.
    normal : dict of str to callable
        Input of a plain sample -> function of its values that returns the standard normal scores
        behind them; only of inputs with a continuous law.
    confidence : float
        Confidence level of the intervals.
    nulls : bool
        Whether to estimate indices of inputs without effect for comparison.
    dependence : Dependence, optional
        Of the rows of a plain sample.
    difference : tuple of str, optional
        Two inputs; the difference of their indices is also estimated, with label ``"x1 - x2"``.
    """

    values: Floats
    inputs: Mapping[str, Floats]
    groups: NDArray[np.intp]
    blocks: tuple[str, ...] = ("sample",)
    direction: Floats = field(default_factory=lambda: np.empty(0))
    correlated: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    scores: Floats = field(default_factory=lambda: np.empty(0))
    matrix: Floats = field(default_factory=lambda: np.empty(0))
    random: bool = False
    quantiles: Mapping[str, float] = field(default_factory=dict)
    normal: Mapping[str, Callable[[Floats], Floats]] = field(default_factory=dict)
    confidence: float = CONFIDENCE
    nulls: bool = True
    dependence: Dependence = INDEPENDENT
    difference: tuple[str, str] | None = None

    @classmethod
    def plain(cls, values: Floats, inputs: Mapping[str, Floats], **more: Any) -> Self:
        """Return a sample without groups; `more` are other fields."""
        return cls(values, inputs, alone(len(values)), **more)

    @property
    def grouped(self) -> Floats:
        """The output by replicate, group and row, shape (R, N, k) or (R, N, k, e)."""
        return self.values[self.groups]

    @cached_property
    def whole(self) -> Mask:
        """Mask of complete groups, which have a value in every row, shape (R, N)."""
        finite = np.isfinite(self.grouped)
        return np.asarray(finite.all(axis=tuple(range(2, finite.ndim))))

    def is_constant(self, values: Floats) -> bool:
        """Return whether each element is constant over rows; the last axis of values is (e,)."""
        elements = self.values.shape[1] if self.values.ndim > 1 else 1
        return all(is_constant(element) for element in values.reshape(-1, elements).T)

    def rows(self, kept: NDArray[np.intp]) -> Self:
        """Return the selected rows of a plain sample."""
        return replace(
            self,
            values=self.values[kept],
            inputs={name: column[kept] for name, column in self.inputs.items()},
            groups=alone(len(kept)),
            dependence=self.dependence[kept],
        )


def alone(rows: int) -> NDArray[np.intp]:
    """Return the groups of a plain sample, shape (1, n, 1)."""
    return np.arange(rows)[None, :, None]


@dataclass(frozen=True)
class SensitivityMethod:
    """A sensitivity method: its estimator and its requirements.

    Attributes
    ----------
    question : str
        One-line question that the method answers.
    layout : Layout
        Required grouping of the rows of a design.
    estimate : callable
        ``estimate(sample)`` -> `Indices`, or `RefusedError`. It skips groups with a missing value
        (`DesignSample.whole`); every row of a plain sample has a value.
    kinds : tuple of IndexKind
        Estimated kinds of indices; empty if they depend on the study.
    gives : str
        Description of the estimated indices.
    source : str
        Source of the estimator.
    intervals : str
        Source of the intervals; "" if there are none.
    has_null : bool
        Whether its indices come with the null of inputs without effect.
    least : int
        Minimum number of complete groups.
    most_rows : int or None
        Number of rows selected from a larger plain sample, to limit the run time.
    assumes_independence : bool
        Whether the inputs must be independent. If not, inputs of a plain sample may have any
        dependence, and inputs of a design the dependence that the study states.
    aggregates : bool
        Whether it also gives an aggregated index over all elements of an output: the sum of their
        explained variances divided by the sum of their variances (Gamboa et al. 2014).
    takes_events, takes_numbers : bool
        Whether it applies to events, which are outputs of 0 or 1, and to other outputs.
    conditional : bool
        Whether it applies to an output among the rows with an event, rather than to the event.
    scale_free : bool
        Whether its indices are invariant under increasing functions of the output, since it
        compares distributions.
    noise : str
        Treatment of the noise of a random model if rows share seeds.
    pilot : callable or None
        ``pilot(sample)`` -> kind -> the largest standard deviation, over inputs, of the term of a
        group in the mean that estimates an index. Present if ``uq plan`` and ``uq convergence``
        show indices.
    """

    question: str
    layout: Layout
    estimate: Callable[[DesignSample], Indices]
    kinds: tuple[IndexKind, ...]
    gives: str = ""
    source: str = ""
    intervals: str = ""
    has_null: bool = False
    least: int = 1
    most_rows: int | None = None
    assumes_independence: bool = True
    aggregates: bool = False
    takes_events: bool = True
    takes_numbers: bool = True
    conditional: bool = False
    scale_free: bool = False
    noise: str = ""
    pilot: Callable[[DesignSample], dict[IndexKind, float]] | None = None

    @property
    def of_variance(self) -> bool:
        """Whether its indices are shares of the variance."""
        return any(kind.unit == "variance" for kind in self.kinds)

    def indices(self, sample: DesignSample) -> Indices:
        """Estimate the indices of one output.

        Parameters
        ----------
        sample : DesignSample
            Rows grouped as the method requires.

        Returns
        -------
        Indices

        Raises
        ------
        RefusedError
            There are too few complete groups, or they do not allow an estimate.
        """
        self.refuse_few_groups(sample)
        if self.of_variance:  # shares do not depend on the unit
            sample = replace(sample, values=sized(sample.values)[0])
        if self.layout is not PLAIN:
            return self.estimate(sample)
        rows, note = np.flatnonzero(sample.whole), ""
        if sample.is_constant(sample.values[rows]):
            raise RefusedError(NO_EFFECT)
        kept = len(rows)
        if self.most_rows is not None and kept > self.most_rows:
            # Random selection: imported rows may have a meaningful order.
            rows = np.sort(np.random.default_rng(0).choice(rows, self.most_rows, replace=False))
            note = (
                f"from {self.most_rows} of {kept} rows, chosen at random: all would take too long"
            )
        indices = self.estimate(sample.rows(rows))
        return replace(indices, notes=(note, *indices.notes) if note else indices.notes)

    def refuse_few_groups(self, sample: DesignSample) -> None:
        """Raise `RefusedError` if there are no inputs, or too few complete groups."""
        if not sample.inputs:
            raise RefusedError("the rows have no inputs")
        kept, every = int(sample.whole.sum()), sample.whole.size
        if kept < self.least:
            where = " where the event happens" * self.conditional
            seen = counted(kept, *self.layout.group) + where + f" (of {every})" * (kept < every)
            few = f"only {seen}" if kept else f"no {seen.removeprefix('0 ')}"
            raise RefusedError(f"{few}; {self.least} are needed", self.least / max(kept, 1))
