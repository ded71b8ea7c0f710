"""Random streams of a design, and points kept off the faces of the unit cube."""

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


def replicate_seed(seed: int, *keys: int) -> np.random.SeedSequence:
    """Return the seed of one replicate: a stream of its own for each (seed, replicate).

    Parameters
    ----------
    seed : int
        Of the study; 0 is a seed like any other.
    *keys : int
        Replicate, and which part of it if its parts are drawn one by one.

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
