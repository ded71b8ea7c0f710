"""Which rows of a random model share a seed: those that its design compares with each other.

Their difference is then the effect of the input at that seed, not of noise. Each rule takes group
and block of rows, and the labels of the blocks; it returns group and block of the row whose seed
they take.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

Places = NDArray[np.int64]
Rule = Callable[[Places, Places, tuple[str, ...]], tuple[Places, Places]]


def own(group: Places, block: Places, labels: tuple[str, ...]) -> tuple[Places, Places]:
    """Give each row a seed of its own."""
    return group, block


def of_ends(group: Places, block: Places, labels: tuple[str, ...]) -> tuple[Places, Places]:
    """Give A and what is mixed into it the seed of A; the others, with the noise block, that of B.

    First-order and second-order indices are products of rows of both sides, total ones differences
    of rows of one.
    """
    of_a = np.array([label == "A" or label.startswith("AB_") for label in labels])
    return group, np.where(of_a[block], labels.index("A"), labels.index("B"))


def of_groups(group: Places, block: Places, labels: tuple[str, ...]) -> tuple[Places, Places]:
    """Give all rows of a path or trajectory the seed of its first."""
    return group, np.zeros_like(block)


def of_curves(group: Places, block: Places, labels: tuple[str, ...]) -> tuple[Places, Places]:
    """Give all points of a curve, which is a block, the seed of its first."""
    return np.zeros_like(group), block
