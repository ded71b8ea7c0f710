"""Levels of nested sampling: the rows of a sample that share the value of an input.

A sample consists of units, and a unit of repeats. An input on the level ``shared`` has one value in
all rows of a sample. On the level ``own`` it has one value in each unit, and on the level
``chance`` one value in each repeat.
"""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

SHARED, OWN, CHANCE = "shared", "own", "chance"

LEVELS = {
    SHARED: "one value for all units of a sample",
    OWN: "one for each unit",
    CHANCE: "anew in each repeat",
}
"""Level -> its meaning, from the outermost to the innermost."""

MAX_ROWS_OF_A_SAMPLE = 1_000_000
"""Units times repeats."""


def coordinates(levels: Sequence[str], units: int, repeats: int) -> NDArray[np.intp]:
    """Return the index of the coordinate of a sample's point for each input of its rows.

    Parameters
    ----------
    levels : sequence of str
        Level of each of the d inputs.
    units, repeats : int

    Returns
    -------
    ndarray, shape (units * repeats, d)
        The first row uses the first d coordinates, in the order of the inputs, so that a sample of
        one row is a point of the plain design. Further units, then further repeats, use the
        following coordinates.
    """
    return _coordinates(tuple(levels), units, repeats)


@lru_cache(maxsize=4)
def _coordinates(levels: tuple[str, ...], units: int, repeats: int) -> NDArray[np.intp]:
    kind = np.array(levels)
    unit_inputs, repeat_inputs = np.flatnonzero(kind == OWN), np.flatnonzero(kind == CHANCE)
    places = np.tile(np.arange(len(levels)), (units, repeats, 1))
    first, count = len(levels), (units - 1) * len(unit_inputs)
    places[1:, :, unit_inputs] = first + np.arange(count).reshape(units - 1, 1, len(unit_inputs))
    rows = places.reshape(-1, len(levels))
    first, count = first + count, (len(rows) - 1) * len(repeat_inputs)
    rows[1:, repeat_inputs] = first + np.arange(count).reshape(len(rows) - 1, len(repeat_inputs))
    rows.setflags(write=False)
    return rows


def dimension(levels: Sequence[str], units: int, repeats: int) -> int:
    """Return the number of coordinates of a sample's point."""
    per_unit, per_repeat = (sum(level == name for level in levels) for name in (OWN, CHANCE))
    return len(levels) + (units - 1) * per_unit + (units * repeats - 1) * per_repeat
