"""The rows of a result as the inspections leave them: weighted, each with a scale of its lives."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial

import numpy as np
import xarray as xr
from numpy.typing import NDArray

from uq.contract import Floats
from uq.designs.levels import OWN, SHARED
from uq.errors import InputError
from uq.inputs.conditioning import ppf_within
from uq.learning.evidence import Evidence, weigh
from uq.learning.inspections import Inspection
from uq.learning.looks import Look, look_at
from uq.population.scaling import Inputs, free_scales, inputs_of
from uq.population.smoothing import Smoothed, smoothed
from uq.rows.nesting import Nesting, levels_of, nesting_of

Rows = NDArray[np.intp]

_GOLDEN = (5**0.5 - 1) / 2


@dataclass(frozen=True)
class Scale:
    """An input that only scales lives, and is integrated on a grid.

    Attributes
    ----------
    name : str
    level : str
    exponents : dict of str to float
        Output -> its exponent.
    drawn : ndarray, shape (n,)
        The values of the rows.
    """

    name: str
    level: str
    exponents: Mapping[str, float]
    drawn: Floats
    inputs: Inputs

    def quantiles(self, probability: Floats) -> Floats:
        """Return quantiles of its prior."""
        return ppf_within(self.inputs.laws[self.name], probability, self.inputs.bounds[self.name])


@dataclass(frozen=True)
class Weighted:
    """Rows that stand for a unit.

    Attributes
    ----------
    rows : ndarray of int, shape (m,)
    weights : Smoothed
    scale : ndarray, shape (m,), or None
        What the integrated input is in each row.
    """

    rows: Rows
    weights: Smoothed
    scale: Floats | None


@dataclass(frozen=True)
class Posterior:
    """What inspections leave of a result.

    Attributes
    ----------
    any_unit : Weighted
        Units that were not inspected.
    units : dict of str to Weighted
        Each inspected one, by label.
    scale : Scale or None
    log_evidence : float
    """

    any_unit: Weighted
    units: Mapping[str, Weighted]
    scale: Scale | None
    log_evidence: float


def posterior(
    rows: xr.Dataset, inspections: Sequence[Inspection], model_cv: float = 0.0
) -> Posterior:
    """Return what inspections leave of a result.

    Parameters
    ----------
    rows : xarray.Dataset
        The independent rows of a result, or samples of several rows.
    inspections : sequence of Inspection
    model_cv : float
        Of a lognormal discrepancy between model and reality, whose median is 1.

    Returns
    -------
    Posterior

    Raises
    ------
    InputError
        When an inspection does not fit the result, or more units are inspected than samples have.
    """
    looks = _looks(rows, inspections)
    place = nesting_of(rows)
    labels = list(dict.fromkeys(one.unit for one in inspections))
    if len(labels) > place.units:
        raise InputError(
            f"{len(labels)} units are inspected, but a sample of this result has {place.units}:"
            f" set [design] units = {len(labels)}"
        )
    scale = _scale(rows, [looks[one] for one in inspections])
    world, worlds = _worlds(rows, place, scale)
    blocks = _blocks(place, len(labels), worlds)
    likelihoods = _Likelihoods(inspections, looks, labels, blocks, scale, model_cv)
    found = weigh(
        [partial(likelihoods.of, unit) for unit in range(len(labels))],
        [world[block] for block in blocks],
        worlds,
        scale.quantiles if scale else None,
    )
    if not np.isfinite(found.log_evidence):
        raise InputError("no row of this result agrees with the inspections")
    everyone = _uninspected(found, world, scale)
    units = {
        label: _inspected(
            found, unit, blocks[unit], world, likelihoods.of(unit, found.grid.values), scale
        )
        for unit, label in enumerate(labels)
    }
    return Posterior(everyone, units, scale, found.log_evidence)


class _Likelihoods:
    """Of all inspections of a unit, were it each of its rows with values of the integrated input.

    What inspections of different units would find in the same rows is computed once.
    """

    def __init__(
        self,
        inspections: Sequence[Inspection],
        looks: Mapping[Inspection, Look],
        labels: Sequence[str],
        blocks: Sequence[Rows],
        scale: Scale | None,
        model_cv: float,
    ):
        self._of_unit = [[one for one in inspections if one.unit == label] for label in labels]
        self._looks, self._blocks, self._scale, self._cv = looks, blocks, scale, model_cv
        self._values = np.empty(0)
        self._truths: dict[tuple[str, float | None, int], Floats] = {}

    def of(self, unit: int, values: Floats) -> Floats:
        """Return the logarithm of the likelihood, shape (rows, g)."""
        rows = self._blocks[unit]
        total = np.zeros((len(rows), len(values)))
        for one in self._of_unit[unit]:
            truth = self._truth(self._looks[one], one.time, rows, values)
            total += self._looks[one].log_likelihood(one, truth, self._cv)
        return total

    def _truth(self, look: Look, time: float | None, rows: Rows, values: Floats) -> Floats:
        if not np.array_equal(values, self._values):
            self._values, self._truths = values, {}
        key = look.name, time, int(rows[0])
        if key not in self._truths:
            longer = _longer(self._scale, look, rows, values)
            self._truths[key] = look.truth(time, rows, longer)
        return self._truths[key]


def _looks(rows: xr.Dataset, inspections: Sequence[Inspection]) -> dict[Inspection, Look]:
    faults = []
    found = {}
    known = cache(lambda one: look_at(rows, one))
    for one in inspections:
        try:
            found[one] = known(one)
        except InputError as error:
            faults += [f"unit {one.unit}: {line}" for line in error.lines]
    if faults:
        raise InputError(*faults)
    return found


def _scale(rows: xr.Dataset, looks: Sequence[Look]) -> Scale | None:
    """Return the input to integrate: a shared one first, of these the one that scatters lives most.

    One that scales all lives and depths that were inspected; outputs that it has no effect on say
    nothing of it.
    """
    inputs, levels = inputs_of(rows), levels_of(rows)
    scaled = [look for look in looks if look.declared.is_lifetime or look.depths is not None]
    if not scaled:
        return None
    common = [free_scales(inputs, look.declared.scales) for look in scaled]
    names = [name for name in common[0] if all(name in one for one in common)]
    names = [name for name in names if levels[name] in (SHARED, OWN)]
    if not names:
        return None

    def spread(name: str) -> float:
        return float(abs(common[0][name]) * np.log(inputs.values[name]).std())

    best = max(names, key=lambda name: (levels[name] == SHARED, spread(name)))
    exponents = {look.name: one[best] for look, one in zip(scaled, common, strict=True)}
    return Scale(best, levels[best], exponents, inputs.values[best], inputs)


def _worlds(rows: xr.Dataset, place: Nesting, scale: Scale | None) -> tuple[Rows, int]:
    """Return the world of each row, and how many there are.

    All rows are of one world where nothing is shared but what is integrated.
    """
    shared = {name for name, level in levels_of(rows).items() if level == SHARED}
    if shared and scale is not None and shared == {scale.name}:
        return np.zeros(len(place.sample), np.intp), 1
    return place.sample, place.samples


def _blocks(place: Nesting, inspected: int, worlds: int) -> list[Rows]:
    """Return the rows that stand for each inspected unit."""
    everything = np.arange(len(place.sample))
    if worlds == 1:
        return [everything] * inspected
    turn = place.unit % inspected
    return [everything[turn == i] for i in range(inspected)]


def _longer(scale: Scale | None, look: Look, rows: Rows, values: Floats) -> Floats:
    """Return by which factor lives are longer with other values of the integrated input."""
    if scale is None or look.name not in scale.exponents:
        return np.ones((len(rows), len(values)))
    return np.asarray((values / scale.drawn[rows, None]) ** scale.exponents[look.name])


def _uninspected(found: Evidence, world: Rows, scale: Scale | None) -> Weighted:
    """Return all rows, as units that share their world with the inspected ones."""
    worth = np.exp(found.log_worlds)
    rows = np.arange(len(world))
    size = np.bincount(world, minlength=len(worth))
    of_world = worth.sum(axis=1)
    with np.errstate(divide="ignore"):
        weights = smoothed(np.log(of_world[world] / size[world]))
    if scale is None:
        return Weighted(rows, weights, None)
    if scale.level == OWN:
        return Weighted(rows, weights, scale.drawn)
    return Weighted(rows, weights, _drawn(found, worth[world], rows, scale))


def _inspected(
    found: Evidence,
    unit: int,
    rows: Rows,
    world: Rows,
    log_likelihood: Floats,
    scale: Scale | None,
) -> Weighted:
    """Return the rows that stand for an inspected unit."""
    size = np.bincount(world[rows], minlength=len(found.log_worlds))
    with np.errstate(invalid="ignore", divide="ignore"):
        rest = found.log_worlds - found.log_units[unit] - np.log(size)[:, None]
        joint = rest[world[rows]] + log_likelihood
    joint = np.where(np.isnan(joint), -np.inf, joint)
    worth = np.exp(joint - joint.max())
    with np.errstate(divide="ignore"):
        weights = smoothed(np.log(worth.sum(axis=1)))
    return Weighted(rows, weights, _drawn(found, worth, rows, scale) if scale else None)


def _drawn(found: Evidence, worth: Floats, rows: Rows, scale: Scale) -> Floats:
    """Draw the integrated input of each row from its law given the inspections.

    The numbers drawn with are evenly spread over the rows, in their order.
    """
    low, high, _ = found.grid
    at = np.modf((rows + 1) * _GOLDEN)[0]
    edges = np.linspace(low, high, worth.shape[1] + 1)
    below = np.hstack([np.zeros((len(worth), 1)), np.cumsum(worth, axis=1)])
    total = below[:, -1]
    places = np.array(
        [np.interp(u * t, b, edges) for u, t, b in zip(at, total, below, strict=True)]
    )
    return scale.quantiles(np.where(total > 0, places, at))
