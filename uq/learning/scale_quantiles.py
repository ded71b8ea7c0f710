"""Quantiles of the integrated input in each row, of its law given the inspections."""

import numpy as np

from uq.contract import Floats
from uq.learning.cell_masses import Places

_GOLDEN = (5**0.5 - 1) / 2
_LEAST = 2.0**-53
_FLAT, _MOST_TILT = 1e-6, 30.0


def prior_places(edges: Floats, worth: Floats, at: Floats) -> Floats:
    """Return prior probabilities of quantiles of the integrated input given the inspections.

    Parameters
    ----------
    edges : ndarray, shape (n, g + 1)
        The prior probabilities between which each of its values stands, in each row.
    worth : ndarray, shape (n, g)
        The probability of each value (`cell_masses.masses`).
    at : ndarray, shape (n, q)
        The probabilities of the quantiles of each row.

    Returns
    -------
    ndarray, shape (n, q)
    """
    above, row = np.cumsum(worth, axis=1), np.arange(len(worth))[:, None]
    total = above[:, -1:]
    with np.errstate(divide="ignore", invalid="ignore"):
        share = np.where(total > 0, above / total, 1.0)
        # One search for all rows, each a step higher than the row before.
        node = np.searchsorted((share + row).ravel(), at + row) - row * worth.shape[1]
        node = node.clip(0, worth.shape[1] - 1)
        here = worth[row, node]
        within = (at * total - (above[row, node] - here)) / here
    within = _tilted(np.nan_to_num(within).clip(0.0, 1.0), edges, worth, row, node)
    start = edges[row, node]
    places = start + within * (edges[row, node + 1] - start)
    return np.where(total > 0, places.clip(_LEAST, 1 - _LEAST), at)


def in_order(count: int) -> Floats:
    """Return numbers between 0 and 1, of which any successive ones are spread evenly."""
    return np.asarray(np.modf((np.arange(count) + 1) * _GOLDEN)[0])


def in_order_of_weight(weights: Floats) -> Floats:
    """Return numbers between 0 and 1, spread evenly over the rows that count, shape (n,)."""
    numbers = np.empty(len(weights))
    numbers[np.argsort(-weights, kind="stable")] = in_order(len(weights))
    return numbers


def _tilted(within: Floats, edges: Floats, worth: Floats, row: Places, node: Places) -> Floats:
    """Return places within nodes, 0 to 1, drawn to the side on which the density is higher.

    Where a neighbour is impossible, the slope is that to the other.
    """
    sides = [np.clip(node + step, 0, worth.shape[1] - 1) for step in (-1, 1)]
    low, high = (np.where(worth[row, side] > 0, side, node) for side in sides)
    lengths, middles = zip(*(_length_and_middle(edges, row, i) for i in (low, high)), strict=True)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        ratio = (worth[row, high] / worth[row, low]) * (lengths[0] / lengths[1])
        rise = np.log(ratio) / (middles[1] - middles[0])
        wide = edges[row, node + 1] - edges[row, node]
        tilt = (wide * rise).clip(-_MOST_TILT, _MOST_TILT)
        moved = np.log1p(within * np.expm1(tilt)) / tilt
    return np.where(np.isfinite(tilt) & (np.abs(tilt) > _FLAT), moved, within)


def _length_and_middle(edges: Floats, row: Places, node: Places) -> tuple[Floats, Floats]:
    low, high = edges[row, node], edges[row, node + 1]
    return high - low, (high + low) / 2
