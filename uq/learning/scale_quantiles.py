"""Quantiles of the integrated input in each row, of its law given the inspections."""

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.learning.evidence import Grid

_GOLDEN = (5**0.5 - 1) / 2
_TINY = 2.0**-53
_FLAT, _STEEPEST = 1e-6, 30.0


def prior_places(grid: Grid, worth: Floats, at: Floats) -> Floats:
    """Return prior probabilities of quantiles of the integrated input given the inspections.

    Parameters
    ----------
    grid : Grid
    worth : ndarray, shape (n, g)
    at : ndarray, shape (q, n)
        The probabilities of the quantiles of each row.

    Returns
    -------
    ndarray, shape (q, n)
    """
    above = np.cumsum(worth, axis=1)
    return np.stack([_place(grid, worth, above, one) for one in at])


def _place(grid: Grid, worth: Floats, above: Floats, at: Floats) -> Floats:
    wanted = at * above[:, -1]
    node = np.minimum((above < wanted[:, None]).sum(axis=1), worth.shape[1] - 1)
    here = np.arange(len(worth)), node
    with np.errstate(divide="ignore", invalid="ignore"):
        within = (wanted - (above[here] - worth[here])) / worth[here]
    within = _tilted(np.nan_to_num(within).clip(0.0, 1.0), grid, worth, node)
    edges = grid.edges
    places = edges[node] + within * (edges[node + 1] - edges[node])
    return np.where(above[:, -1] > 0, places.clip(_TINY, 1 - _TINY), at)


def in_order(count: int) -> Floats:
    """Return numbers between 0 and 1, of which any successive ones are spread evenly."""
    return np.asarray(np.modf((np.arange(count) + 1) * _GOLDEN)[0])


def in_order_of_weight(weights: Floats) -> Floats:
    """Return numbers between 0 and 1, spread evenly over the rows that count, shape (n,)."""
    found = np.empty(len(weights))
    found[np.argsort(-weights, kind="stable")] = in_order(len(weights))
    return found


def _tilted(within: Floats, grid: Grid, worth: Floats, node: NDArray[np.intp]) -> Floats:
    """Return places within nodes, 0 to 1, drawn to the side on which the density is higher.

    By half its slope: evenly spread places would add the variance of a node to that of the density,
    of which the values at the middles of nodes, equally spaced, have all.
    """
    middle = (grid.edges[1:] + grid.edges[:-1]) / 2
    low, high = np.maximum(node - 1, 0), np.minimum(node + 1, len(middle) - 1)
    row = np.arange(len(worth))
    with np.errstate(divide="ignore", invalid="ignore"):
        below, above = (np.log(worth[row, i]) - grid.log_share[i] for i in (low, high))
        rise = (above - below) / (middle[high] - middle[low])
        tilt = (np.diff(grid.edges)[node] * rise / 2).clip(-_STEEPEST, _STEEPEST)
        moved = np.log1p(within * np.expm1(tilt)) / tilt
    return np.where(np.isfinite(tilt) & (np.abs(tilt) > _FLAT), moved, within)
