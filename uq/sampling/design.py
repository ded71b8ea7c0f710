"""A design: the points of the unit cube that a study visits."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from uq.sampling.layouts import CROSSED, PLAIN, Layout, own_seeds
from uq.sampling.unit_cube import Points

MAX_SAMPLES = 2**30
"""Points of one replicate: the 30 bits of a Sobol' sequence distinguish no more."""


@dataclass(frozen=True)
class Design:
    """One way of choosing rows.

    Attributes
    ----------
    meaning : str
        One line for a reader of the study file.
    draw : callable or None
        ``draw(seed, replicates, d, samples, start, stop)`` -> points start..stop of each replicate,
        shape (stop - start, replicates, [blocks,] d), the same bits for any start and stop.
        Replicates are independent. A crossed design draws 2 d columns. None: the rows are
        imported.
    layout : Layout
        How its rows are grouped, which decides which sensitivity methods it feeds.
    append_only : bool
        Whether the first points stay the same when more are drawn.
    power_of_two : bool
        Whether `samples` must be a power of two.
    independent : bool
        Whether rows are independent, as formulas for confidence and tolerance bounds assume.
    follows_laws : bool
        Whether the rows of a replicate, or A and B of a crossed design, follow the laws.
    least : int
        The smallest number of samples.
    nests : bool
        Whether a sample may have several rows (`uq.sampling.levels`).
    most_inputs : int or None
        Largest number of coordinates of a point, if it is limited.
    caution : str
        A sentence shown with every index from its rows, or "".
    """

    meaning: str
    draw: Callable[[int, int, int, int, int, int], Points] | None
    layout: Layout = PLAIN
    append_only: bool = True
    power_of_two: bool = False
    independent: bool = False
    follows_laws: bool = True
    least: int = 1
    nests: bool = False
    most_inputs: int | None = None
    caution: str = ""

    @property
    def imported(self) -> bool:
        """Whether its rows come from a file."""
        return self.draw is None

    @property
    def crossed(self) -> bool:
        """Whether each point gives a group of rows A, AB_1 .. AB_d, (BA_1 .. BA_d,) B."""
        return self.layout is CROSSED

    @property
    def shares_seeds(self) -> bool:
        """Whether rows of a random model share seeds."""
        return self.layout.shared_seeds is not own_seeds

    def blocks(self, d: int, second_order: bool, random: bool = False) -> int:
        """Return the number of rows in a group."""
        return len(self.layout.labels(("",) * d, second_order, random))

    def unit_rows(
        self,
        *,
        seed: int,
        replicates: int,
        d: int,
        samples: int,
        second_order: bool,
        start: int,
        stop: int,
        random: bool = False,
    ) -> Points:
        """Draw the groups start..stop of every replicate.

        Returns
        -------
        ndarray, shape (stop - start, replicates, blocks, d)
            Inside the open unit cube.
        """
        assert self.draw is not None, "imported rows are not drawn"
        if not self.crossed:
            points = self.draw(seed, replicates, d, samples, start, stop)
            return points.reshape(stop - start, replicates, self.blocks(d, False), d)
        points = self.draw(seed, replicates, 2 * d, samples, start, stop)
        return cross(points[..., :d], points[..., d:], second_order, random)

    def size_problem(self, samples: int) -> str | None:
        """Return why `samples` is not a legal size, or None."""
        if not self.least <= samples <= MAX_SAMPLES:
            return f"must be between {self.least} and {MAX_SAMPLES}"
        legal = 1 << (samples - 1).bit_length()
        if self.power_of_two and samples != legal:
            return f"must be a power of two; the next is {legal}"
        return None


def cross(a: Points, b: Points, second_order: bool, random: bool = False) -> Points:
    """Exchange the columns of two samples one at a time (Saltelli 2002), in SALib's order.

    Parameters
    ----------
    a, b : ndarray, shape (..., d)
    second_order : bool
        Whether to add the blocks BA_i.
    random : bool
        Whether to add A once more, for the noise of a random model.

    Returns
    -------
    ndarray, shape (..., blocks, d)
        A; AB_i, which is A with column i of B; BA_i, the converse; B; A.

    References
    ----------
    A. Saltelli, "Making best use of model evaluations to compute sensitivity indices",
    Comput. Phys. Commun. 145, 280-297 (2002).
    """
    one_column = np.eye(a.shape[-1], dtype=bool)
    a, b = a[..., None, :], b[..., None, :]
    blocks = [a, np.where(one_column, b, a)]
    if second_order:
        blocks.append(np.where(one_column, a, b))
    return np.concatenate([*blocks, b, *([a] * random)], axis=-2)
