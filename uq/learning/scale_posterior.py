"""Posterior of the integrated input in each row: probabilities of cells, and quantiles."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy import special

from uq.assess.scale_laws import SCORES, terms
from uq.contract import Floats, Mask
from uq.learning.evidence import Evidence, QuadratureGrid, centres

_HALVINGS = 12

Allowed = Callable[[Floats], Mask]
"""``allowed(places)``: whether inspections allow, in each row, the value at a prior probability,
shape (n,)."""

Places = NDArray[np.intp]

_WIDE, _MOST = 0.05, 0.3
_STEEPEST = 3.0
_TINY = 1e-300

_GOLDEN = (5**0.5 - 1) / 2
_LEAST = 2.0**-53
_FLAT, _MOST_TILT = 1e-6, 30.0


def edges_of_rows(grid: QuadratureGrid, possible: Mask, allowed: Allowed | None) -> Floats:
    """Return the cell edges of the grid in each row, as prior probabilities.

    A unit observed running has a left-truncated posterior: the first allowed cell of a row starts
    at the truncation point, which differs between rows.

    Parameters
    ----------
    grid : QuadratureGrid
    possible : ndarray of bool, shape (n, g)
        Whether inspections allow each value.
    allowed : callable, optional

    Returns
    -------
    ndarray, shape (n, g + 1)
    """
    if allowed is None or possible.all():
        return np.broadcast_to(grid.edges, (len(possible), len(grid.edges)))
    edges, middle = np.repeat(grid.edges[None], len(possible), axis=0), centres(grid.edges)
    feasible, last = possible.any(axis=1), possible.shape[1] - 1
    first, final = possible.argmax(axis=1), last - possible[:, ::-1].argmax(axis=1)
    for node, beyond, edge in ((first, first - 1, first), (final, final + 1, final + 1)):
        cut = feasible & (beyond >= 0) & (beyond <= last)
        if cut.any():
            inside, outside = middle[node], middle[np.clip(beyond, 0, last)]
            for _ in range(_HALVINGS):
                between = (inside + outside) / 2
                is_inside = allowed(between)
                inside = np.where(is_inside, between, inside)
                outside = np.where(is_inside, outside, between)
            edges[cut, edge[cut]] = inside[cut]
    return edges


def masses(grid: QuadratureGrid, edges: Floats, worth: Floats) -> Floats:
    """Return the probability of each cell, accurate to second order in its normal-score width.

    Parameters
    ----------
    grid : QuadratureGrid
    edges : ndarray, shape (n, g + 1)
        Cell edges of each row, as prior probabilities (`edges_of_rows`).
    worth : ndarray, shape (n, g)
        The density at the centre of each cell of the grid, times the width of that cell.

    Returns
    -------
    ndarray, shape (n, g)
    """
    if worth.shape[1] == 1:
        return worth
    mass, middle = worth.copy(), special.ndtri(centres(grid.edges))
    width = np.diff(grid.edges)
    density = worth / width
    mass[:, 1:-1] *= 1 + _curvature(np.diff(special.ndtri(grid.edges)), middle, density)
    # For a smooth density the corrections cancel in the sum over cells.
    mass *= worth.sum(axis=1, keepdims=True) / np.maximum(mass.sum(axis=1, keepdims=True), _TINY)
    row, cell = np.nonzero(np.diff(edges) != width)
    mass[row, cell] = _of_moved(edges, grid.edges, middle, density, row, cell)
    return mass


def _curvature(width: Floats, middle: Floats, density: Floats) -> Floats:
    """Return the relative excess of the cell mean of the density over its centre value.

    Only for inner cells; zero where a neighbour is impossible or a cell reaches far into a tail.
    """
    variance = width[1:-1] ** 2 / 12
    variance = np.where(variance < _WIDE, variance, 0.0)
    before, after = np.diff(middle)[:-1], np.diff(middle)[1:]
    low, here, high = density[:, :-2], density[:, 1:-1], density[:, 2:]
    curved = 2 * ((high - here) / after - (here - low) / before) / (before + after)
    with np.errstate(divide="ignore", invalid="ignore", over="ignore"):
        more = np.where((low > 0) & (high > 0), variance * curved / (2 * here), 0.0)
    return np.asarray(np.nan_to_num(more).clip(-_MOST, _MOST))


def _of_moved(
    edges: Floats, old: Floats, middle: Floats, density: Floats, row: Places, cell: Places
) -> Floats:
    """Return the probabilities of cells with moved edges, assuming an exponential density."""
    start, end = edges[row, cell], edges[row, cell + 1]
    shift = (start + end - old[cell] - old[cell + 1]) / 2
    here = density[row, cell]
    sides = [np.clip(cell + step, 0, density.shape[1] - 1) for step in (1, -1)]
    side = np.where(density[row, sides[0]] > 0, *sides)
    with np.errstate(divide="ignore", invalid="ignore"):
        slope = np.log(density[row, side] / here) / (middle[side] - middle[cell])
        slope = slope * np.sqrt(2 * np.pi) * np.exp(middle[cell] ** 2 / 2)
    alone = ~(density[row, side] > 0)
    slope = np.where(alone, 0.0, slope)
    half = np.nan_to_num(slope * (end - start) / 2).clip(-_STEEPEST, _STEEPEST)
    moved = np.nan_to_num(slope * shift).clip(-_STEEPEST, _STEEPEST)
    # A row narrower than the node spacing rarely contains a node: unbiased in the mean over rows.
    apart = np.gradient(centres(old))[cell]
    length = np.where(alone, np.maximum(end - start, apart), end - start)
    return np.asarray(here * length * np.exp(moved) * (1 + half**2 / 6))


def prior_places(edges: Floats, worth: Floats, at: Floats) -> Floats:
    """Return prior probabilities of quantiles of the integrated input given the inspections.

    Parameters
    ----------
    edges : ndarray, shape (n, g + 1)
        Cell edges of each row, as prior probabilities.
    worth : ndarray, shape (n, g)
        The probability of each cell (`masses`).
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
        # One search for all rows: each row is offset by one from the row before.
        node = np.searchsorted((share + row).ravel(), at + row) - row * worth.shape[1]
        node = node.clip(0, worth.shape[1] - 1)
        here = worth[row, node]
        within = (at * total - (above[row, node] - here)) / here
    within = _tilted(np.nan_to_num(within).clip(0.0, 1.0), edges, worth, row, node)
    start = edges[row, node]
    places = start + within * (edges[row, node + 1] - start)
    return np.where(total > 0, places.clip(_LEAST, 1 - _LEAST), at)


