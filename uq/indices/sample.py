"""The data of a sensitivity method: one output and the rows of its design."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.stats.intervals import CONFIDENCE, Replicates, is_constant, replicates_of_some


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
