"""Ends of the values of the integrated input that inspections allow, row by row."""

from collections.abc import Callable

import numpy as np

from uq.contract import Floats, Mask
from uq.learning.evidence import QuadratureGrid, centres

_HALVINGS = 12

Allowed = Callable[[Floats], Mask]
"""``allowed(places)``: whether inspections allow, in each row, the value at a prior probability,
shape (n,)."""


def edges_of_rows(grid: QuadratureGrid, possible: Mask, allowed: Allowed | None) -> Floats:
    """Return between which prior probabilities each value of a grid stands, in each row.

    A unit that was seen running has lives from then on alone: the first value that a row allows
    begins there, rather than where others do.

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
