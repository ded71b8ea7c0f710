"""Evidence of inspections for worlds, for an input that scales lives in them, and for units.

A world is what all units share: a sample, or all rows where nothing is shared but the integrated
input. Each inspected unit takes rows of its own in each world, so that the product over units of
the means of their likelihoods estimates the evidence of a world without bias.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import special

from uq.contract import Floats

Likelihood = Callable[[Floats], Floats]
"""``likelihood(values)``: logarithm of the likelihood of all inspections of a unit, of shape
(m, g), were it each of its m rows with each of the g values of the integrated input."""

Quantiles = Callable[[Floats], Floats]

FINEST = 1e-9
"""Share of the posterior that the grid of the integrated input may leave out on each side."""

_NODES = 64
_MOST_NODES = 512
_FINE = 8.0
"""Nodes that share the law of the integrated input in a row, at least."""

_MET = 2.0
"""Fewer leave out rows."""

_FAR = 7.5
_PASSES = 8


class QuadratureGrid(NamedTuple):
    """Values of an integrated input, evenly spread in probability, and in the tails in score.

    Attributes
    ----------
    edges : ndarray, shape (g + 1,)
        The prior probabilities between which each value lies.
    values : ndarray, shape (g,)
    log_share : ndarray, shape (g,)
        Logarithm of the prior probability of each value.
    """

    edges: Floats
    values: Floats
    log_share: Floats

    @property
    def low(self) -> float:
        """The lower end, a prior probability."""
        return float(self.edges[0])

    @property
    def high(self) -> float:
        """The upper end."""
        return float(self.edges[-1])


@dataclass(frozen=True)
class Evidence:
    """Posterior of worlds, and of the integrated input in them, with the log evidence.

    Attributes
    ----------
    log_worlds : ndarray, shape (w, g)
        Logarithm of the posterior probability of each world, and of each value of an integrated
        input that all its units share (else g is 1); the sum of the probabilities is 1.
    rest : tuple of ndarray, shape (w, g)
        For each inspected unit the same without its own likelihood, not normalised.
    log_evidence : float
        Logarithm of the probability of all inspections.
    grids : tuple of QuadratureGrid
        Of each inspected unit.
    nodes : float
        How many values share the law of an integrated input in a row, in the unit of the fewest.
    """

    log_worlds: Floats
    rest: tuple[Floats, ...]
    log_evidence: float
    grids: tuple[QuadratureGrid, ...]
    nodes: float = np.inf


def weigh(
    likelihoods: Sequence[Likelihood],
    world_of: Sequence[NDArray[np.intp]],
    worlds: int,
    quantiles: Quantiles | None,
    is_own: bool,
) -> Evidence:
    """Return the evidence of the inspections, on a refined grid.

    Parameters
    ----------
    likelihoods : sequence of callable
        Of each inspected unit.
    world_of : sequence of ndarray of int, shape (m,)
        The world of each row that stands for each inspected unit.
    worlds : int
    quantiles : callable, optional
        Values of the integrated input at given probabilities; None if there is none.
    is_own : bool
        Whether each unit has an integrated input of its own.

    Returns
    -------
    Evidence
    """
    grids = [_grid(0.0, 1.0, quantiles, _NODES)] * len(likelihoods)
    nodes = _NODES
    for _ in range(_PASSES):
        units, evidence = weigh_on(grids, likelihoods, world_of, worlds, is_own)
        if quantiles is None or not np.isfinite(evidence.log_evidence):
            break
        narrower = [
            _narrower(*arguments) for arguments in zip(grids, units, evidence.rest, strict=True)
        ]
        if not is_own:
            narrower = narrower[:1] * len(grids)
        if evidence.nodes < _MET and nodes < _MOST_NODES:
            # Values that no row has met may be possible: finer before narrower.
            narrower, nodes = [(grid.low, grid.high) for grid in grids], nodes * 2
        elif not any(_is_much(*both) for both in zip(narrower, grids, strict=True)):
            if nodes == _MOST_NODES or evidence.nodes >= _FINE:
                break
            nodes *= 2
        grids = [_grid(low, high, quantiles, nodes) for low, high in narrower]
    return evidence


def weigh_on(
    grids: Sequence[QuadratureGrid],
    likelihoods: Sequence[Likelihood],
    world_of: Sequence[NDArray[np.intp]],
    worlds: int,
    is_own: bool,
) -> tuple[list[Floats], Evidence]:
    """Return the mean likelihoods of units on given grids, and their evidence; see `weigh`."""
    units, nodes = [], []
    for likelihood, world, grid in zip(likelihoods, world_of, grids, strict=True):
        mean, of_world = _mean_likelihood(likelihood(grid.values), world, worlds, grid.log_share)
        units.append(mean)
        nodes.append(of_world)
    evidence = (_per_unit if is_own else _shared)(units, grids, worlds)
    if not np.isfinite(evidence.log_evidence):
        return units, evidence
    worth = np.exp(evidence.log_worlds)
    share = worth.sum(axis=1)
    if not is_own:
        nodes.append(share**2 / np.maximum((worth**2).sum(axis=1), 1e-300))
    fewest = [float(np.average(counts[share > 0], weights=share[share > 0])) for counts in nodes]
    return units, replace(evidence, nodes=min(fewest))


def _grid(low: float, high: float, quantiles: Quantiles | None, nodes: int) -> QuadratureGrid:
    if quantiles is None:
        return QuadratureGrid(np.array([0.0, 1.0]), np.ones(1), np.zeros(1))
    first, last = _scores(low, high)
    scores = np.linspace(first, last, nodes + 1)[1:-1]
    return _joined([np.linspace(low, high, nodes + 1), special.ndtr(scores)], quantiles)


def _scores(low: float, high: float) -> Floats:
    """Return normal scores of probabilities, finite."""
    return np.asarray(special.ndtri(np.array([low, high])).clip(-_FAR, _FAR))


def _joined(parts: Sequence[Floats], quantiles: Quantiles) -> QuadratureGrid:
    """Return the grid whose values lie between some probabilities."""
    edges = np.unique(np.concatenate(parts))
    return QuadratureGrid(edges, quantiles(centres(edges)), np.log(np.diff(edges)))


def centres(edges: Floats) -> Floats:
    """Return the probabilities of the mean normal score between some probabilities."""
    scores = special.ndtri(edges)
    width, middle = np.diff(scores), (scores[1:] + scores[:-1]) / 2
    with np.errstate(invalid="ignore"):
        narrow = middle * (1 - width**2 / 12)
    density = np.exp(-(scores**2) / 2) / np.sqrt(2 * np.pi)
    return np.asarray(
        special.ndtr(np.where(width < 0.1, narrow, -np.diff(density) / np.diff(edges)))
    )


def wide(grid: QuadratureGrid, quantiles: Quantiles | None) -> QuadratureGrid:
    """Return a grid from end to end of the prior that is as fine as another where that is."""
    if quantiles is None:
        return grid
    outside = np.linspace(0.0, grid.low, _NODES // 2), np.linspace(grid.high, 1.0, _NODES // 2)
    return _joined([outside[0], grid.edges, outside[1]], quantiles)


def _shared(units: Sequence[Floats], grids: Sequence[QuadratureGrid], worlds: int) -> Evidence:
    log_worlds, rest = _with_all_but_each(units, grids[0].log_share, worlds)
    return _evidence(log_worlds, rest, grids)


def _per_unit(units: Sequence[Floats], grids: Sequence[QuadratureGrid], worlds: int) -> Evidence:
    of_unit = [
        special.logsumexp(log_likelihood + grid.log_share, axis=1, keepdims=True)
        for log_likelihood, grid in zip(units, grids, strict=True)
    ]
    log_worlds, rest = _with_all_but_each(of_unit, np.zeros(1), worlds)
    rest = [log_rest + grid.log_share for log_rest, grid in zip(rest, grids, strict=True)]
    return _evidence(log_worlds, rest, grids)


def _with_all_but_each(
    units: Sequence[Floats], log_share: Floats, worlds: int
) -> tuple[Floats, list[Floats]]:
    """Return logarithms of products with the prior, of all units and of all but each."""
    impossible = [np.isneginf(log_likelihood) for log_likelihood in units]
    finite = [
        np.where(is_so, 0.0, log_likelihood)
        for is_so, log_likelihood in zip(impossible, units, strict=True)
    ]
    count, total = np.sum(impossible, axis=0), np.sum(finite, axis=0) + log_share - np.log(worlds)
    rest = [
        np.where(count > is_so, -np.inf, total - log_likelihood)
        for is_so, log_likelihood in zip(impossible, finite, strict=True)
    ]
    return np.where(count > 0, -np.inf, total), rest


def _evidence(
    log_worlds: Floats, rest: Sequence[Floats], grids: Sequence[QuadratureGrid]
) -> Evidence:
    total = float(special.logsumexp(log_worlds))
    if np.isfinite(total):
        log_worlds = log_worlds - total
    return Evidence(log_worlds, tuple(rest), total, tuple(grids))


def _narrower(grid: QuadratureGrid, log_unit: Floats, rest: Floats) -> tuple[float, float]:
    """Return the part of the grid, one node wider on each side, with nearly all probability."""
    share = special.logsumexp(log_unit + rest, axis=0)
    share = np.exp(share - special.logsumexp(share))
    below, above = np.cumsum(share), np.cumsum(share[::-1])
    first = max(int(np.searchsorted(below, FINEST)) - 1, 0)
    last = len(share) - max(int(np.searchsorted(above, FINEST)) - 1, 0)
    return float(grid.edges[first]), float(grid.edges[last])


def _is_much(ends: tuple[float, float], grid: QuadratureGrid) -> bool:
    """Return whether the part is half the grid or less: its middle, or its tails."""
    middle = ends[1] - ends[0] <= 0.5 * (grid.high - grid.low)
    return middle or bool(np.ptp(_scores(*ends)) <= 0.5 * np.ptp(_scores(grid.low, grid.high)))


def _mean_likelihood(
    log_likelihood: Floats, world: NDArray[np.intp], worlds: int, log_share: Floats
) -> tuple[Floats, Floats]:
    """Return the logarithm of the mean over the rows of each world, shape (worlds, g).

    With it how many nodes share the law of the integrated input in a row of each, shape (worlds,).
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
