"""Inspections that contradict a result, or each other, where no row agrees with all of them."""

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
    is_own: bool,
) -> list[str]:
    """Return messages that name the smallest set of inspections with which no row agrees.

    Single inspections, else pairs of one unit, else all of a unit, else those of two units that
    share a world or an integrated input.

    Parameters
    ----------
    likelihoods : UnitLikelihoods
    labels : sequence of str
        Of the inspected units.
    grids : sequence of QuadratureGrid
        Of each.
    world : ndarray of int, shape (n,)
        Of each row.
    is_own : bool
        Whether each unit has an integrated input of its own.
    """
    agree = [
        {
            inspection: likelihoods.of_inspection(inspection, unit, grid.values) > -np.inf
            for inspection in inspections
        }
        for unit, (grid, inspections) in enumerate(zip(grids, likelihoods.inspections, strict=True))
    ]
    for search in (_single, _pairs):
        if messages := [line for unit in agree for line in search(unit)]:
            return messages
    together = [np.logical_and.reduce(list(unit.values())) for unit in agree]
    if messages := [
        f"unit {label}: {_WHOLE} all its inspections"
        f" ({choices([inspection.where for inspection in unit])})"
        for label, unit, rows in zip(labels, agree, together, strict=True)
        if not rows.any()
    ]:
        return messages
    worlds = [
        _worlds(rows, world[block], int(world.max()) + 1, is_own)
        for rows, block in zip(together, likelihoods.blocks, strict=True)
    ]
    pairs = combinations(zip(labels, agree, worlds, strict=True), 2)
    return [
        f"units {a} and {b}: {_WHOLE} the inspections of both"
        f" ({choices([inspection.where for inspection in (*first, *second)])})"
        for (a, first, of_a), (b, second, of_b) in pairs
        if not (of_a & of_b).any()
    ] or [f"{_WHOLE} the inspections"]


def _single(agree: dict[Inspection, Mask]) -> Iterator[str]:
    for inspection, rows in agree.items():
        if not rows.any():
            yield f"{_described(inspection)}: {_WHOLE} it"


def _pairs(agree: dict[Inspection, Mask]) -> Iterator[str]:
    for (inspection, first), (other, second) in combinations(agree.items(), 2):
        if not (first & second).any():
            yield f"{_described(inspection)} and {_described(other)}: {_WHOLE} both"


def _described(inspection: Inspection) -> str:
    return f"{inspection.where} (unit {inspection.unit}, {inspection.output}, {inspection.kind})"


def _worlds(rows: Mask, world: NDArray[np.intp], count: int, is_own: bool) -> Mask:
    """Return in which worlds, with which values of an input that all share, some row agrees."""
    agreeing = np.zeros((count, rows.shape[1]), dtype=bool)
    np.logical_or.at(agreeing, world, rows)
    return np.asarray(agreeing.any(axis=1, keepdims=True)) if is_own else agreeing
