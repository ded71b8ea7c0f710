"""Points that fill the unit cube: at random, stratified, by low-discrepancy sequences.

Each function draws points start..stop of each replicate, shape (stop - start, replicates, d), with
the same bits for any start and stop.
"""

from copy import copy
from functools import lru_cache
from typing import Any

import numpy as np

from uq.designs.streams import Points, drawn_at_once, generator, inside, replicate_seed

MOST_OF_SOBOL = 21_201
"""Dimensions that `scipy.stats.qmc.Sobol` has direction numbers for."""


def monte_carlo(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
    """Draw independent points."""

    def points(replicate: int) -> Points:
        bits = np.random.PCG64(replicate_seed(seed, replicate))
        bits.advance(start * d)  # one step of the generator per number
        return inside(np.random.Generator(bits).random((stop - start, d)))

    return np.stack([points(replicate) for replicate in range(replicates)], axis=1)


def paths(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
    """Draw paths between two independent points, one input after the other in random order."""
    points = monte_carlo(seed, replicates, 3 * d, samples, start, stop)
    first, last, order = np.split(points[:, :, None], 3, axis=-1)
    step = np.argsort(np.argsort(order, axis=-1), axis=-1)  # at which each input changes
    return np.where(step < np.arange(d + 1)[:, None], last, first)


@drawn_at_once
def latin_hypercube(seed: int, replicates: int, d: int, samples: int) -> Points:
    """Draw a part of a Latin hypercube."""
    from scipy.stats import qmc

    engines = (qmc.LatinHypercube(d, rng=generator(seed, i)) for i in range(replicates))
    return np.stack([inside(engine.random(samples)) for engine in engines], axis=1)


def sobol(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
    """Draw a part of a scrambled Sobol' sequence."""

    def points(engine: Any) -> Points:
        # scipy warns when the first draw is not a power of two; the design as a whole is one.
        n = stop - start
        first = engine.random(min(n, 1)) if start == 0 else engine.fast_forward(start).random(0)
        rest = engine.random(n - len(first))
        return inside(np.concatenate([first, rest]), 2.0**-31)  # half of the last of 30 bits

    return np.stack([points(engine) for engine in _sequences("Sobol", seed, replicates, d)], axis=1)


def halton(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
    """Draw a part of a scrambled Halton sequence."""

    def points(engine: Any) -> Points:
        engine.num_generated = start  # its fast_forward would compute all points before
        return inside(engine.random(stop - start))

    return np.stack(
        [points(engine) for engine in _sequences("Halton", seed, replicates, d)], axis=1
    )


def _sequences(name: str, seed: int, replicates: int, d: int) -> list[Any]:
    """Return a sequence of `scipy.stats.qmc` for each replicate, at its start."""
    scrambled = [_scrambled(name, seed, replicate, d) for replicate in range(replicates)]
    return [copy(engine).reset() for engine in scrambled]


@lru_cache(maxsize=128)  # scrambling costs more than the points of a small chunk
def _scrambled(name: str, seed: int, replicate: int, d: int) -> Any:
    from scipy.stats import qmc

    return getattr(qmc, name)(d, rng=generator(seed, replicate))
