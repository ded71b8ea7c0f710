"""Sampling points of the unit cube: random, stratified, low-discrepancy, curves, trajectories.

Each function draws points start..stop of each replicate, shape (stop - start, replicates, d). A
point has the same bits for any start and stop. SALib draws Morris trajectories, and optionally
selects a subset with large distances. Its search is slow beyond a dozen trajectories. Therefore the
design consists of bundles of at most eight, each selected from four times as many.
"""

from collections.abc import Callable
from copy import copy
from functools import lru_cache, wraps
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

Points = NDArray[np.float64]


def replicate_seed(seed: int, *keys: int) -> np.random.SeedSequence:
    """Return the seed sequence of one replicate: each (seed, replicate) has its own stream.

    Parameters
    ----------
    seed : int
        Seed of the study; 0 is a valid seed.
    *keys : int
        Replicate, and its part if parts are drawn separately.

    Returns
    -------
    numpy.random.SeedSequence
    """
    return np.random.SeedSequence(entropy=seed, spawn_key=keys)


def generator(seed: int, *keys: int) -> np.random.Generator:
    """Return a random generator at the start of its stream; parameters as in `replicate_seed`."""
    return np.random.default_rng(replicate_seed(seed, *keys))


def inside(points: Points, smallest: float = 2.0**-54) -> Points:
    """Return points with 0 and 1 moved inside the unit interval, where quantiles are finite."""
    return np.clip(points, smallest, 1.0 - 2.0**-53, out=points)


def splitmix64(z: NDArray[np.uint64]) -> NDArray[np.uint64]:
    """Return the SplitMix64 output of each state.

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
    """Return one SplitMix64 state per point: a hash of its coordinates, shape (n, d)."""
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
        Index of the number in the stream, from 0.

    Returns
    -------
    ndarray, shape (n,)
    """
    bits = splitmix64(state + number.astype(np.uint64) * _GAMMA)
    return np.asarray(((bits >> np.uint64(11)) + 0.5) * 2.0**-53)


