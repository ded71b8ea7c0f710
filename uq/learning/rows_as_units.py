"""Weighted rows that represent a unit, each with a value or law of the integrated input."""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray
from scipy import special

from uq.assess.scale_laws import SCORES, terms_at
from uq.contract import Floats, Mask
from uq.learning.evidence import Evidence
from uq.learning.integrated_input import IntegratedScale
from uq.learning.scale_posterior import (
    SharedLaw,
    edges_of_rows,
    in_order,
    in_order_of_weight,
    influence_of,
    masses,
    prior_places,
)
from uq.learning.unit_likelihood import UnitLikelihoods
from uq.result.nesting import Nesting
from uq.stats.dependent_rows import Dependence
from uq.stats.importance_weights import ImportanceWeights, smoothed

Places = NDArray[np.integer]

_HUGE = 700.0


def log_worth(evidence: Evidence, likelihoods: UnitLikelihoods, place: Nesting) -> Floats:
    """Return leave-one-out log weights of the rows as uninspected units.

    A row that agrees with an inspection makes its world probable, and would count as if it had been
    inspected itself. The likelihood of the row is therefore replaced by the mean over rows of other
    units of its world: its weight is then independent of its own inputs, given the shared ones, and
    unbiased.

    Parameters
    ----------
    evidence : Evidence
        Of the samples, each a world.
    likelihoods : UnitLikelihoods
        Of the inspected units.
    place : Nesting
        Of all rows.

    Returns
    -------
    ndarray, shape (n, g)
        Log probability of the world of each row, for each value of an integrated input shared by
        units (else g is 1), given all inspections. The mean likelihood of the inspected unit that
        the row represents is taken over the other units of the world that represent it; -inf where
        there is none.
    """
    values = [grid.values for grid in evidence.grids]
    shared = likelihoods.shares_scale
    worth = np.full((len(place.sample), len(values[0]) if shared else 1), -np.inf)
    for unit, rows in enumerate(likelihoods.blocks):
        sample = place.sample[rows]
        of_unit = sample * place.units + place.unit[rows]
        log_rows = likelihoods.log_likelihood(unit, values[unit])
        joint = evidence.rest[unit][sample] + _mean_of_others(log_rows, of_unit, sample)
        worth[rows] = joint if shared else special.logsumexp(joint, axis=1, keepdims=True)
    return worth


