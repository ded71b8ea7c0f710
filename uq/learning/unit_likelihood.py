"""Likelihood of all inspections of a unit, evaluated for each row that stands for it."""

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.learning.importance import Importance
from uq.learning.inspections import Inspection
from uq.learning.integrated_input import IntegratedScale
from uq.learning.likelihood import log_most
from uq.learning.observables import Look


class UnitLikelihoods:
    """Likelihoods of units, evaluated for their rows and for values of the integrated input.

    What inspections of different units would find in the same rows is computed once.

    Parameters
    ----------
    inspections : sequence of Inspection
    looks : dict of Inspection to Look
    labels : sequence of str
        The inspected units.
    blocks : sequence of ndarray of int
        The rows that stand for each of them.
    scale : IntegratedScale or None
    model_cv : float
    importance : Importance
        Of all rows.
    """

    def __init__(
        self,
        inspections: Sequence[Inspection],
        looks: Mapping[Inspection, Look],
        labels: Sequence[str],
        blocks: Sequence[NDArray[np.intp]],
        scale: IntegratedScale | None,
        model_cv: float,
        importance: Importance,
    ):
        self.inspections = [
            [inspection for inspection in inspections if inspection.unit == label]
            for label in labels
        ]
        self._looks, self.blocks, self._scale, self._cv = looks, blocks, scale, model_cv
        self._log_before = np.log(importance.of_rows)
        self._log_most = np.log(importance.most)
        self._values = np.empty(0)
        self._truths: dict[tuple[str, float | None, int], Floats] = {}

    def log_likelihood(self, unit: int, values: Floats) -> Floats:
        """Return the logarithm of the likelihood and of what each row counts, shape (rows, g).

        Values of the integrated input are the same in all rows, shape (g,), or differ.
        """
        total = np.repeat(self.log_before(unit)[:, None], values.shape[-1], axis=1)
        for inspection in self.inspections[unit]:
            total += self.of_inspection(inspection, unit, values)
        return total

    def log_before(self, unit: int) -> Floats:
        """Return the logarithm of what each row counts before the inspections, shape (rows,)."""
        return self._log_before[self.blocks[unit]]

    def of_inspection(self, inspection: Inspection, unit: int, values: Floats) -> Floats:
        """Return the logarithm of the likelihood of a single inspection, shape (rows, g)."""
        truth = self._truth(self._looks[inspection], inspection.time, self.blocks[unit], values)
        return self._looks[inspection].log_likelihood(inspection, truth, self._cv)

    def log_most(self, unit: int) -> float:
        """Return an upper bound of `log_likelihood` over all rows and values."""
        return float(
            self._log_most
            + sum(log_most(inspection, self._cv) for inspection in self.inspections[unit])
        )

    def bounded(self, unit: int, scale: Floats | None) -> NDArray[np.bool_]:
        """Return in which rows a censored life leaves open what was seen, shape (rows,).

        Parameters
        ----------
        unit : int
        scale : ndarray, shape (rows,), or None
            The integrated input of each row.
        """
        rows = self.blocks[unit]
        is_open = np.zeros(len(rows), dtype=bool)
        for inspection in self.inspections[unit]:
            look, longer = self._looks[inspection], np.ones((len(rows), 1))
            if self._scale is not None and scale is not None and look.name in self._scale.exponents:
                longer = (scale / self._scale.drawn[rows])[:, None] ** self._scale.exponents[
                    look.name
                ]
            is_open |= look.bounded(inspection, rows, longer, self._cv)[:, 0]
        return is_open

    def _truth(
        self, look: Look, time: float | None, rows: NDArray[np.intp], values: Floats
    ) -> Floats:
        if not np.array_equal(values, self._values):
            self._values, self._truths = values, {}
        key = look.name, time, int(rows[0])
        if key not in self._truths:
            none = np.ones((len(rows), values.shape[-1]))
            longer = none if self._scale is None else self._scale.longer(look, rows, values)
            self._truths[key] = look.truth(time, rows, longer)
        return self._truths[key]
