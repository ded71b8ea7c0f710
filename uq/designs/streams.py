"""Random streams of a design, and points kept off the faces of the unit cube."""

from collections.abc import Callable
from functools import lru_cache, wraps

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


def replicate_seed(seed: int, *keys: int) -> np.random.SeedSequence:
    """Return the seed of one replicate: each (seed, replicate) has its own stream.

    Parameters
    ----------
    seed : int
        That of the study; 0 is a seed like any other.
    *keys : int
        The replicate, and its part if parts are drawn one by one.

    Returns
    -------
    numpy.random.SeedSequence
    """
    return np.random.SeedSequence(entropy=seed, spawn_key=keys)


def generator(seed: int, *keys: int) -> np.random.Generator:
    """Return a generator at the beginning of its stream; parameters as in `replicate_seed`."""
    return np.random.default_rng(replicate_seed(seed, *keys))


def inside(points: Points, smallest: float = 2.0**-54) -> Points:
    """Move the corner cases 0 and 1 inside, where every law has a finite quantile."""
    return np.clip(points, smallest, 1.0 - 2.0**-53, out=points)


def drawn_at_once(draw: Callable[[int, int, int, int], Points]) -> Callable[..., Points]:
    """Cut parts from a design that can only be drawn as a whole: it is drawn once and kept."""

    @lru_cache(maxsize=1)
    def whole(seed: int, replicates: int, d: int, samples: int) -> Points:
        points = draw(seed, replicates, d, samples)
        points.setflags(write=False)
        return points

    @wraps(draw)
    def part(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
        return whole(seed, replicates, d, samples)[start:stop]

    return part