def drawn_at_once(draw: Callable[[int, int, int, int], Points]) -> Callable[..., Points]:
    """Return a function that draws parts of a design, from one cached draw of all its points."""

    @lru_cache(maxsize=1)
    def whole(seed: int, replicates: int, d: int, samples: int) -> Points:
        points = draw(seed, replicates, d, samples)
        points.setflags(write=False)
        return points

    @wraps(draw)
    def part(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
        return whole(seed, replicates, d, samples)[start:stop]

    return part


MOST_OF_SOBOL = 21_201
"""Largest dimension for which `scipy.stats.qmc.Sobol` has direction numbers."""


def monte_carlo(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
    """Return independent uniform points (plain Monte Carlo)."""

    def points(replicate: int) -> Points:
        bits = np.random.PCG64(replicate_seed(seed, replicate))
        bits.advance(start * d)  # one step of the generator per number
        return inside(np.random.Generator(bits).random((stop - start, d)))

    return np.stack([points(replicate) for replicate in range(replicates)], axis=1)


def paths(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
    """Return paths between two independent points; inputs change one by one in random order."""
    points = monte_carlo(seed, replicates, 3 * d, samples, start, stop)
    first, last, order = np.split(points[:, :, None], 3, axis=-1)
    step = np.argsort(np.argsort(order, axis=-1), axis=-1)  # step at which each input changes
    return np.where(step < np.arange(d + 1)[:, None], last, first)


@drawn_at_once
def latin_hypercube(seed: int, replicates: int, d: int, samples: int) -> Points:
    """Return a part of a Latin hypercube."""
    from scipy.stats import qmc

    engines = (qmc.LatinHypercube(d, rng=generator(seed, i)) for i in range(replicates))
    return np.stack([inside(engine.random(samples)) for engine in engines], axis=1)


def sobol(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
    """Return a part of a scrambled Sobol' sequence."""

    def points(engine: Any) -> Points:
        # scipy warns when the first draw is not a power of two; the design as a whole is one.
        n = stop - start
        first = engine.random(min(n, 1)) if start == 0 else engine.fast_forward(start).random(0)
        rest = engine.random(n - len(first))
        return inside(np.concatenate([first, rest]), 2.0**-31)  # half of the last of the 30 bits

    return np.stack([points(engine) for engine in _sequences("Sobol", seed, replicates, d)], axis=1)


def halton(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
    """Return a part of a scrambled Halton sequence."""

    def points(engine: Any) -> Points:
        engine.num_generated = start  # its fast_forward would compute all points before
        return inside(engine.random(stop - start))

    return np.stack(
        [points(engine) for engine in _sequences("Halton", seed, replicates, d)], axis=1
    )


def _sequences(name: str, seed: int, replicates: int, d: int) -> list[Any]:
    """Return a `scipy.stats.qmc` sequence at its start, for each replicate."""
    scrambled = [_scrambled(name, seed, replicate, d) for replicate in range(replicates)]
    return [copy(engine).reset() for engine in scrambled]


@lru_cache(maxsize=128)  # scrambling costs more than the points of a small chunk
def _scrambled(name: str, seed: int, replicate: int, d: int) -> Any:
    from scipy.stats import qmc

    return getattr(qmc, name)(d, rng=generator(seed, replicate))


def _unit_cube(d: int) -> dict[str, Any]:
    """Return the description that SALib requires of inputs between 0 and 1."""
    return {"num_vars": d, "names": [str(i) for i in range(d)], "bounds": [[0.0, 1.0]] * d}


HARMONICS = 4
"""Number of harmonics of the frequency of an input that are attributed to it."""

LEAST_POINTS = 4 * HARMONICS**2 + 1
"""Minimum number of points on a curve; with fewer, no frequency remains for the other inputs."""


@drawn_at_once  # the frequencies depend on the number of points
def fast_curves(seed: int, replicates: int, d: int, samples: int) -> Points:
    """Return points start..stop of the curves of extended FAST, one curve per input.

    Returns
    -------
    ndarray, shape (stop - start, replicates, d, d)

    References
    ----------
    A. Saltelli, S. Tarantola, K. P.-S. Chan, "A quantitative model-independent method for global
    sensitivity analysis of model output", Technometrics 41, 39-56 (1999).
    """
    from SALib.sample import fast_sampler

    curves = [
        fast_sampler.sample(_unit_cube(d), samples, HARMONICS, generator(seed, replicate))
        for replicate in range(replicates)
    ]
    return inside(np.reshape(curves, (replicates, d, samples, d)).transpose(2, 0, 1, 3).copy())


@drawn_at_once
def random_balance(seed: int, replicates: int, d: int, samples: int) -> Points:
    """Return points start..stop of a random balance design: one curve, shuffled for each input.

    Returns
    -------
    ndarray, shape (stop - start, replicates, d)

    References
    ----------
    S. Tarantola, D. Gatelli, T. A. Mara, "Random balance designs for the estimation of first order
    global sensitivity indices", Reliab. Eng. Syst. Saf. 91, 717-727 (2006).
    """
    points = np.empty((samples, replicates, d))
    for replicate in range(replicates):
        rng = generator(seed, replicate)
        turn = 2 * np.pi * (np.arange(samples) + rng.random()) / samples
        for column in range(d):
            wave = np.sin(rng.permutation(turn))
            points[:, replicate, column] = 0.5 + np.arcsin(wave) / np.pi
    return inside(points)


LEVELS = 4
"""Number of grid levels of each input."""

TAIL = 0.005
"""Probability below the lowest and above the highest level, since a law may be unbounded."""

STEP = (1 - 2 * TAIL) * LEVELS / (2 * (LEVELS - 1))
"""Step of an input, in probability."""

POOL = 4
"""Trajectories drawn per selected trajectory, if they are selected for large distances."""

_BUNDLE = 8


def morris_trajectories(
    seed: int, replicates: int, d: int, samples: int, start: int, stop: int, pool: int = 1
) -> Points:
    """Return Morris trajectories start..stop of each replicate [1]_.

    All trajectories are independent, or they are selected from a larger pool for large distances
    [2]_, [3]_. The selection favours the corners of the cube: with `POOL`, mean effects of the
    Ishigami function are 45 % too large for x1 and 50 % too small for x3.

    Returns
    -------
    ndarray, shape (stop - start, replicates, d + 1, d)
        Points of the trajectories, cut from the bundles that contain them.

    References
    ----------
    .. [1] M. D. Morris, "Factorial sampling plans for preliminary computational experiments",
       Technometrics 33, 161-174 (1991).
    .. [2] F. Campolongo, J. Cariboni, A. Saltelli, "An effective screening design for sensitivity
       analysis of large models", Environ. Model. Softw. 22, 1509-1518 (2007).
    .. [3] M. V. Ruano et al., "An improved sampling strategy based on trajectory design for
       application of the Morris method to systems with many input factors", Environ. Model.
       Softw. 37, 103-109 (2012).
    """
    edges = np.linspace(0, samples, -(-samples // _BUNDLE) + 1).astype(int)
    trajectories = [np.empty((0, replicates, d + 1, d))]
    for bundle, (first, last) in enumerate(pairwise(edges)):
        if first < stop and start < last:
            size = int(last - first)
            parts = [_bundle(seed, i, bundle, d, size, pool) for i in range(replicates)]
            trajectories.append(np.stack(parts, axis=1)[max(start - first, 0) : stop - first])
    return np.concatenate(trajectories)


@lru_cache(maxsize=256)
def _bundle(seed: int, replicate: int, bundle: int, d: int, size: int, pool: int) -> Points:
    from SALib.sample.morris import sample

    rng = generator(seed, replicate, bundle)
    best = size if pool > 1 else None
    levels = sample(_unit_cube(d), pool * size, LEVELS, optimal_trajectories=best, seed=rng)
    # Restore exact thirds: SALib's arithmetic may change their last bits.
    steps = np.rint(levels * (LEVELS - 1)).reshape(size, d + 1, d)
    points: Points = TAIL + (1 - 2 * TAIL) * steps / (LEVELS - 1)
    points.setflags(write=False)
    return points
