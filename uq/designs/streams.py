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


def splitmix64(z: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Take one step of SplitMix64, from states to numbers.

    References
    ----------
    G. L. Steele, D. Lea, C. H. Flood, "Fast splittable pseudorandom number generators", OOPSLA
    2014, 453-472; constants as in java.util.SplittableRandom.
    """
    z = z + _GAMMA
    z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
    z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return z ^ (z >> np.uint64(31))


_GAMMA = np.uint64(0x9E3779B97F4A7C15)


def hashed(points: Points) -> NDArray[np.uint64]:
    """Hash the coordinates of points, shape (n, d), into one state of SplitMix64 per point."""
    state = np.zeros(len(points), np.uint64)
    for column in points.T:
        state = splitmix64(state) ^ np.ascontiguousarray(column).view(np.uint64)
    return splitmix64(state)


def uniform(state: NDArray[np.uint64], number: NDArray[np.int64]) -> Points:
    """Return one number in (0, 1) of the stream that SplitMix64 draws from each state.

    Parameters
    ----------
    state : ndarray of uint64, shape (n,)
    number : ndarray of int, shape (n,)
        Its place in the stream, from 0.

    Returns
    -------
    ndarray, shape (n,)
    """
    found = splitmix64(state + number.astype(np.uint64) * _GAMMA)
    return np.asarray(((found >> np.uint64(11)) + 0.5) * 2.0**-53)


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
