"""Inspections that contradict a result, or each other, where no row agrees with all of them."""

from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from uq.contract import Mask
from uq.errors import choices
from uq.learning.evidence import QuadratureGrid
from uq.learning.inspections import Inspection
from uq.learning.unit_likelihood import UnitLikelihoods

_WHOLE = "no row of this result agrees with"


def contradictions(likelihoods: UnitLikelihoods, grids: Sequence[QuadratureGrid]) -> list[str]:
    """Return messages that name the smallest set of inspections with which no row agrees.

    Single inspections, else pairs of one unit, else all of a unit, else those of two units that
    share a world or an integrated input.

    Parameters
    ----------
    likelihoods : UnitLikelihoods
    grids : sequence of QuadratureGrid
        Of each inspected unit.
    """
    agree = [
        {
            inspection: likelihoods.of_inspection(inspection, unit, grid.values) > -np.inf
            for inspection in inspections
        }
        for unit, (grid, inspections) in enumerate(zip(grids, likelihoods.inspections, strict=True))
    ]
    for size, all_of_them in ((1, "it"), (2, "both")):
        if messages := [
            f"{' and '.join(map(_described, chosen))}: {_WHOLE} {all_of_them}"
            for unit in agree
            for chosen in combinations(unit, size)
            if not _agreeing(unit, chosen).any()
        ]:
            return messages
    together = [_agreeing(unit, unit) for unit in agree]
    if messages := [
        f"unit {label}: {_WHOLE} all its inspections"
        f" ({choices([inspection.where for inspection in unit])})"
        for label, unit, rows in zip(likelihoods.labels, agree, together, strict=True)
        if not rows.any()
    ]:
        return messages
    worlds = [
        _agreeing_worlds(rows, block, likelihoods)
        for rows, block in zip(together, likelihoods.blocks, strict=True)
    ]
    pairs = combinations(zip(likelihoods.labels, agree, worlds, strict=True), 2)
    return [
        f"units {a} and {b}: {_WHOLE} the inspections of both"
        f" ({choices([inspection.where for inspection in (*first, *second)])})"
        for (a, first, of_a), (b, second, of_b) in pairs
        if not (of_a & of_b).any()
    ] or [f"{_WHOLE} the inspections"]


def _agreeing(agree: Mapping[Inspection, Mask], chosen: Iterable[Inspection]) -> Mask:
    """Return which rows agree with all chosen inspections of a unit, shape (rows, g)."""
    return np.logical_and.reduce([agree[inspection] for inspection in chosen])


def _described(inspection: Inspection) -> str:
    return f"{inspection.where} (unit {inspection.unit}, {inspection.output}, {inspection.kind})"


def _agreeing_worlds(rows: Mask, block: NDArray[np.intp], likelihoods: UnitLikelihoods) -> Mask:
    """Return in which worlds, with which values of an input that all share, some row agrees."""
    agreeing = np.zeros((likelihoods.worlds, rows.shape[1]), dtype=bool)
    np.logical_or.at(agreeing, likelihoods.world[block], rows)
    shared = likelihoods.shares_scale
    return agreeing if shared else np.asarray(agreeing.any(axis=1, keepdims=True))
