"""Probabilities of the cells of a grid, of densities known at one value in each.

The density times the width of a cell takes its curvature for nothing: with eight cells across a
law that alone moves a probability of 0.2 by 0.0007.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import special

from uq.contract import Floats
from uq.learning.evidence import QuadratureGrid, centres

Places = NDArray[np.intp]

_WIDE, _MOST = 0.05, 0.3
_STEEPEST = 3.0
_TINY = 1e-300


def masses(grid: QuadratureGrid, edges: Floats, worth: Floats) -> Floats:
    """Return the probability of each cell, to second order in its width as normal scores.

    Parameters
    ----------
    grid : QuadratureGrid
    edges : ndarray, shape (n, g + 1)
        Between which probabilities each cell stands in each row (`cell_ends.edges_of_rows`).
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
    # Of a smooth density, the sum over cells is right without: what some gain, others lose.
    mass *= worth.sum(axis=1, keepdims=True) / np.maximum(mass.sum(axis=1, keepdims=True), _TINY)
    row, cell = np.nonzero(np.diff(edges) != width)
    mass[row, cell] = _of_moved(edges, grid.edges, middle, density, row, cell)
    return mass


def _curvature(width: Floats, middle: Floats, density: Floats) -> Floats:
    """Return by which share the mean of the density over inner cells exceeds that at its centre.

    Nothing where a neighbour is impossible, nor where a cell reaches far into a tail.
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
    """Return the probabilities of cells whose edges moved, as of exponential densities."""
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
    # Of a row narrower than centres are apart, one is met as rarely: right in the mean over rows.
    apart = np.gradient(centres(old))[cell]
    length = np.where(alone, np.maximum(end - start, apart), end - start)
    return np.asarray(here * length * np.exp(moved) * (1 + half**2 / 6))
