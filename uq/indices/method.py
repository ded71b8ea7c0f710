"""A sensitivity method: the data it takes, the rows it needs, and its estimate."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.indices.index import IndexKind, Indices, RefusedError
from uq.sampling.designs import PLAIN, Layout
from uq.stats.intervals import CONFIDENCE, Replicates, is_constant, replicates_of_some, sized
from uq.text.numbers import counted


@dataclass(frozen=True)
class DesignSample:
    """The rows of a result and one number for each, or one for each element of an output.

    Attributes
    ----------
    values : ndarray, shape (n,) or (n, e)
        The output, NaN where a row has none; of a whole output, a column for each element.
    inputs : dict of str to ndarray, shape (n,)
        The inputs that vary by a law of their own.
    groups : ndarray of int, shape (R, N, k)
        The rows of each replicate and group; of a plain sample each row is a group.
    blocks : tuple of str
        What the design calls the rows of a group, or, where the rows of a block are a group, the
        groups.
    direction : ndarray, shape (R, N, k - 1, d)
        Where inputs change one at a time: whether a step (third axis) raises an input (last axis),
        1, lowers it, -1, or neither, 0, in probability. Empty elsewhere.
    correlated : dict of str to tuple of str
        Input -> those it is correlated with, where the study states rank correlations.
    scores : ndarray, shape (R, N, k, d)
        Of paths, the normal scores of the inputs: their probabilities on the scale of a standard
        normal law. NaN for discrete inputs, and for what is correlated with one.
    matrix : ndarray, shape (d, d)
        The correlations of normal scores.
    random : bool
        Whether the model's rows depend on their seeds.
    quantiles : dict of str to float
        Name -> probability of each quantile that indices of quantiles are about.
    confidence : float
        Of intervals.
    nulls : bool
        Whether indices of inputs without effect are wanted for comparison.
    replicate : ndarray of int, shape (n,), optional
        Of a plain sample, the replicate of each row; None where rows are independent.
    difference : tuple of str, optional
        Two inputs, the difference of whose indices is estimated, too: label ``"x1 - x2"``.
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
    confidence: float = CONFIDENCE
    nulls: bool = True
    replicate: Replicates = None
    difference: tuple[str, str] | None = None

    @classmethod
    def plain(cls, values: Floats, inputs: Mapping[str, Floats], **more: Any) -> Self:
        """Return a sample without groups; `more` are other fields of it."""
        return cls(values, inputs, alone(len(values)), **more)

    @property
    def grouped(self) -> Floats:
        """The output by replicate, group and row, shape (R, N, k), with (e,) of a whole output."""
        return self.values[self.groups]

    @cached_property
    def whole(self) -> Mask:
        """Mask of groups with a value in each of their rows, shape (R, N)."""
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
            replicate=replicates_of_some(self.replicate, kept),
        )


def alone(rows: int) -> NDArray[np.intp]:
    """Return the groups of a plain sample, shape (1, n, 1)."""
    return np.arange(rows)[None, :, None]


NO_EFFECT = "the same value in all rows: nothing depends on the inputs"
NO_VARIANCE = "the same value in all rows: there is no variance to apportion"
UNSEEN = (
    "the same value in all independent rows, though not in those between them: they show no"
    " variance to apportion; more samples are needed"
)


@dataclass(frozen=True)
class SensitivityMethod:
    """One way to find which inputs matter.

    Attributes
    ----------
    question : str
        What it answers, in one line.
    layout : Layout
        How the rows of a design must belong together for it.
    estimate : callable
        ``estimate(sample)`` -> `Indices`, or `RefusedError`. Groups with a row without a value are
        left out by it (`DesignSample.whole`); every row of a plain sample has a value.
    kinds : tuple of IndexKind
        What it estimates; none where that depends on the study.
    gives : str
        The same in words.
    source : str
        Whose estimator it is.
    intervals : str
        What its intervals come from; "" where it has none.
    has_null : bool
        Whether its indices come with the null of inputs without effect.
    least : int
        Fewer whole groups give no indices.
    most_rows : int or None
        Of a larger plain sample this many rows are chosen: all would take too long.
    assumes_independence : bool
        Whether the inputs must be independent of each other. If not, they may depend in any way in
        a plain sample, and as the study states in the rows of a design.
    aggregates : bool
        Whether it also gives one index for all elements of an output: the sum of what an input
        explains of their variances, over the sum of these variances (Gamboa et al. 2014).
    takes_events, takes_numbers : bool
        Whether it is for events, outputs of 0 or 1, and for other outputs.
    conditional : bool
        Whether it is about an output among the rows in which an event happens, not about the event.
    scale_free : bool
        Whether it compares distributions: no increasing function of an output changes its indices.
    noise : str
        How it treats the noise of a random model where rows share seeds.
    pilot : callable or None
        ``pilot(sample)`` -> kind -> the largest standard deviation, over inputs, of a group's term
        in the mean that an index is; given where ``uq plan`` and ``uq convergence`` show indices.
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
            Its rows laid out as the method needs them.

        Returns
        -------
        Indices

        Raises
        ------
        RefusedError
            Too few groups have a value in each row, or the method finds no indices in them.
        """
        self.refuse_few_groups(sample)
        if self.of_variance:  # shares, of whatever unit
            sample = replace(sample, values=sized(sample.values)[0])
        if self.layout is not PLAIN:
            return self.estimate(sample)
        rows, note = np.flatnonzero(sample.whole), ""
        if sample.is_constant(sample.values[rows]):
            raise RefusedError(NO_EFFECT)
        kept = len(rows)
        if self.most_rows is not None and kept > self.most_rows:
            # At random: imported rows may come in a meaningful order.
            rows = np.sort(np.random.default_rng(0).choice(rows, self.most_rows, replace=False))
            note = (
                f"from {self.most_rows} of {kept} rows, chosen at random: all would take too long"
            )
        indices = self.estimate(sample.rows(rows))
        return replace(indices, notes=(note, *indices.notes) if note else indices.notes)

    def refuse_few_groups(self, sample: DesignSample) -> None:
        """Refuse a sample in which too few groups have a value in each row."""
        kept, every = int(sample.whole.sum()), sample.whole.size
        if kept < self.least:
            where = " where the event happens" * self.conditional
            seen = counted(kept, *self.layout.group) + where + f" (of {every})" * (kept < every)
            few = f"only {seen}" if kept else f"no {seen.removeprefix('0 ')}"
            raise RefusedError(f"{few}; {self.least} are needed", self.least / max(kept, 1))
