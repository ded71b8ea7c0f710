"""Marginal likelihood of the inspections, by world, unit and value of the integrated input.

A world is one draw of the inputs that all units share: a sample, or all rows if units share at most
the integrated input. With several worlds, each inspected unit uses separate rows of each, so that
the product over units of their mean likelihoods is an unbiased estimate of the evidence of a world.
In a single world every row represents each unit.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import special

from uq.contract import Floats
from uq.learning.integrated_input import IntegratedScale
from uq.learning.unit_likelihood import UnitLikelihoods

FINEST = 1e-9
"""Largest posterior probability that the grid of the integrated input omits in each tail."""

_NODES = 64
_MOST_NODES = 512
_FINE = 8.0
"""Minimum effective number of grid nodes in the law of the integrated input of a row."""

_MET = 2.0
"""With fewer effective nodes than this, rows are missed."""

_FAR = 7.5
_PASSES = 8


class QuadratureGrid(NamedTuple):
    """Quadrature nodes of an integrated input, even in probability, in the tails in normal score.

    Attributes
    ----------
    edges : ndarray, shape (g + 1,)
        Prior probabilities at the edges of the cells.
    values : ndarray, shape (g,)
    log_share : ndarray, shape (g,)
        Logarithm of the prior probability of each value.
    """

    edges: Floats
    values: Floats
    log_share: Floats

    @property
    def low(self) -> float:
        """Prior probability at the lower end."""
        return float(self.edges[0])

    @property
    def high(self) -> float:
        """Prior probability at the upper end."""
        return float(self.edges[-1])


@dataclass(frozen=True)
class Evidence:
    """Posterior of the worlds and of the integrated input in each, with the log evidence.

    Attributes
    ----------
    log_worlds : ndarray, shape (w, g)
        Logarithm of the posterior probability of each world, and of each value of an integrated
        input that all its units share (else g is 1); the sum of the probabilities is 1.
    log_units : tuple of ndarray, shape (w, g)
        Logarithm of the mean likelihood of each inspected unit.
    rest : tuple of ndarray, shape (w, g)
        For each inspected unit the posterior without its own likelihood, not normalised.
    log_evidence : float
        Logarithm of the probability of all inspections.
    grids : tuple of QuadratureGrid
        Of each inspected unit.
    nodes : float
        Effective number of nodes in the law of the integrated input of a row, for the unit with
        the fewest.
    """

    log_worlds: Floats
    log_units: tuple[Floats, ...]
    rest: tuple[Floats, ...]
    log_evidence: float
    grids: tuple[QuadratureGrid, ...]
    nodes: float = np.inf


def weigh(likelihoods: UnitLikelihoods) -> Evidence:
    """Return the evidence of the inspections, on grids refined until they resolve the posterior."""
    grids, nodes = [_grid(0.0, 1.0, likelihoods.scale, _NODES)] * len(likelihoods.blocks), _NODES
    for _ in range(_PASSES):
        evidence = weigh_on(grids, likelihoods)
        if likelihoods.scale is None or not np.isfinite(evidence.log_evidence):
            break
        narrower = [
            _narrower(*arguments)
            for arguments in zip(grids, evidence.log_units, evidence.rest, strict=True)
        ]
        if likelihoods.shares_scale:
            narrower = narrower[:1] * len(grids)
        if evidence.nodes < _MET and nodes < _MOST_NODES:
            # Nodes that no row resolves may still be possible: refine before narrowing.
            narrower, nodes = [(grid.low, grid.high) for grid in grids], nodes * 2
        elif not any(_is_half(*both) for both in zip(narrower, grids, strict=True)):
            if nodes == _MOST_NODES or evidence.nodes >= _FINE:
                break
            nodes *= 2
        grids = [_grid(low, high, likelihoods.scale, nodes) for low, high in narrower]
    return evidence


def on_wide_grids(evidence: Evidence, likelihoods: UnitLikelihoods) -> Evidence:
    """Return the evidence on grids over the full prior, as fine as the given grids."""
    if (scale := likelihoods.scale) is None:
        return evidence
    grids = []
    for grid in evidence.grids:
        below = np.linspace(0.0, grid.low, _NODES // 2)
        above = np.linspace(grid.high, 1.0, _NODES // 2)
        grids.append(_joined([below, grid.edges, above], scale))
    return weigh_on(grids, likelihoods)


def weigh_on(grids: Sequence[QuadratureGrid], likelihoods: UnitLikelihoods) -> Evidence:
    """Return the evidence on given grids, one per inspected unit."""
    worlds, log_units, nodes = likelihoods.worlds, [], []
    for unit, (grid, block) in enumerate(zip(grids, likelihoods.blocks, strict=True)):
        log_rows = likelihoods.log_likelihood(unit, grid.values)
        world = likelihoods.world[block]
        log_mean, of_worlds = _mean_likelihood(log_rows, world, worlds, grid.log_share)
        log_units.append(log_mean)
        nodes.append(of_worlds)
    if likelihoods.shares_scale:
        log_worlds, others = _with_all_but_each(log_units, grids[0].log_share, worlds)
        rest = [*others]
    else:
        integrated = [
            special.logsumexp(log_mean + grid.log_share, axis=1, keepdims=True)
            for log_mean, grid in zip(log_units, grids, strict=True)
        ]
        log_worlds, others = _with_all_but_each(integrated, np.zeros(1), worlds)
        rest = [of_unit + grid.log_share for of_unit, grid in zip(others, grids, strict=True)]
    total, fewest = float(special.logsumexp(log_worlds)), np.inf
    if np.isfinite(total):
        log_worlds = log_worlds - total
        worth = np.exp(log_worlds)
        share = worth.sum(axis=1)
        if likelihoods.shares_scale:
            nodes.append(share**2 / np.maximum((worth**2).sum(axis=1), 1e-300))
        counts = share > 0
        fewest = min(float(np.average(n[counts], weights=share[counts])) for n in nodes)
    return Evidence(log_worlds, tuple(log_units), tuple(rest), total, tuple(grids), fewest)


def _grid(low: float, high: float, scale: IntegratedScale | None, nodes: int) -> QuadratureGrid:
    if scale is None:
        return QuadratureGrid(np.array([0.0, 1.0]), np.ones(1), np.zeros(1))
    first, last = _scores(low, high)
    scores = np.linspace(first, last, nodes + 1)[1:-1]
    return _joined([np.linspace(low, high, nodes + 1), special.ndtr(scores)], scale)


def _scores(low: float, high: float) -> Floats:
    """Return normal scores of probabilities, limited to finite values."""
    return np.asarray(special.ndtri(np.array([low, high])).clip(-_FAR, _FAR))


def _joined(parts: Sequence[Floats], scale: IntegratedScale) -> QuadratureGrid:
    """Return the grid whose cells have the given edges, as prior probabilities."""
    edges = np.unique(np.concatenate(parts))
    return QuadratureGrid(edges, scale.quantiles(centres(edges)), np.log(np.diff(edges)))


def centres(edges: Floats) -> Floats:
    """Return the centre of each cell: the probability at its mean normal score."""
    scores = special.ndtri(edges)
    width, middle = np.diff(scores), (scores[1:] + scores[:-1]) / 2
    with np.errstate(invalid="ignore"):
        narrow = middle * (1 - width**2 / 12)
    density = np.exp(-(scores**2) / 2) / np.sqrt(2 * np.pi)
    return np.asarray(
        special.ndtr(np.where(width < 0.1, narrow, -np.diff(density) / np.diff(edges)))
    )


def _with_all_but_each(
    log_units: Sequence[Floats], log_share: Floats, worlds: int
) -> tuple[Floats, Floats]:
    """Return the log posterior (unnormalised) of all units, and with each unit left out."""
    impossible = np.isneginf(log_units)
    finite = np.where(impossible, 0.0, log_units)
    count, total = impossible.sum(axis=0), finite.sum(axis=0) + log_share - np.log(worlds)
    rest = np.where(count > impossible, -np.inf, total - finite)
    return np.where(count > 0, -np.inf, total), rest


def _narrower(grid: QuadratureGrid, log_unit: Floats, rest: Floats) -> tuple[float, float]:
    """Return the range of the grid with nearly all probability, widened by one node each side."""
    share = special.logsumexp(log_unit + rest, axis=0)
    share = np.exp(share - special.logsumexp(share))
    below, above = np.cumsum(share), np.cumsum(share[::-1])
    first = max(int(np.searchsorted(below, FINEST)) - 1, 0)
    last = len(share) - max(int(np.searchsorted(above, FINEST)) - 1, 0)
    return float(grid.edges[first]), float(grid.edges[last])


def _is_half(ends: tuple[float, float], grid: QuadratureGrid) -> bool:
    """Return whether the range is at most half the grid, in probability or in normal score."""
    middle = ends[1] - ends[0] <= 0.5 * (grid.high - grid.low)
    return middle or bool(np.ptp(_scores(*ends)) <= 0.5 * np.ptp(_scores(grid.low, grid.high)))


def _mean_likelihood(
    log_likelihood: Floats, world: NDArray[np.intp], worlds: int, log_share: Floats
) -> tuple[Floats, Floats]:
    """Return the log of the mean likelihood over the rows of each world, shape (worlds, g).

    Also return the effective number of nodes in the law of the integrated input in a row of each
    world, shape (worlds,).
    """
    order = np.argsort(world, kind="stable")
    occupied, first = np.unique(world[order], return_index=True)
    sorted_rows = log_likelihood[order]
    top = np.maximum.reduceat(sorted_rows, first, axis=0)
    level = np.where(np.isfinite(top), top, 0.0)
    count = np.diff(np.append(first, len(world)))
    numbers = np.exp(sorted_rows - np.repeat(level, count, axis=0))
    sums = np.add.reduceat(numbers, first, axis=0)
    log_mean, nodes = np.full((worlds, log_likelihood.shape[1]), -np.inf), np.ones(worlds)
    with np.errstate(divide="ignore"):
        log_mean[occupied] = np.log(sums / count[:, None]) + level
    joint = top + log_share
    highest = joint.max(axis=1, keepdims=True)
    worth = np.exp(joint - np.where(np.isfinite(highest), highest, 0.0))
    numbers *= np.repeat(worth, count, axis=0)
    total, squares = numbers.sum(axis=1), np.einsum("ij,ij->i", numbers, numbers)
    of_rows = total**3 / np.maximum(squares, 1e-300)
    nodes[occupied] = np.add.reduceat(of_rows, first) / np.maximum(
        np.add.reduceat(total, first), 1e-300
    )
    return log_mean, nodes