def in_order(count: int) -> Floats:
    """Return a low-discrepancy sequence in (0, 1): any consecutive numbers are evenly spread."""
    return np.asarray(np.modf((np.arange(count) + 1) * _GOLDEN)[0])


def in_order_of_weight(weights: Floats) -> Floats:
    """Return numbers in (0, 1), evenly spread over the rows by weight, shape (n,)."""
    numbers = np.empty(len(weights))
    numbers[np.argsort(-weights, kind="stable")] = in_order(len(weights))
    return numbers


def _tilted(within: Floats, edges: Floats, worth: Floats, row: Places, node: Places) -> Floats:
    """Return positions within cells, 0 to 1, from a linear interpolation of the density.

    Where one neighbour is impossible, the slope towards the other is used.
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


class SharedLaw(NamedTuple):
    """Posterior law of an integrated input that all units share.

    Attributes
    ----------
    share : ndarray, shape (g,)
        Probabilities of the values of the grid.
    terms : ndarray, shape (g, terms)
        Values of the terms at the grid values.
    scores : ndarray, shape (q,)
        Prior normal scores of the posterior quantiles at `SCORES`.
    """

    share: Floats
    terms: Floats
    scores: Floats


def shared_law(evidence: Evidence) -> SharedLaw:
    """Return the posterior law if each row represents every inspected unit."""
    share, edges = np.exp(evidence.log_worlds), evidence.grids[0].edges[None]
    of_cells = masses(evidence.grids[0], edges, share)
    places = prior_places(edges, of_cells, special.ndtr(SCORES)[None])[0]
    middle = np.cumsum(share[0]) - share[0] / 2
    return SharedLaw(share[0], terms(middle), special.ndtri(places))


def influence_of(unit: int, log_likelihood: Floats, evidence: Evidence, law: SharedLaw) -> Floats:
    """Return the influence of each row, as one unit, on the terms of the law, shape (n, terms).

    The sampling error of the law is the mean over rows of the sum over units.
    """
    with np.errstate(invalid="ignore"):
        log_mean = evidence.log_worlds[0] + evidence.log_evidence - evidence.rest[unit][0]
    log_rows = log_likelihood - np.where(law.share > 0, log_mean, np.inf)
    return np.asarray(np.exp(log_rows) @ (law.share[:, None] * law.terms))
