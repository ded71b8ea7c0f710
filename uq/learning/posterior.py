"""The rows of a result as the inspections leave them: weighted, each with a scale of its lives."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from uq.contract import Floats
from uq.errors import InputError
from uq.learning.contradiction import contradictions
from uq.learning.evidence import Evidence, weigh
from uq.learning.inspections import Inspection
from uq.learning.integrated_input import IntegratedScale
from uq.learning.leave_one_out import log_worth
from uq.learning.rows_as_units import WeightedRows, inspected, uninspected
from uq.learning.shared_law import SharedLaw, shared_law
from uq.learning.unit_likelihood import UnitLikelihoods
from uq.result.result import Result
from uq.sampling.levels import SHARED
from uq.stats.importance_weights import Smoothed

NO_OTHERS = (
    "only what units share is learnt, not the lives of units never inspected: each unit of a sample"
    " stands for an inspected one; set [design] units = {} or more"
)


@dataclass(frozen=True)
class Posterior:
    """The posterior: weighted rows of a result, given inspections.

    Attributes
    ----------
    any_unit : WeightedRows
        Units that were not inspected.
    units : dict of str to WeightedRows
        Each inspected one, by label.
    scale : IntegratedScale or None
    evidence : Evidence
    likelihoods : UnitLikelihoods
        Of the inspected units, in their order.
    law : SharedLaw or None
        Of the integrated input, where it is all that units share.
    not_integrated : tuple of str
        Sentences on inputs that scale what was inspected, but do more.
    only_inspected : str
        Why no row stands for a unit that was not inspected, or "": `any_unit` then tells what
        units share, and nothing of their own.
    """

    any_unit: WeightedRows
    units: Mapping[str, WeightedRows]
    scale: IntegratedScale | None
    evidence: Evidence
    likelihoods: UnitLikelihoods
    law: SharedLaw | None
    not_integrated: tuple[str, ...]
    only_inspected: str

    @property
    def weights(self) -> list[Smoothed]:
        """Of all units."""
        return [self.any_unit.weights, *(weighted.weights for weighted in self.units.values())]

    @property
    def pulls(self) -> Floats:
        """By how much each row moves the law, shape (n, terms)."""
        total = sum(
            weighted.pulls for weighted in self.units.values() if weighted.pulls is not None
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
        Of reality about the model, as for `uq.learning.likelihood.log_likelihood`.

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
    part = rows.replicates if several or place.repeats > 1 else None
    units = {
        label: inspected(unit, evidence, likelihoods, part, law)
        for unit, label in enumerate(likelihoods.labels)
    }
    logs, only_inspected = evidence.log_worlds[world], ""
    with np.errstate(divide="ignore"):
        logs = logs - np.log(np.bincount(world, importance))[world, None]
        logs = logs + np.log(importance)[:, None]
    # Units of a world differ in more than the integrated input.
    if several and {*rows.levels_that_vary([scale.name] if scale else ())} - {SHARED}:
        apart = log_worth(evidence, likelihoods, place)
        if np.isfinite(apart).any():
            logs = apart
        else:
            only_inspected = NO_OTHERS.format(len(units) + 1)
    any_unit = uninspected(logs, evidence, likelihoods, place, rows.replicates, law)
    not_integrated = likelihoods.not_integrated
    return Posterior(
        any_unit, units, scale, evidence, likelihoods, law, not_integrated, only_inspected
    )
