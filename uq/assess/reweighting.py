"""The rows of a result as those of another study: weighted, and laws of lives replaced."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cache

import numpy as np

from uq.assess.densities import changed_laws, log_ratio, share_without_rows
from uq.assess.row_inputs import Inputs
from uq.assess.scaling import integrated
from uq.errors import InputError, RunError
from uq.result.element import Element
from uq.result.result import Result
from uq.stats.importance_weights import Smoothed, no_weights, smoothed
from uq.stats.intervals import Replicates


class Weighting:
    """Importance weights of the rows of a result under the laws of another study.

    Parameters
    ----------
    rows : xarray.Dataset
        The independent rows of a result, or samples of several rows.
    old, new : Inputs
        The inputs of these rows, with the laws of either study.
    part : ndarray of int, shape (n,), or None
        The independent part of each row.

    Attributes
    ----------
    used : dict of str to Smoothed
        Element -> its weights.
    refused : dict of str to Smoothed
        Element -> its weights, which cannot be trusted, or are impossible: the other study has
        values where no row can be.
    """

    def __init__(self, rows: Result, old: Inputs, new: Inputs, part: Replicates):
        self._rows, self._old, self._new, self._part = rows, old, new, part
        self.used: dict[str, Smoothed] = {}
        self.refused: dict[str, Smoothed] = {}
        self.integrating = cache(self._integrating)

    @property
    def all_inputs(self) -> Smoothed:
        """The weights with nothing integrated."""
        return self.integrating(())

    @property
    def quality(self) -> tuple[float, float]:
        """The least effective number of rows of the weights used, and their largest Pareto k."""
        used = self.used.values()
        return (
            min((weights.effective for weights in used), default=0.0),
            max((weights.k for weights in used), default=0.0),
        )

    def refuse_if_unused(self) -> None:
        """Raise the first refusal where no element has reliable weights.

        Raises
        ------
        InputError
            When the weights are impossible.
        RunError
            When they cannot be trusted.
        """
        if self.refused and not self.used:
            first = next(iter(self.refused.values()))
            raise (InputError if first.impossible else RunError)(first.refusal)

    def elements(self, outputs: Sequence[str]) -> Iterator[Element]:
        """Yield the elements of the outputs whose weights are reliable."""
        for element in self._rows.elements(outputs):
            law = None
            if element.declared.scales and not element.censored.any():
                law = integrated(self._rows, element.declared, self._new)[0]
            weights = self.integrating(law.inputs if law else ())
            if weights.refusal:
                self.refused[element.name] = weights
                continue
            self.used[element.name] = weights
            yield replace(element, law=law, weights=weights.weights)

    def _integrating(self, inputs: tuple[str, ...]) -> Smoothed:
        """Return the weights of rows in which these inputs are integrated."""
        for name in changed_laws(self._old, self._new):
            if name not in inputs and (share := share_without_rows(self._old, self._new, name)):
                return no_weights(
                    len(self._rows),
                    f"uncertain.{name}: has {share:.2g} of its probability where the study's law"
                    " has none, so that no row is there; run it as a study of its own",
                )
        weights = log_ratio(len(self._rows), self._old, self._new, inputs)
        if not np.isfinite(weights.max()):
            why = "no row of this result is possible under the other laws"
            return no_weights(len(weights), why)
        return smoothed(weights, self._part)
