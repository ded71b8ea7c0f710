"""Curves that fill the unit cube: extended FAST and random balance designs."""

from functools import lru_cache

import numpy as np

from uq.designs.streams import Points, generator, inside

HARMONICS = 4
"""Harmonics of the frequency of an input that are taken for its effect."""

LEAST_POINTS = 4 * HARMONICS**2 + 1
"""Fewer points on a curve leave no frequency for the other inputs."""


def fast_curves(seed: int, replicates: int, d: int, samples: int, start: int, stop: int) -> Points:
    """Draw points start..stop of the curves of extended FAST, one curve per input.

    Returns
    -------
    ndarray, shape (stop - start, replicates, d, d)

    References
    ----------
    A. Saltelli, S. Tarantola, K. P.-S. Chan, "A quantitative model-independent method for global
    sensitivity analysis of model output", Technometrics 41, 39-56 (1999).
    """
    return _whole_fast(seed, replicates, d, samples)[start:stop]


@lru_cache(maxsize=1)  # the frequencies depend on the number of points
def _whole_fast(seed: int, replicates: int, d: int, samples: int) -> Points:
    from SALib.sample import fast_sampler

    problem = {"num_vars": d, "names": [str(i) for i in range(d)], "bounds": [[0.0, 1.0]] * d}
    curves = [
        fast_sampler.sample(problem, samples, HARMONICS, generator(seed, replicate))
        for replicate in range(replicates)
    ]
    points = inside(np.reshape(curves, (replicates, d, samples, d)).transpose(2, 0, 1, 3).copy())
    points.setflags(write=False)
    return points


def random_balance(
    seed: int, replicates: int, d: int, samples: int, start: int, stop: int
) -> Points:
    """Draw points start..stop of a random balance design: one curve, shuffled for each input.

    Returns
    -------
    ndarray, shape (stop - start, replicates, d)

    References
    ----------
    S. Tarantola, D. Gatelli, T. A. Mara, "Random balance designs for the estimation of first order
    global sensitivity indices", Reliab. Eng. Syst. Saf. 91, 717-727 (2006).
    """
    return _whole_random_balance(seed, replicates, d, samples)[start:stop]


@lru_cache(maxsize=1)
def _whole_random_balance(seed: int, replicates: int, d: int, samples: int) -> Points:
    points = np.empty((samples, replicates, d))
    for replicate in range(replicates):
        rng = generator(seed, replicate)
        turn = 2 * np.pi * (np.arange(samples) + rng.random()) / samples
        for column in range(d):
            x = 0.5 + np.arcsin(np.sin(rng.permutation(turn))) / np.pi
            points[:, replicate, column] = x
    inside(points)
    points.setflags(write=False)
    return points
