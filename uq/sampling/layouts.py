"""Grouping of the rows of a design, as its sensitivity methods need it.

Rows of a random model that a design compares with each other share a seed: their difference is then
the effect of the input at that seed, not of noise.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Places = NDArray[np.int64]
Rule = Callable[[Places, Places, tuple[str, ...]], tuple[Places, Places]]
"""Group and block of rows, and the labels of the blocks -> group and block of the row whose seed
they take."""

NOISE = "noise"
"""The block of a crossed design of a random model that has the inputs of A and the seed of B."""


@dataclass(frozen=True)
class Layout:
    """Grouping of the rows of a design.

    Attributes
    ----------
    group : tuple of str
        Name of the unit that estimates use, singular and plural: "only 3 *whole paths*".
    labels : callable
        ``labels(parameters, second_order, random)`` -> the names of the blocks of rows, in order.
    shared_seeds : callable
        Which rows of a random model share a seed; see `Rule`.
    one_at_a_time : bool
        Whether each row of a group differs from the one before it in one input.
    by_block : bool
        Whether the rows of one block are a group, instead of one row of each.
    given_the_rest : bool
        Whether inputs that depend on each other are drawn, once they have changed, given those that
        have not (`uq.sampling.conditional_draws`).
    """

    group: tuple[str, str]
    labels: Callable[[tuple[str, ...], bool, bool], tuple[str, ...]]
    shared_seeds: Rule
    one_at_a_time: bool = False
    by_block: bool = False
    given_the_rest: bool = False


def own_seeds(group: Places, block: Places, labels: tuple[str, ...]) -> tuple[Places, Places]:
    """Give each row a seed of its own."""
    return group, block


def _of_ends(group: Places, block: Places, labels: tuple[str, ...]) -> tuple[Places, Places]:
    """Give A and its mixtures the seed of A; the other blocks, noise included, the seed of B.

    First-order and second-order indices are products of rows of both sides, total ones differences
    of rows of one.
    """
    of_a = np.array([label == "A" or label.startswith("AB_") for label in labels])
    return group, np.where(of_a[block], labels.index("A"), labels.index("B"))


def _of_groups(group: Places, block: Places, labels: tuple[str, ...]) -> tuple[Places, Places]:
    """Give all rows of a path or trajectory the seed of its first."""
    return group, np.zeros_like(block)


def _of_curves(group: Places, block: Places, labels: tuple[str, ...]) -> tuple[Places, Places]:
    """Give all points of a curve, which is a block, the seed of its first."""
    return np.zeros_like(group), block


def _crossed(parameters: tuple[str, ...], second_order: bool, random: bool) -> tuple[str, ...]:
    mirrored = [f"BA_{name}" for name in parameters] if second_order else []
    noise = [NOISE] if random else []
    return ("A", *(f"AB_{name}" for name in parameters), *mirrored, "B", *noise)


PLAIN = Layout(("row with a value", "rows with a value"), lambda *_: ("sample",), own_seeds)
CROSSED = Layout(("whole group", "whole groups"), _crossed, _of_ends)
TRAJECTORIES = Layout(
    ("whole trajectory", "whole trajectories"),
    lambda parameters, *_: tuple(f"step_{i}" for i in range(len(parameters) + 1)),
    _of_groups,
    one_at_a_time=True,
)
PATHS = Layout(
    ("whole path", "whole paths"),
    lambda parameters, *_: ("A", *(f"AB_{i}" for i in range(1, len(parameters))), "B"),
    _of_groups,
    one_at_a_time=True,
    given_the_rest=True,
)
CURVES = Layout(
    ("whole curve", "whole curves"),
    lambda parameters, *_: tuple(f"curve_{name}" for name in parameters),
    _of_curves,
    by_block=True,
)
