"""Likelihood of all inspections of a unit, for each row that represents it."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.errors import InputError
from uq.learning.importance import from_study, importance_of
from uq.learning.inspections import Inspection
from uq.learning.integrated_input import scale_of, shared_inputs
from uq.learning.likelihood import log_most
from uq.learning.observables import Observable, observed
from uq.result.result import Result


class UnitLikelihoods:
    """Likelihoods of the inspected units, given their rows and values of the integrated input.

    A world is one draw of the inputs that all units share: a sample, or all rows if units share at
    most the integrated input. With several worlds, each inspected unit uses separate rows of each;
    in a single world every row represents each unit, and observables common to inspections of
    several units are computed once.

    Parameters
    ----------
    rows : Result
        The independent rows of a result, or samples of several rows.
    inspections : sequence of Inspection
    model_cv : float
        Coefficient of variation of the model error, see `uq.learning.likelihood.log_likelihood`.

    Attributes
    ----------
    labels : list of str
        The inspected units.
    inspections : list of list of Inspection
        Of each of them.
    observables : dict of Inspection to Observable
    scale : IntegratedScale or None
    not_integrated : tuple of str
        Sentences on inputs that scale the observables but also affect other outputs.
    world : ndarray of int, shape (n,)
        Of each row.
    worlds : int
    blocks : list of ndarray of int
        The rows that represent each inspected unit.
    importance : ndarray, shape (n,)
        Prior importance weight of each row.
    from_study : ndarray of bool, shape (n,)
        Mask of rows drawn from the laws of the study.

    Raises
    ------
    InputError
        When an inspection does not fit the result, or, with several worlds, more units are
        inspected than samples have.
    """

    def __init__(self, rows: Result, inspections: Sequence[Inspection], model_cv: float):
        self.observables = observed(rows, inspections)
        self.labels = list(dict.fromkeys(inspection.unit for inspection in inspections))
        count, place = len(self.labels), rows.nesting
        self.inspections = [
            [inspection for inspection in inspections if inspection.unit == label]
            for label in self.labels
        ]
        self.scale, self.not_integrated = scale_of(rows, list(self.observables.values()))
        self.world, self.worlds = np.zeros(len(rows), np.intp), 1
        if shared_inputs(rows, self.scale):
            self.world, self.worlds = place.sample, place.samples
        if self.worlds > 1 and count > place.units:
            raise InputError(
                f"{count} units are inspected, but a sample of this result has {place.units}:"
                f" set [design] units = {count}"
            )
        number = np.arange(len(rows))
        self.blocks = [number] * count
        if self.worlds > 1:
            self.blocks = [number[place.unit % count == unit] for unit in range(count)]
        self.importance, self.from_study = importance_of(rows), from_study(rows)
        self._log_before = np.log(self.importance)
        self._cv = model_cv
        self._values = np.empty(0)
        self._truths: dict[tuple[str, float | None, int], Floats] = {}

    @property
    def shares_scale(self) -> bool:
        """Whether all units share the integrated input."""
        return self.scale is not None and not self.scale.is_own

    def log_likelihood(self, unit: int, values: Floats) -> Floats:
        """Return the log of likelihood times prior importance weight, shape (rows, g).

        Values of the integrated input are the same in all rows, shape (g,), or differ.
        """
        total = np.repeat(self.log_before(unit)[:, None], values.shape[-1], axis=1)
        for inspection in self.inspections[unit]:
            total += self.of_inspection(inspection, unit, values)
        return total

    def log_before(self, unit: int) -> Floats:
        """Return the log prior importance weight of each row, shape (rows,)."""
        return self._log_before[self.blocks[unit]]

    def of_inspection(self, inspection: Inspection, unit: int, values: Floats) -> Floats:
        """Return the log-likelihood of a single inspection, shape (rows, g)."""
        observable, rows = self.observables[inspection], self.blocks[unit]
        if not np.array_equal(values, self._values):
            self._values, self._truths = values, {}
        key = observable.name, inspection.time, int(rows[0])
        if key not in self._truths:
            self._truths[key] = self.truth(inspection, rows, values)
        return observable.log_likelihood(inspection, self._truths[key], self._cv)

    def truth(self, inspection: Inspection, rows: NDArray[np.intp], values: Floats) -> Floats:
        """Return the model value of the observable in the given rows, shape (rows, g)."""
        observable = self.observables[inspection]
        return observable.truth(inspection.time, rows, self._life_factor(observable, rows, values))

    def log_most(self, unit: int) -> float:
        """Return an upper bound of `log_likelihood` over all rows and values."""
        importance = np.log(len(self.from_study) / int(self.from_study.sum()))
        return float(
            importance
            + sum(log_most(inspection, self._cv) for inspection in self.inspections[unit])
        )

    def bounded(self, unit: int, scale: Floats | None = None) -> Mask:
        """Return the mask of rows in which censoring leaves the observable unknown, shape (rows,).

        Parameters
        ----------
        unit : int
        scale : ndarray, shape (rows,), optional
            The integrated input of each row, if it is not as drawn.
        """
        rows = self.blocks[unit]
        is_open, as_drawn = np.zeros(len(rows), dtype=bool), np.ones((len(rows), 1))
        for inspection in self.inspections[unit]:
            observable, life_factor = self.observables[inspection], as_drawn
            if scale is not None:
                life_factor = self._life_factor(observable, rows, scale[:, None])
            is_open |= observable.bounded(inspection, rows, life_factor, self._cv)[:, 0]
        return is_open

    def _life_factor(
        self, observable: Observable, rows: NDArray[np.intp], values: Floats
    ) -> Floats:
        """Return the factor by which other input values lengthen the lives, shape (rows, g)."""
        if self.scale is None or observable.name not in self.scale.exponents:
            return np.ones((len(rows), values.shape[-1]))
        ratio = values / self.scale.drawn[rows, None]
        return np.asarray(ratio ** self.scale.exponents[observable.name])
