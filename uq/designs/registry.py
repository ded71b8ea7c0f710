"""Designs: which points of the unit cube a study visits, by name.

Every design is a table entry in `DESIGNS`. To add one: write a function that draws its points,
say what it may be asked for, and which sensitivity methods it can feed.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from uq.designs import seeds
from uq.designs.curves import LEAST_POINTS, fast_curves, random_balance
from uq.designs.sequences import halton, latin_hypercube, monte_carlo, paths, sobol
from uq.designs.streams import Points
from uq.designs.trajectories import morris_trajectories, optimised_trajectories

MAX_SAMPLES = 2**30
"""Points of one replicate: what the 30 bits of a Sobol' sequence can tell apart."""

NOISE = "noise"
"""The block of a crossed design of a random model that has the inputs of A and the seed of B."""


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
    feeds : tuple of str
        The sensitivity methods that can use its rows, the default first.
    append_only : bool
        Whether the first points stay as they are when more are asked for.
    power_of_two : bool
        Whether `samples` must be a power of two.
    independent : bool
        Whether rows are independent, which formulas for confidence and tolerance bounds need.
    crossed : bool
        Whether each point becomes a group of rows A, AB_1 .. AB_d, (BA_1 .. BA_d,) B, and of a
        random model `NOISE`.
    shared_seeds : callable
        Which rows of a random model share a seed; see `uq.designs.seeds`.
    labels : callable or None
        ``labels(parameters)`` -> the names of the rows of a group, where a design draws groups.
    follows_laws : bool
        Whether the rows of a replicate, A and B of a crossed design, are spread as the laws say.
    least : int
        The smallest number of samples.
    """

    meaning: str
    draw: Callable[[int, int, int, int, int, int], Points] | None
    feeds: tuple[str, ...]
    append_only: bool = True
    power_of_two: bool = False
    independent: bool = False
    crossed: bool = False
    shared_seeds: seeds.Rule = seeds.own
    labels: Callable[[tuple[str, ...]], tuple[str, ...]] | None = None
    follows_laws: bool = True
    least: int = 1

    @property
    def shares_seeds(self) -> bool:
        """Whether rows of a random model share seeds."""
        return self.shared_seeds is not seeds.own

    def blocks(self, d: int, second_order: bool, random: bool = False) -> int:
        """Return the number of rows in a group."""
        return len(block_names(self, ("",) * d, second_order, random))

    def feeds_with(self, dependent: bool) -> tuple[str, ...]:
        """Return the methods it feeds, where the inputs are dependent or not."""
        return tuple(name for name in self.feeds if not dependent or name in FOR_DEPENDENT_INPUTS)

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
        """Say why `samples` is not a legal size, or return None."""
        if not self.least <= samples <= MAX_SAMPLES:
            return f"must be between {self.least} and {MAX_SAMPLES}"
        legal = 1 << (samples - 1).bit_length()
        if self.power_of_two and samples != legal:
            return f"must be a power of two; the next is {legal}"
        return None

    @property
    def extension_problem(self) -> str | None:
        """Say why rows cannot be appended to a result of this design, or return None."""
        if self.append_only:
            return None
        able = ", ".join(name for name, other in DESIGNS.items() if other.append_only)
        return f"cannot be extended; designs that can: {able}"


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


def block_names(
    design: Design, parameters: tuple[str, ...], second_order: bool, random: bool = False
) -> tuple[str, ...]:
    """Return the name of each block of a group, in row order; ``("sample",)`` without groups."""
    if design.labels is not None:
        return design.labels(parameters)
    if not design.crossed:
        return ("sample",)
    mirrored = [f"BA_{name}" for name in parameters] if second_order else []
    noise = [NOISE] if random else []
    return ("A", *(f"AB_{name}" for name in parameters), *mirrored, "B", *noise)


def _steps(parameters: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"step_{i}" for i in range(len(parameters) + 1))


def _places(parameters: tuple[str, ...]) -> tuple[str, ...]:
    return ("A", *(f"AB_{i}" for i in range(1, len(parameters))), "B")


def _curves(parameters: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(f"curve_{name}" for name in parameters)


FOR_DEPENDENT_INPUTS = ("delta", "pawn", "quantile", "regional")
"""Sensitivity methods that do not suppose the inputs to be independent."""

_GIVEN_DATA = ("rbd-fast", "delta", "pawn", "hdmr", "quantile", "regional")

DESIGNS = {
    "monte-carlo": Design("independent rows", monte_carlo, _GIVEN_DATA, independent=True),
    "latin-hypercube": Design(
        "each input stratified into as many slices as samples",
        latin_hypercube,
        _GIVEN_DATA,
        append_only=False,
    ),
    "sobol": Design(
        "scrambled Sobol' sequence, samples a power of two", sobol, _GIVEN_DATA, power_of_two=True
    ),
    "halton": Design("scrambled Halton sequence", halton, _GIVEN_DATA),
    "saltelli": Design(
        "scrambled Sobol' sequence crossed for Sobol' indices, samples a power of two",
        sobol,
        ("sobol",),
        power_of_two=True,
        crossed=True,
        shared_seeds=seeds.of_ends,
    ),
    "morris": Design(
        "trajectories that change one input at a time, for screening with few rows",
        morris_trajectories,
        ("morris",),
        append_only=False,
        shared_seeds=seeds.of_groups,
        labels=_steps,
        follows_laws=False,
        least=2,
    ),
    "morris-optimised": Design(
        "trajectories chosen far apart, which favours the corners of the inputs",
        optimised_trajectories,
        ("morris",),
        append_only=False,
        shared_seeds=seeds.of_groups,
        labels=_steps,
        follows_laws=False,
        least=2,
    ),
    "shapley": Design(
        "paths from one independent row to another, for Shapley effects",
        paths,
        ("shapley",),
        shared_seeds=seeds.of_groups,
        labels=_places,
    ),
    "fast": Design(
        "a curve through the inputs for each of them, for extended FAST",
        fast_curves,
        ("fast",),
        append_only=False,
        shared_seeds=seeds.of_curves,
        labels=_curves,
        least=LEAST_POINTS,
    ),
    "rbd-fast": Design(
        "one curve shuffled for each input, for RBD-FAST",
        random_balance,
        _GIVEN_DATA,
        append_only=False,
    ),
    "imported": Design(
        "the rows of a CSV or netCDF file, in the parameters' units",
        None,
        _GIVEN_DATA,
        append_only=False,
    ),
}
