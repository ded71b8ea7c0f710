"""Which inspections contradict a result, or each other, where no row agrees with all of them."""

from collections.abc import Iterator, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from uq.contract import Mask
from uq.errors import choices
from uq.learning.evidence import QuadratureGrid
from uq.learning.inspections import Inspection
from uq.learning.unit_likelihood import UnitLikelihoods

_WHOLE = "no row of this result agrees with"


def contradictions(
    likelihoods: UnitLikelihoods,
    labels: Sequence[str],
    grids: Sequence[QuadratureGrid],
    world: NDArray[np.intp],
    own: bool,
) -> list[str]:
    """Return which inspections no row agrees with: the fewest that tell.

    Single ones, else pairs of one unit, else all of a unit, else those of two units that share
    what contradicts.

    Parameters
    ----------
    likelihoods : UnitLikelihoods
    labels : sequence of str
        Of the inspected units.
    grids : sequence of QuadratureGrid
        Of each.
    world : ndarray of int, shape (n,)
        Of each row.
    own : bool
        Whether each unit has an integrated input of its own.
    """
    agree = [
        {one: likelihoods.of_one(one, unit, grid.values) > -np.inf for one in inspections}
        for unit, (grid, inspections) in enumerate(zip(grids, likelihoods.of_unit, strict=True))
    ]
    for search in (_single, _pairs):
        if found := [line for unit in agree for line in search(unit)]:
            return found
    together = [np.logical_and.reduce(list(unit.values())) for unit in agree]
    if found := [
        f"unit {label}: {_WHOLE} all its inspections ({choices([one.where for one in unit])})"
        for label, unit, rows in zip(labels, agree, together, strict=True)
        if not rows.any()
    ]:
        return found
    worlds = [
        _worlds(rows, world[block], int(world.max()) + 1, own)
        for rows, block in zip(together, likelihoods.blocks, strict=True)
    ]
    pairs = combinations(zip(labels, agree, worlds, strict=True), 2)
    return [
        f"units {a} and {b}: {_WHOLE} the inspections of both"
        f" ({choices([one.where for one in (*first, *second)])})"
        for (a, first, of_a), (b, second, of_b) in pairs
        if not (of_a & of_b).any()
    ] or [f"{_WHOLE} the inspections"]


def _single(agree: dict[Inspection, Mask]) -> Iterator[str]:
    for one, rows in agree.items():
        if not rows.any():
            yield f"{_said(one)}: {_WHOLE} it"


def _pairs(agree: dict[Inspection, Mask]) -> Iterator[str]:
    for (one, first), (other, second) in combinations(agree.items(), 2):
        if not (first & second).any():
            yield f"{_said(one)} and {_said(other)}: {_WHOLE} both"


def _said(one: Inspection) -> str:
    return f"{one.where} (unit {one.unit}, {one.output}, {one.kind})"


def _worlds(rows: Mask, world: NDArray[np.intp], count: int, own: bool) -> Mask:
    """Return in which worlds, with which values of an input that all share, some row agrees."""
    found = np.zeros((count, rows.shape[1]), dtype=bool)
    np.logical_or.at(found, world, rows)
    return np.asarray(found.any(axis=1, keepdims=True)) if own else found
