"""Morris trajectories: from point to point one input changes, by a fixed step in probability.

SALib draws them, and on request selects those that are far apart. Its search is slow beyond a
dozen, so such a design consists of bundles of at most eight, each the best of four times as many.
"""

from functools import lru_cache
from itertools import pairwise

import numpy as np

from uq.designs.streams import Points, generator

LEVELS = 4
"""Levels of each input."""

TAIL = 0.005
"""Probability below the lowest and above the highest level: a law may be unbounded."""

STEP = (1 - 2 * TAIL) * LEVELS / (2 * (LEVELS - 1))
"""Step of an input, in probability."""

POOL = 4
"""Trajectories drawn for each that is chosen, where they are to lie far apart."""

_BUNDLE = 8


def morris_trajectories(
    seed: int, replicates: int, d: int, samples: int, start: int, stop: int, pool: int = 1
) -> Points:
    """Draw trajectories start..stop of each replicate [1]_.

    All are independent, or, from a pool of several times as many, those that lie far apart [2]_,
    [3]_. These favour the corners of the cube: with `POOL`, mean effects of the Ishigami function
    are 45 % too large for x1 and 50 % too small for x3.

    Returns
    -------
    ndarray, shape (stop - start, replicates, d + 1, d)
        From the bundles that contain them.

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
    found = [np.empty((0, replicates, d + 1, d))]
    for bundle, (first, last) in enumerate(pairwise(edges)):
        if first < stop and start < last:
            size = int(last - first)
            parts = [_bundle(seed, i, bundle, d, size, pool) for i in range(replicates)]
            found.append(np.stack(parts, axis=1)[max(start - first, 0) : stop - first])
    return np.concatenate(found)


@lru_cache(maxsize=256)
def _bundle(seed: int, replicate: int, bundle: int, d: int, size: int, pool: int) -> Points:
    from SALib.sample.morris import sample

    problem = {"num_vars": d, "names": [str(i) for i in range(d)], "bounds": [[0.0, 1.0]] * d}
    rng = generator(seed, replicate, bundle)
    best = size if pool > 1 else None
    levels = sample(problem, pool * size, LEVELS, optimal_trajectories=best, seed=rng)
    # Exact thirds again: SALib's arithmetic leaves their last bits to chance.
    steps = np.rint(levels * (LEVELS - 1)).reshape(size, d + 1, d)
    points: Points = TAIL + (1 - 2 * TAIL) * steps / (LEVELS - 1)
    points.setflags(write=False)
    return points
