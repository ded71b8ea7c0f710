"""Registry of sampling designs: how each design draws its points and groups its rows.

To add a design, write a function that draws its points and add an entry here, with its properties
and the layout of its rows. The layout determines the sensitivity methods that it supports.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from uq.sampling.unit_cube import (
    LEAST_POINTS,
    MOST_OF_SOBOL,
    POOL,
    Points,
    fast_curves,
    halton,
    latin_hypercube,
    monte_carlo,
    morris_trajectories,
    paths,
    random_balance,
    sobol,
)

Places = NDArray[np.int64]
Rule = Callable[[Places, Places, tuple[str, ...]], tuple[Places, Places]]
"""Rule for shared seeds: group and block of rows, and the block labels -> group and block of the
row whose seed each row uses."""

NOISE = "noise"
"""Block of a crossed design of a random model, with the inputs of A and the seed of B."""

MAX_SAMPLES = 2**30
"""Largest number of points of one replicate, limited by the 30 bits of a Sobol' sequence."""


@dataclass(frozen=True)
class Layout:
    """Grouping of the rows of a design.

    Attributes
    ----------
    group : tuple of str
        Name of the group that estimates use, singular and plural: "only 3 *whole paths*".
    labels : callable
        ``labels(parameters, second_order, random)`` -> the names of the blocks of rows, in order.
    shared_seeds : callable
        Which rows of a random model share a seed; see `Rule`.
    one_at_a_time : bool
        Whether each row of a group differs from the previous row in one input.
    by_block : bool
        Whether the rows of one block form a group, instead of one row of each block.
    given_the_rest : bool
        Whether changed dependent inputs are drawn conditionally on the unchanged ones
        (`uq.sampling.dependence`).
    """

    group: tuple[str, str]
    labels: Callable[[tuple[str, ...], bool, bool], tuple[str, ...]]
    shared_seeds: Rule
    one_at_a_time: bool = False
    by_block: bool = False
    given_the_rest: bool = False


def own_seeds(group: Places, block: Places, labels: tuple[str, ...]) -> tuple[Places, Places]:
    """Return the group and block of each row itself: every row has its own seed."""
    return group, block


def _of_ends(group: Places, block: Places, labels: tuple[str, ...]) -> tuple[Places, Places]:
    """Return the seed rows of a crossed design: A for A and AB_i, B for all other blocks.

    First-order and second-order indices are products of rows with different seeds; total indices
    are differences of rows with the same seed.
    """
    of_a = np.array([label == "A" or label.startswith("AB_") for label in labels])
    return group, np.where(of_a[block], labels.index("A"), labels.index("B"))


def _of_groups(group: Places, block: Places, labels: tuple[str, ...]) -> tuple[Places, Places]:
    """Return the first row of each path or trajectory, whose seed all its rows share."""
    return group, np.zeros_like(block)


def _of_curves(group: Places, block: Places, labels: tuple[str, ...]) -> tuple[Places, Places]:
    """Return the first point of each curve, whose seed all its points share; a curve is a block."""
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


