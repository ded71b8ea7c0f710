"""Curves that fill the unit cube: extended FAST and random balance designs."""

import numpy as np

from uq.designs.streams import Points, drawn_at_once, generator, inside

HARMONICS = 4
"""Harmonics of the frequency of an input that count as its effect."""

LEAST_POINTS = 4 * HARMONICS**2 + 1
"""With fewer points on a curve, no frequency is left for the other inputs."""


@drawn_at_once  # the frequencies depend on the number of points
def fast_curves(seed: int, replicates: int, d: int, samples: int) -> Points:
    """Draw points start..stop of the curves of extended FAST, one curve per input.

    Returns
    -------
    ndarray, shape (stop - start, replicates, d, d)

    References
    ----------
    A. Saltelli, S. Tarantola, K. P.-S. Chan, "A quantitative model-independent method for global
    sensitivity analysis of model output", Technometrics 41, 39-56 (1999).
    """
    from SALib.sample import fast_sampler

    problem = {"num_vars": d, "names": [str(i) for i in range(d)], "bounds": [[0.0, 1.0]] * d}
    curves = [
        fast_sampler.sample(problem, samples, HARMONICS, generator(seed, replicate))
        for replicate in range(replicates)
    ]
    return inside(np.reshape(curves, (replicates, d, samples, d)).transpose(2, 0, 1, 3).copy())


@drawn_at_once
def random_balance(seed: int, replicates: int, d: int, samples: int) -> Points:
    """Draw points start..stop of a random balance design: one curve, shuffled for each input.

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
            x = 0.5 + np.arcsin(np.sin(rng.permutation(turn))) / np.pi
            points[:, replicate, column] = x
    return inside(points)