def _mean_of_others(logs: Floats, of_unit: Places, sample: Places) -> Floats:
    """Return the log mean over the rows of the other units of the sample, shape (m, g)."""
    _, unit = np.unique(of_unit, return_inverse=True)
    top = np.full((sample.max() + 1, logs.shape[1]), -np.inf)
    np.maximum.at(top, sample, logs)
    level = np.where(np.isfinite(top), top, 0.0)[sample]

    def others(numbers: Floats) -> Floats:
        sums = [np.zeros((index.max() + 1, numbers.shape[1])) for index in (sample, unit)]
        for total, index in zip(sums, (sample, unit), strict=True):
            np.add.at(total, index, numbers)
        return np.asarray(sums[0][sample] - sums[1][unit])

    count = others(np.ones((len(logs), 1)))
    total = np.maximum(others(np.exp(logs - level)), 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(count > 0, np.log(total / count) + level, -np.inf)


@dataclass(frozen=True)
class WeightedRows:
    """Weighted rows that represent a unit.

    Attributes
    ----------
    rows : ndarray of int, shape (m,)
    weights : ImportanceWeights
    scale : ndarray, shape (m,), or None
        Value of the integrated input in each row.
    scores : ndarray, shape (m, q), or None
        Its law in each row of an inspected unit (`PosteriorScale`).
    terms : ndarray, shape (m, terms), or None
        Terms of an input shared by all units, averaged over its law in each row.
    influence : ndarray, shape (m, terms), or None
        Influence of each row, as an inspected unit, on that law.
    """

    rows: NDArray[np.intp]
    weights: ImportanceWeights
    scale: Floats | None
    scores: Floats | None = None
    terms: Floats | None = None
    influence: Floats | None = None

    def without_own(self, influence: Floats) -> Floats:
        """Return the influence of each row on the law used by other rows, shape (n, terms).

        The influence of a row on itself, and the effect of values stratified over the law, are
        excluded.
        """
        assert self.terms is not None
        adjusted = influence.copy()
        adjusted[self.rows] -= self.weights.weights[:, None] * self.terms
        return adjusted


def uninspected(
    log_rows: Floats,
    evidence: Evidence,
    likelihoods: UnitLikelihoods,
    place: Nesting,
    dependence: Dependence,
    law: SharedLaw | None,
) -> WeightedRows:
    """Return all rows, weighted as uninspected units of the same world as the inspected ones.

    Rows of a sample with the same law of the integrated input have the same value of it.
    """
    rows, scale = np.arange(len(log_rows)), likelihoods.scale
    if scale is None or scale.is_own:
        weights = _smoothed_alike(special.logsumexp(log_rows, axis=1), place, dependence)
        return WeightedRows(rows, weights, None if scale is None else scale.drawn)
    grid = evidence.grids[0]
    edges = edges_of_rows(grid, log_rows > -np.inf, partial(_allowed_in_world, likelihoods, scale))
    worth = masses(grid, edges, np.exp(log_rows - log_rows.max()))
    with np.errstate(divide="ignore"):
        weights = _smoothed_alike(np.log(worth.sum(axis=1)), place, dependence)
    at = in_order(place.samples)[place.sample]
    drawn = prior_places(edges, worth, at[:, None])[:, 0].copy()
    terms = None if law is None else terms_at(law.scores, special.ndtri(drawn))
    return WeightedRows(rows, weights, scale.quantiles(drawn), terms=terms)


def _smoothed_alike(log_rows: Floats, place: Nesting, dependence: Dependence) -> ImportanceWeights:
    """Return Pareto-smoothed weights; rows of a sample with equal weights keep equal weights."""
    _, first = np.unique(place.sample, return_index=True)
    if not np.array_equal(log_rows, log_rows[first][place.sample]):
        return smoothed(log_rows, dependence)
    of_samples = smoothed(log_rows[first])
    return of_samples._replace(weights=of_samples.weights[place.sample])


def inspected(
    unit: int,
    evidence: Evidence,
    likelihoods: UnitLikelihoods,
    dependence: Dependence,
    law: SharedLaw | None,
) -> WeightedRows:
    """Return the weighted rows that represent an inspected unit.

    If all rows form a single world, the likelihood bounds the weights. The bound assumes that the
    values of the integrated input omitted by the grid do not make the other inspections more
    probable than the values of the grid do on average.
    """
    rows, grid, scale = likelihoods.blocks[unit], evidence.grids[unit], likelihoods.scale
    world, rest = likelihoods.world[rows], evidence.rest[unit]
    size = np.bincount(world, minlength=len(rest))
    of_unit = likelihoods.log_likelihood(unit, grid.values)
    joint = rest[world] + of_unit - np.log(size[world])[:, None]
    allowed = None if scale is None else partial(_allowed_in_unit, likelihoods, scale, unit)
    edges = edges_of_rows(grid, of_unit > -np.inf, allowed)
    top = joint.max()
    worth = masses(grid, edges, np.exp(joint - top))
    of_rows = worth.sum(axis=1)
    most = np.inf
    if len(rest) == 1:  # with several worlds, the weights also depend on the other units
        all_else = special.logsumexp(rest) - np.log((grid.high - grid.low) * size[0])
        log_most = likelihoods.log_most(unit) + all_else - top - np.log(of_rows.mean())
        most = float(np.exp(min(log_most, _HUGE)))
    kept = np.isin(np.arange(len(likelihoods.world)), rows)
    with np.errstate(divide="ignore"):
        weights = smoothed(np.log(of_rows), dependence[kept], most)
    if scale is None:
        return WeightedRows(rows, weights, None)
    of_law = np.broadcast_to(special.ndtr(SCORES), (len(rows), len(SCORES)))
    places = prior_places(edges, worth, np.column_stack([in_order_of_weight(of_rows), of_law]))
    scores = np.asarray(special.ndtri(places[:, 1:]))
    weighted = WeightedRows(rows, weights, scale.quantiles(places[:, 0].copy()), scores)
    if law is None:
        return weighted
    terms = worth @ law.terms / np.where(of_rows > 0, of_rows, 1.0)[:, None]
    return replace(weighted, terms=terms, influence=influence_of(unit, of_unit, evidence, law))


def _allowed_in_unit(
    likelihoods: UnitLikelihoods, scale: IntegratedScale, unit: int, places: Floats
) -> Mask:
    """Return the mask of rows whose input value has non-zero likelihood for a unit, shape (m,)."""
    return likelihoods.log_likelihood(unit, scale.quantiles(places)[:, None])[:, 0] > -np.inf


def _allowed_in_world(likelihoods: UnitLikelihoods, scale: IntegratedScale, places: Floats) -> Mask:
    """Return the mask of shared input values allowed by all inspections of a world, shape (n,)."""
    values, world = scale.quantiles(places)[:, None], likelihoods.world
    possible = np.ones(likelihoods.worlds, dtype=bool)
    for unit, rows in enumerate(likelihoods.blocks):
        agree = likelihoods.log_likelihood(unit, values[rows])[:, 0] > -np.inf
        possible &= np.bincount(world[rows], agree, likelihoods.worlds) > 0
    return np.asarray(possible[world])