@dataclass(frozen=True)
class Design:
    """A sampling design.

    Attributes
    ----------
    meaning : str
        One-line description for readers of the study file.
    draw : callable or None
        ``draw(seed, replicates, d, samples, start, stop)`` -> points start..stop of each replicate,
        shape (stop - start, replicates, [blocks,] d), the same bits for any start and stop.
        Replicates are independent. A crossed design draws 2 d columns. None: the rows are
        imported.
    layout : Layout
        Grouping of its rows, which determines the supported sensitivity methods.
    append_only : bool
        Whether the first points do not change when more points are drawn.
    power_of_two : bool
        Whether `samples` must be a power of two.
    independent : bool
        Whether rows are independent, as assumed by confidence and tolerance bounds.
    follows_laws : bool
        Whether the rows of a replicate, or A and B of a crossed design, follow the input laws.
    least : int
        Minimum number of samples.
    nests : bool
        Whether a sample may have several rows (`uq.sampling.levels`).
    most_inputs : int or None
        Largest number of coordinates of a point, if limited.
    caution : str
        Sentence shown with every index estimated from its rows, or "".
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
        """Whether the rows are read from a file."""
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
        """Return the groups start..stop of every replicate.

        Returns
        -------
        ndarray, shape (stop - start, replicates, blocks, d)
            Points inside the open unit cube.
        """
        assert self.draw is not None, "imported rows are not drawn"
        if not self.crossed:
            points = self.draw(seed, replicates, d, samples, start, stop)
            return points.reshape(stop - start, replicates, self.blocks(d, False), d)
        points = self.draw(seed, replicates, 2 * d, samples, start, stop)
        return cross(points[..., :d], points[..., d:], second_order, random)

    def size_problem(self, samples: int) -> str | None:
        """Return the reason why `samples` is not a valid sample size; None if it is valid."""
        if not self.least <= samples <= MAX_SAMPLES:
            return f"must be between {self.least} and {MAX_SAMPLES}"
        legal = 1 << (samples - 1).bit_length()
        if self.power_of_two and samples != legal:
            return f"must be a power of two, {legal // 2} or {legal},"
        return None


def cross(a: Points, b: Points, second_order: bool, random: bool = False) -> Points:
    """Return the blocks of a crossed design from two samples (Saltelli 2002), in SALib's order.

    The columns of the two samples are exchanged one at a time.

    Parameters
    ----------
    a, b : ndarray, shape (..., d)
    second_order : bool
        Whether to add the blocks BA_i.
    random : bool
        Whether to add A a second time, for the noise of a random model.

    Returns
    -------
    ndarray, shape (..., blocks, d)
        A; AB_i, which is A with column i of B; BA_i, which is B with column i of A; B; A.

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


DESIGNS = {
    "monte-carlo": Design("independent rows", monte_carlo, independent=True, nests=True),
    "latin-hypercube": Design(
        "each input stratified into as many slices as samples",
        latin_hypercube,
        append_only=False,
        nests=True,
    ),
    "sobol": Design(
        "scrambled Sobol' sequence, samples a power of two",
        sobol,
        power_of_two=True,
        nests=True,
        most_inputs=MOST_OF_SOBOL,
    ),
    "halton": Design("scrambled Halton sequence", halton, nests=True),
    "saltelli": Design(
        "scrambled Sobol' sequence crossed for Sobol' indices, samples a power of two",
        sobol,
        CROSSED,
        power_of_two=True,
    ),
    "morris": Design(
        "trajectories that change one input at a time, for screening with few rows",
        morris_trajectories,
        TRAJECTORIES,
        append_only=False,
        follows_laws=False,
        least=2,
    ),
    "morris-optimised": Design(
        "trajectories chosen far apart, which favours the corners of the inputs",
        partial(morris_trajectories, pool=POOL),
        TRAJECTORIES,
        append_only=False,
        follows_laws=False,
        least=2,
        caution="trajectories chosen far apart favour the corners of the inputs: the effects are"
        " theirs, tens of per cent off those of all trajectories, which the design 'morris'"
        " estimates",
    ),
    "shapley": Design(
        "paths from one independent row to another, for Shapley effects", paths, PATHS
    ),
    "fast": Design(
        "a curve through the inputs for each of them, for extended FAST",
        fast_curves,
        CURVES,
        append_only=False,
        least=LEAST_POINTS,
    ),
    "rbd-fast": Design(
        "one curve shuffled for each input, for RBD-FAST", random_balance, append_only=False
    ),
    "imported": Design(
        "the rows of a CSV or netCDF file, in the parameters' units", None, append_only=False
    ),
}

IMPORTED = tuple(name for name, design in DESIGNS.items() if design.imported)
"""Designs whose rows are read from a file."""


def several(key: str, method: str, count: int = 2) -> str:
    """Return the advice for [design] to use several ``units`` or ``repeats`` per sample."""
    if DESIGNS[method].nests:
        return f"set {key} = {count}"
    able = " or ".join(f"'{name}'" for name, design in DESIGNS.items() if design.nests)
    return f"set {key} = {count} and method = {able}, since samples of '{method}' have one row"
