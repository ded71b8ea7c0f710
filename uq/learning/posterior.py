"""The rows of a result as the inspections leave them: weighted, each with a scale of its lives."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.errors import InputError
from uq.learning.contradiction import contradictions
from uq.learning.evidence import Evidence, QuadratureGrid, weigh, weigh_on, wide
from uq.learning.importance import Importance, importance_of
from uq.learning.inspections import Inspection
from uq.learning.integrated_input import IntegratedScale, scale_of
from uq.learning.leave_one_out import log_worth
from uq.learning.observables import Look, look_at, quantities_of
from uq.learning.rows_as_units import Weighted, inspected, uninspected
from uq.learning.shared_law import SharedLaw, shared_law
from uq.learning.unit_likelihood import UnitLikelihoods
from uq.result.nesting import Nesting
from uq.result.result import Result
from uq.sampling.levels import SHARED
from uq.stats.importance_weights import Smoothed

Rows = NDArray[np.intp]

NO_OTHERS = (
    "only what units share is learnt, not the lives of units never inspected: each unit of a sample"
    " stands for an inspected one; set [design] units = {} or more"
)


@dataclass(frozen=True)
class Posterior:
    """The posterior: weighted rows of a result, given inspections.

    Attributes
    ----------
    any_unit : Weighted
        Units that were not inspected.
    units : dict of str to Weighted
        Each inspected one, by label.
    scale : IntegratedScale or None
    evidence : Evidence
    likelihoods : UnitLikelihoods
        Of the inspected units, in their order.
    looks : dict of Inspection to Look
    world : ndarray of int, shape (n,)
        Of each row.
    importance : Importance
        Of each row.
    law : SharedLaw or None
        Of the integrated input, where it is all that units share.
    not_integrated : tuple of str
        Sentences on inputs that scale what was inspected, but do more.
    only_inspected : str
        Why no row stands for a unit that was not inspected, or "": `any_unit` then tells what
        units share, and nothing of their own.
    """

    any_unit: Weighted
    units: Mapping[str, Weighted]
    scale: IntegratedScale | None
    evidence: Evidence
    likelihoods: UnitLikelihoods
    looks: Mapping[Inspection, Look]
    world: Rows
    importance: Importance
    law: SharedLaw | None
    not_integrated: tuple[str, ...]
    only_inspected: str = ""

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
    looks = _looks(rows, inspections)
    place = rows.nesting
    labels = list(dict.fromkeys(inspection.unit for inspection in inspections))
    if len(labels) > place.units:
        raise InputError(
            f"{len(labels)} units are inspected, but a sample of this result has {place.units}:"
            f" set [design] units = {len(labels)}"
        )
    scale, others = scale_of(rows, [looks[inspection] for inspection in inspections])
    world, worlds = _worlds(rows, place, scale)
    blocks = _blocks(place, len(labels), worlds)
    importance = importance_of(rows)
    likelihoods = UnitLikelihoods(inspections, looks, labels, blocks, scale, model_cv, importance)
    evidence = weigh(
        [partial(likelihoods.log_likelihood, unit) for unit in range(len(labels))],
        [world[block] for block in blocks],
        worlds,
        scale.quantiles if scale else None,
        bool(scale and scale.is_own),
    )
    if not np.isfinite(evidence.log_evidence):
        raise InputError(
            *contradictions(
                likelihoods, labels, evidence.grids, world, bool(scale and scale.is_own)
            )
        )
    law = shared_law(evidence) if scale and not scale.is_own and worlds == 1 else None
    part = rows.replicates if worlds > 1 or place.repeats > 1 else None
    units = {
        label: inspected(evidence, unit, likelihoods, world, scale, part, law)
        for unit, label in enumerate(labels)
    }
    logs, why = evidence.log_worlds[world], ""
    with np.errstate(divide="ignore"):
        logs = logs - np.log(np.bincount(world, importance.of_rows))[world, None]
        logs = logs + np.log(importance.of_rows)[:, None]
    if worlds > 1 and _units_differ(rows, scale):
        apart = log_worth(evidence, likelihoods, place, scale is None or scale.is_own)
        why = "" if np.isfinite(apart).any() else NO_OTHERS.format(len(labels) + 1)
        logs = logs if why else apart
    runs = partial(_allowed, likelihoods, world, worlds, scale) if scale else None
    everyone = uninspected(logs, evidence, scale, place, rows.replicates, runs, law)
    of_rows = likelihoods, looks, world, importance
    return Posterior(everyone, units, scale, evidence, *of_rows, law, others, why)


def _units_differ(rows: Result, scale: IntegratedScale | None) -> bool:
    """Return whether units of a world differ in more than the integrated input."""
    return bool({*rows.levels_that_vary(() if scale is None else (scale.name,))} - {SHARED})


def on_wide_grids(updated: Posterior) -> tuple[list[QuadratureGrid], Evidence]:
    """Return grids from end to end of the prior, of each inspected unit, and the evidence there."""
    scale, likelihoods = updated.scale, updated.likelihoods
    grids = [wide(grid, scale.quantiles if scale else None) for grid in updated.evidence.grids]
    worlds = [updated.world[block] for block in likelihoods.blocks]
    likelihood_functions = [partial(likelihoods.log_likelihood, unit) for unit in range(len(grids))]
    count, is_own = int(updated.world.max()) + 1, bool(scale and scale.is_own)
    return grids, weigh_on(grids, likelihood_functions, worlds, count, is_own)[1]


def _looks(rows: Result, inspections: Sequence[Inspection]) -> dict[Inspection, Look]:
    faults = []
    looks = {}
    quantities = quantities_of(rows)
    for inspection in inspections:
        try:
            looks[inspection] = look_at(quantities, inspection)
        except InputError as error:
            faults += [
                f"{inspection.where}: unit {inspection.unit}: {line}" for line in error.lines
            ]
    if faults:
        raise InputError(*faults)
    return looks


def _worlds(rows: Result, place: Nesting, scale: IntegratedScale | None) -> tuple[Rows, int]:
    """Return the world of each row, and how many there are.

    All rows are of one world where nothing is shared but what is integrated.
    """
    if not shared_inputs(rows, scale):
        return np.zeros(len(place.sample), np.intp), 1
    return place.sample, place.samples


def shared_inputs(rows: Result, scale: IntegratedScale | None) -> list[str]:
    """Return the inputs that units share, without the integrated one and those equal to it."""
    shared = [name for name, level in rows.levels.items() if level == SHARED]
    if scale is None or scale.is_own:
        return shared
    tied = {a for a, b in scale.inputs.tied.items() if b == scale.name}
    return [name for name in shared if name not in {scale.name, *tied}]


def _blocks(place: Nesting, inspected: int, worlds: int) -> list[Rows]:
    """Return the rows that stand for each inspected unit."""
    everything = np.arange(len(place.sample))
    if worlds == 1:
        return [everything] * inspected
    turn = place.unit % inspected
    return [everything[turn == i] for i in range(inspected)]


def _allowed(
    likelihoods: UnitLikelihoods, world: Rows, worlds: int, scale: IntegratedScale, places: Floats
) -> Mask:
    """Return where inspections allow values of an input that the units of a world share, (n,)."""
    values, possible = scale.quantiles(places)[:, None], np.ones(worlds, dtype=bool)
    for unit, rows in enumerate(likelihoods.blocks):
        agree = likelihoods.log_likelihood(unit, values[rows])[:, 0] > -np.inf
        possible &= np.bincount(world[rows], agree, worlds) > 0
    return np.asarray(possible[world])
