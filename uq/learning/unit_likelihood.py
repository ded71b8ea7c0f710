"""The likelihood of all inspections of a unit, were it each of some rows."""

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
    """Likelihoods of units, were they each of their rows with values of the integrated input.

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
        self.of_unit = [[one for one in inspections if one.unit == label] for label in labels]
        self._looks, self.blocks, self._scale, self._cv = looks, blocks, scale, model_cv
        self._log_before = np.log(importance.of_rows)
        self._log_most = np.log(importance.most)
        self._values = np.empty(0)
        self._truths: dict[tuple[str, float | None, int], Floats] = {}

    def of(self, unit: int, values: Floats) -> Floats:
        """Return the logarithm of the likelihood and of what each row counts, shape (rows, g).

        Values of the integrated input are the same in all rows, shape (g,), or differ.
        """
        total = np.repeat(self.log_before(unit)[:, None], values.shape[-1], axis=1)
        for one in self.of_unit[unit]:
            total += self.of_one(one, unit, values)
        return total

    def log_before(self, unit: int) -> Floats:
        """Return the logarithm of what each row counts before the inspections, shape (rows,)."""
        return self._log_before[self.blocks[unit]]

    def of_one(self, one: Inspection, unit: int, values: Floats) -> Floats:
        """Return that of a single inspection, shape (rows, g)."""
        truth = self._truth(self._looks[one], one.time, self.blocks[unit], values)
        return self._looks[one].log_likelihood(one, truth, self._cv)

    def log_most(self, unit: int) -> float:
        """Return a bound of what `of` returns for any row."""
        return float(self._log_most + sum(log_most(one, self._cv) for one in self.of_unit[unit]))

    def bounded(self, unit: int, scale: Floats | None) -> NDArray[np.bool_]:
        """Return in which rows a censored life leaves open what was seen, shape (rows,).

        Parameters
        ----------
        unit : int
        scale : ndarray, shape (rows,), or None
            The integrated input of each row.
        """
        rows = self.blocks[unit]
        found = np.zeros(len(rows), dtype=bool)
        for one in self.of_unit[unit]:
            look, longer = self._looks[one], np.ones((len(rows), 1))
            if self._scale is not None and scale is not None and look.name in self._scale.exponents:
                longer = (scale / self._scale.drawn[rows])[:, None] ** self._scale.exponents[
                    look.name
                ]
            found |= look.bounded(one, rows, longer, self._cv)[:, 0]
        return found

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
