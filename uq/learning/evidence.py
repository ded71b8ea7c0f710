"""What inspections say of worlds, of the scale of lives in them, and of rows as inspected units.

A world is what all units share: a sample, or all rows where only the integrated scale is shared.
Each inspected unit takes rows of its own in each world, so that the product over units of the means
of their likelihoods estimates the evidence of a world without bias.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import special

from uq.contract import Floats

Likelihood = Callable[[Floats], Floats]
"""``likelihood(values)``: logarithm of the likelihood of all inspections of a unit, of shape
(m, g), were it each of its m rows with each of the g values of the integrated input."""

FINEST = 1e-9
"""Share of the posterior that the grid of the integrated input may leave out on each side."""

_NODES = 64
_PASSES = 6


class Grid(NamedTuple):
    """Values of an integrated input of equal prior probability.

    Attributes
    ----------
    low, high : float
        Its probabilities at the ends.
    values : ndarray, shape (g,)
    """

    low: float
    high: float
    values: Floats


@dataclass(frozen=True)
class Evidence:
    """What is learnt of worlds and of the integrated input in them.

    Attributes
    ----------
    log_worlds : ndarray, shape (w, g)
        Logarithm of the posterior probability of each world and value; the sum is 1.
    log_units : ndarray, shape (i, w, g)
        Logarithm of the mean likelihood of each inspected unit.
    log_evidence : float
        Logarithm of the probability of all inspections.
    grid : Grid
    """

    log_worlds: Floats
    log_units: Floats
    log_evidence: float
    grid: Grid


def weigh(
    likelihoods: Sequence[Likelihood],
    world_of: Sequence[NDArray[np.intp]],
    worlds: int,
    quantiles: Callable[[Floats], Floats] | None,
) -> Evidence:
    """Return what inspections say.

    Parameters
    ----------
    likelihoods : sequence of callable
        Of each inspected unit.
    world_of : sequence of ndarray of int, shape (m,)
        The world of each row that stands for each inspected unit.
    worlds : int
    quantiles : callable, optional
        Values of the integrated input at given probabilities; None if there is none.

    Returns
    -------
    Evidence
    """
    low, high = 0.0, 1.0
    for _ in range(_PASSES if quantiles else 1):
        grid = _grid(low, high, quantiles)
        units = np.array(
            [
                _mean_likelihood(one(grid.values), world, worlds)
                for one, world in zip(likelihoods, world_of, strict=True)
            ]
        ).reshape(len(likelihoods), worlds, len(grid.values))
        log_worlds = units.sum(axis=0) + np.log((high - low) / len(grid.values) / worlds)
        total = float(special.logsumexp(log_worlds))
        if not quantiles or not np.isfinite(total):
            break
        share = np.exp(special.logsumexp(log_worlds, axis=0) - total)
        narrower = _where(share, low, high)
        if narrower[1] - narrower[0] > 0.5 * (high - low):
            break
        low, high = narrower
    with np.errstate(invalid="ignore"):
        log_worlds = log_worlds - total
    return Evidence(log_worlds, units, total, grid)


def _grid(low: float, high: float, quantiles: Callable[[Floats], Floats] | None) -> Grid:
    if quantiles is None:
        return Grid(0.0, 1.0, np.ones(1))
    middle = low + (high - low) * (np.arange(_NODES) + 0.5) / _NODES
    return Grid(low, high, quantiles(middle))


def _where(share: Floats, low: float, high: float) -> tuple[float, float]:
    """Return the part of the grid, one node wider on each side, with nearly all probability."""
    below, above = np.cumsum(share), np.cumsum(share[::-1])
    first = max(int(np.searchsorted(below, FINEST)) - 1, 0)
    last = len(share) - max(int(np.searchsorted(above, FINEST)) - 1, 0)
    width = (high - low) / len(share)
    return low + first * width, low + last * width


def _mean_likelihood(log_likelihood: Floats, world: NDArray[np.intp], worlds: int) -> Floats:
    """Return the logarithm of the mean over the rows of each world, shape (worlds, g)."""
    order = np.argsort(world, kind="stable")
    there, first = np.unique(world[order], return_index=True)
    sorted_rows = log_likelihood[order]
    top = np.maximum.reduceat(sorted_rows, first, axis=0)
    level = np.where(np.isfinite(top), top, 0.0)
    count = np.diff(np.append(first, len(world)))
    sums = np.add.reduceat(np.exp(sorted_rows - np.repeat(level, count, axis=0)), first, axis=0)
    found = np.full((worlds, log_likelihood.shape[1]), -np.inf)
    with np.errstate(divide="ignore"):
        found[there] = np.log(sums / count[:, None]) + level
    return found
