"""The posterior of a result: weighted rows, information gains, contradictions."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import special

from uq.contract import Floats, Mask
from uq.errors import InputError, choices
from uq.learning.evidence import Evidence, QuadratureGrid, on_wide_grids, weigh
from uq.learning.inspections import Inspection
from uq.learning.integrated_input import IntegratedScale
from uq.learning.rows_as_units import WeightedRows, inspected, log_worth, uninspected
from uq.learning.scale_posterior import SharedLaw, shared_law
from uq.learning.unit_likelihood import UnitLikelihoods
from uq.result.result import Result
from uq.sampling.levels import SHARED
from uq.stats.dependent_rows import INDEPENDENT
from uq.stats.importance_weights import ImportanceWeights

_WHOLE = "no row of this result agrees with"

NO_OTHERS = (
    "only shared inputs are learnt, not the lives of uninspected units: each unit of a sample"
    " represents an inspected one; set [design] units = {} or more"
)


def contradictions(likelihoods: UnitLikelihoods, grids: Sequence[QuadratureGrid]) -> list[str]:
    """Return messages naming the smallest sets of inspections that no row is consistent with.

    Checked in order: single inspections, pairs of one unit, all inspections of a unit, then pairs
    of units that share a world or an integrated input.

    Parameters
    ----------
    likelihoods : UnitLikelihoods
    grids : sequence of QuadratureGrid
        Of each inspected unit.
    """
    agree = [
        {
            inspection: likelihoods.of_inspection(inspection, unit, grid.values) > -np.inf
            for inspection in inspections
        }
        for unit, (grid, inspections) in enumerate(zip(grids, likelihoods.inspections, strict=True))
    ]
    for size, all_of_them in ((1, "it"), (2, "both")):
        if messages := [
            f"{' and '.join(map(_described, chosen))}: {_WHOLE} {all_of_them}"
            for unit in agree
            for chosen in combinations(unit, size)
            if not _agreeing(unit, chosen).any()
        ]:
            return messages
    together = [_agreeing(unit, unit) for unit in agree]
    if messages := [
        f"unit {label}: {_WHOLE} all its inspections"
        f" ({choices([inspection.where for inspection in unit])})"
        for label, unit, rows in zip(likelihoods.labels, agree, together, strict=True)
        if not rows.any()
    ]:
        return messages
    worlds = [
        _agreeing_worlds(rows, block, likelihoods)
        for rows, block in zip(together, likelihoods.blocks, strict=True)
    ]
    pairs = combinations(zip(likelihoods.labels, agree, worlds, strict=True), 2)
    return [
        f"units {a} and {b}: {_WHOLE} the inspections of both"
        f" ({choices([inspection.where for inspection in (*first, *second)])})"
        for (a, first, of_a), (b, second, of_b) in pairs
        if not (of_a & of_b).any()
    ] or [f"{_WHOLE} the inspections"]


def _agreeing(agree: Mapping[Inspection, Mask], chosen: Iterable[Inspection]) -> Mask:
    """Return the mask of rows consistent with all chosen inspections, shape (rows, g)."""
    return np.logical_and.reduce([agree[inspection] for inspection in chosen])


def _described(inspection: Inspection) -> str:
    return f"{inspection.where} (unit {inspection.unit}, {inspection.output}, {inspection.kind})"


def _agreeing_worlds(rows: Mask, block: NDArray[np.intp], likelihoods: UnitLikelihoods) -> Mask:
    """Return the mask of worlds and shared input values with at least one consistent row."""
    agreeing = np.zeros((likelihoods.worlds, rows.shape[1]), dtype=bool)
    np.logical_or.at(agreeing, likelihoods.world[block], rows)
    shared = likelihoods.shares_scale
    return agreeing if shared else np.asarray(agreeing.any(axis=1, keepdims=True))


@dataclass(frozen=True)
class Posterior:
    """The posterior: weighted rows of a result, given inspections.

    Attributes
    ----------
    any_unit : WeightedRows
        Units that were not inspected.
    units : dict of str to WeightedRows
        Each inspected one, by label.
    evidence : Evidence
    likelihoods : UnitLikelihoods
        Of the inspected units, in their order.
    law : SharedLaw or None
        Posterior law of the integrated input, if units share no other input.
    only_inspected : str
        Why no row represents an uninspected unit, or "". If not empty, `any_unit` describes the
        shared inputs only.
    """

    any_unit: WeightedRows
    units: Mapping[str, WeightedRows]
    evidence: Evidence
    likelihoods: UnitLikelihoods
    law: SharedLaw | None
    only_inspected: str

    @property
    def scale(self) -> IntegratedScale | None:
        """The integrated input."""
        return self.likelihoods.scale

    @property
    def not_integrated(self) -> tuple[str, ...]:
        """Sentences on inputs that scale the observables but also affect other outputs."""
        return self.likelihoods.not_integrated

    @property
    def weights(self) -> list[ImportanceWeights]:
        """Weights for uninspected units and for each inspected unit."""
        return [self.any_unit.weights, *(weighted.weights for weighted in self.units.values())]

    @property
    def influence(self) -> Floats:
        """Influence of each row on the shared law, shape (n, terms)."""
        total = sum(
            weighted.influence for weighted in self.units.values() if weighted.influence is not None
        )
        return np.asarray(total - np.mean(total, axis=0))


def posterior(rows: Result, inspections: Sequence[Inspection], model_cv: float = 0.0) -> Posterior:
    """Return the posterior of a result, given inspections [1]_.

    Parameters
    ----------
    rows : Result
        The independent rows of a result, or samples of several rows.
    inspections : sequence of Inspection
    model_cv : float
        Coefficient of variation of the model error, see `uq.learning.likelihood.log_likelihood`.

    Returns
    -------
    Posterior

    Raises
    ------
    InputError
        When an inspection does not fit the result, or more units are inspected than samples have.

    References
    ----------
    .. [1] C. Andrieu, G. O. Roberts, "The pseudo-marginal approach for efficient Monte Carlo
       computations", Ann. Stat. 37, 697-725 (2009).
    """
    likelihoods, place = UnitLikelihoods(rows, inspections, model_cv), rows.nesting
    evidence = weigh(likelihoods)
    if not np.isfinite(evidence.log_evidence):
        raise InputError(*contradictions(likelihoods, evidence.grids))
    scale, world, importance = likelihoods.scale, likelihoods.world, likelihoods.importance
    several = likelihoods.worlds > 1
    law = shared_law(evidence) if likelihoods.shares_scale and not several else None
    dependence = rows.dependence if several or place.repeats > 1 else INDEPENDENT
    units = {
        label: inspected(unit, evidence, likelihoods, dependence, law)
        for unit, label in enumerate(likelihoods.labels)
    }
    logs, only_inspected = evidence.log_worlds[world], ""
    with np.errstate(divide="ignore"):
        logs = logs - np.log(np.bincount(world, importance))[world, None]
        logs = logs + np.log(importance)[:, None]
    # Units of a world also differ in inputs other than the integrated one.
    if several and {*rows.levels_that_vary([scale.name] if scale else ())} - {SHARED}:
        apart = log_worth(evidence, likelihoods, place)
        if np.isfinite(apart).any():
            logs = apart
        else:
            only_inspected = NO_OTHERS.format(len(units) + 1)
    any_unit = uninspected(logs, evidence, likelihoods, place, rows.dependence, law)
    return Posterior(any_unit, units, evidence, likelihoods, law, only_inspected)


class InformationGain(NamedTuple):
    """Information gain of an inspection, given all others.

    Attributes
    ----------
    inspection : Inspection
    bits : float
        Relative entropy of the posterior with it to the posterior without it.
    units : str
        CF unit of what was inspected.
    time_unit : str
        Of the time of the inspection.
    """

    inspection: Inspection
    bits: float
    units: str
    time_unit: str


def information_gains(posterior: Posterior) -> Iterator[InformationGain]:
    """Yield the information gain of each inspection, in their order.

    The gain concerns all unknowns, shared and of each unit, relative to the posterior given all
    other inspections [1]_.

    References
    ----------
    .. [1] D. V. Lindley, "On a measure of the information provided by an experiment", Ann. Math.
       Stat. 27, 986-1005 (1956).
    """
    likelihoods = posterior.likelihoods
    evidence = on_wide_grids(posterior.evidence, likelihoods)
    for unit, grid in enumerate(evidence.grids):
        world = likelihoods.world[likelihoods.blocks[unit]]
        size = np.bincount(world)[world]
        rest = evidence.rest[unit][world] + (likelihoods.log_before(unit) - np.log(size))[:, None]
        single = {
            inspection: likelihoods.of_inspection(inspection, unit, grid.values)
            for inspection in likelihoods.inspections[unit]
        }
        for inspection in single:
            others = [log for other, log in single.items() if other != inspection]
            bits = _gain(rest + sum(others, np.zeros(rest.shape)), single[inspection])
            observable = likelihoods.observables[inspection]
            yield InformationGain(inspection, bits, observable.unit, observable.time_unit)


def _gain(before: Floats, log_likelihood: Floats) -> float:
    """Return the relative entropy of the updated to the given unnormalised log density [bit]."""
    after = before + log_likelihood
    total = special.logsumexp(after)
    share = np.exp(after - total)
    mean = share[share > 0] @ log_likelihood[share > 0]
    return float(max(mean - (total - special.logsumexp(before)), 0.0) / np.log(2))
