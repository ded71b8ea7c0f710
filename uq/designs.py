"""Designs: which points of the unit cube a study visits, by name.

Every design is a table entry in `DESIGNS`. To add one: write a function that draws its points,
say what it may be asked for, and which sensitivity methods it can feed.
"""

from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]

MAX_SAMPLES = 2**30
"""Points of one replicate: what the 30 bits of a Sobol' sequence can tell apart."""


@dataclass(frozen=True)
class Design:
    """One way of choosing rows.

    Attributes
    ----------
    meaning : str
        One line for a reader of the study file.
    draw : callable
        ``draw(seed, replicates, d, samples, start, stop)`` -> points start..stop of each replicate,
        shape (stop - start, replicates, d), the same bits for any start and stop. Replicates are
        independent. A crossed design draws 2 d columns.
    feeds : tuple of str
        The sensitivity methods that can use its rows, the default first.
    append_only : bool
        Whether the first points stay as they are when more are asked for.
    power_of_two : bool
        Whether `samples` must be a power of two.
    independent : bool
        Whether rows are independent, which formulas for confidence and tolerance bounds need.
    crossed : bool
        Whether each point becomes a group of rows A, AB_1 .. AB_d, (BA_1 .. BA_d,) B.
    """

    meaning: str
    draw: Callable[[int, int, int, int, int, int], Points]
    feeds: tuple[str, ...]
    append_only: bool = True
    power_of_two: bool = False
    independent: bool = False
    crossed: bool = False

    def blocks(self, d: int, second_order: bool) -> int:
        """Return the number of rows in a group."""
        if not self.crossed:
            return 1
        return 2 * d + 2 if second_order else d + 2

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
    ) -> Points:
        """Draw the groups start..stop of every replicate.

        Returns
        -------
        ndarray, shape (stop - start, replicates, blocks, d)
            Inside the open unit cube.
        """
        if not self.crossed:
            return self.draw(seed, replicates, d, samples, start, stop)[:, :, None, :]
        points = self.draw(seed, replicates, 2 * d, samples, start, stop)
        return cross(points[..., :d], points[..., d:], second_order)

    def size_problem(self, samples: int) -> str | None:
        """Say why `samples` is not a legal size, or return None."""
        if not 1 <= samples <= MAX_SAMPLES:
            return f"must be between 1 and {MAX_SAMPLES}"
        legal = 1 << (samples - 1).bit_length()
        if self.power_of_two and samples != legal:
            return f"must be a power of two; the next is {legal}"
        return None


def cross(a: Points, b: Points, second_order: bool) -> Points:
    """Exchange the columns of two samples one at a time (Saltelli 2002), in SALib's order.

    Parameters
    ----------
    a, b : ndarray, shape (..., d)
    second_order : bool
        Whether to add the blocks BA_i.

    Returns
    -------
    ndarray, shape (..., blocks, d)
        A; AB_i, which is A with column i of B; BA_i, the converse; B.

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
    return np.concatenate([*blocks, b], axis=-2)


def block_names(design: Design, parameters: tuple[str, ...], second_order: bool) -> tuple[str, ...]:
    """Return the name of each block of a group, in row order; ``("sample",)`` if uncrossed."""
    if not design.crossed:
        return ("sample",)
    mirrored = [f"BA_{name}" for name in parameters] if second_order else []
    return ("A", *(f"AB_{name}" for name in parameters), *mirrored, "B")


def replicate_seed(seed: int, replicate: int) -> np.random.SeedSequence:
    """Return the seed of one replicate: a stream of its own for each (seed, replicate)."""
    return np.random.SeedSequence(entropy=seed, spawn_key=(replicate,))


def _monte_carlo(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
    def points(replicate: int) -> Points:
        bits = np.random.PCG64(replicate_seed(seed, replicate))
        bits.advance(start * d)  # one step of the generator per number
        return _inside(np.random.Generator(bits).random((stop - start, d)), 2.0**-54)

    return np.stack([points(replicate) for replicate in range(replicates)], axis=1)


def _latin_hypercube(
    seed: int, replicates: int, d: int, samples: int, start: int, stop: int
) -> Points:
    return _whole_latin_hypercube(seed, replicates, d, samples)[start:stop]


@lru_cache(maxsize=1)  # cannot be drawn in parts, and its rows are asked for in chunks
def _whole_latin_hypercube(seed: int, replicates: int, d: int, samples: int) -> Points:
    from scipy.stats import qmc

    engines = [
        qmc.LatinHypercube(d, rng=_generator(seed, replicate)) for replicate in range(replicates)
    ]
    points = np.stack([_inside(engine.random(samples), 2.0**-54) for engine in engines], axis=1)
    points.setflags(write=False)
    return points


def _sobol(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
    def points(engine: Any) -> Points:
        # scipy warns when the first draw is not a power of two; the design as a whole is one.
        n = stop - start
        first = engine.random(min(n, 1)) if start == 0 else engine.fast_forward(start).random(0)
        rest = engine.random(n - len(first))
        return _inside(np.concatenate([first, rest]), 2.0**-31)  # half of the last of 30 bits

    return np.stack([points(engine) for engine in _sequences("Sobol", seed, replicates, d)], axis=1)


def _halton(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
    def points(engine: Any) -> Points:
        engine.num_generated = start  # its fast_forward would compute all points before
        return _inside(engine.random(stop - start), 2.0**-54)

    return np.stack(
        [points(engine) for engine in _sequences("Halton", seed, replicates, d)], axis=1
    )


def _sequences(name: str, seed: int, replicates: int, d: int) -> list[Any]:
    """Return a sequence of `scipy.stats.qmc` for each replicate, at its beginning."""
    scrambled = [_scrambled(name, seed, replicate, d) for replicate in range(replicates)]
    return [copy(engine).reset() for engine in scrambled]


@lru_cache(maxsize=128)  # scrambling costs more than the points of a small chunk
def _scrambled(name: str, seed: int, replicate: int, d: int) -> Any:
    from scipy.stats import qmc

    return getattr(qmc, name)(d, rng=_generator(seed, replicate))


def _generator(seed: int, replicate: int) -> np.random.Generator:
    return np.random.default_rng(replicate_seed(seed, replicate))


def _inside(points: Points, smallest: float) -> Points:
    """Move the corner cases 0 and 1 inside, where every law has a finite quantile."""
    return np.clip(points, smallest, 1.0 - 2.0**-53, out=points)


_GIVEN_DATA = ("rbd-fast", "delta", "pawn", "hdmr", "quantile", "regional")

DESIGNS = {
    "monte-carlo": Design("independent rows", _monte_carlo, _GIVEN_DATA, independent=True),
    "latin-hypercube": Design(
        "each input stratified into as many slices as samples",
        _latin_hypercube,
        _GIVEN_DATA,
        append_only=False,
    ),
    "sobol": Design(
        "scrambled Sobol' sequence, samples a power of two", _sobol, _GIVEN_DATA, power_of_two=True
    ),
    "halton": Design("scrambled Halton sequence", _halton, _GIVEN_DATA),
    "saltelli": Design(
        "scrambled Sobol' sequence crossed for Sobol' indices, samples a power of two",
        _sobol,
        ("sobol",),
        power_of_two=True,
        crossed=True,
    ),
}
