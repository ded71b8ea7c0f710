"""Uncertainty exponent of a basin boundary, which measures how intermingled the basins are."""

import numpy as np
import scipy  # which imports scipy.spatial when it is first used
from numpy.typing import NDArray

from uq.contract import Floats
from uq.stats.estimate import Estimate
from uq.stats.intervals import upper_probability
from uq.stats.quantile_functions import root, student
from uq.text.numbers import counted

FARTHEST = 0.1
"""Largest distance of compared points in any coordinate."""

MOST_PAIRS = 400_000
"""Approximate limit of the number of pairs; with more rows only the first rows are compared."""

FEWEST_ROWS = 20
"""Fewest rows with a close neighbour in another basin."""

_STEEPEST = 8.0
_ENOUGH = 1e-4


def uncertainty_exponent(
    points: Floats, basin: NDArray[np.integer], kind: NDArray[np.integer] | None = None
) -> Estimate:
    """Estimate the uncertainty exponent of the basin boundary (Grebogi et al. 1983).

    Parameters
    ----------
    points : ndarray, shape (n, d)
        Independent and uniform in the unit cube.
    basin : ndarray of int, shape (n,)
        Basin of each point.
    kind : ndarray of int, shape (n,), optional
        Points of different kinds are not compared.

    Returns
    -------
    Estimate
        Estimate of alpha in f(r) = c r^alpha, where f is the share of pairs at distance r that lie
        in different basins [1]_. alpha is 1 for a smooth boundary and less for a fractal boundary,
        whose dimension is d - alpha. It is 0 if the outcome is unpredictable. Sampling error may
        take the estimate above 1 or below 0. Value or interval are missing if too few rows have a
        close neighbour in another basin.

    Notes
    -----
    The exponent applies to distances up to `FARTHEST`, measured as the largest difference over all
    coordinates. If f is a power, it equals the exponent in the limit of small distances. For
    Cantor's set, which repeats itself only when the scale changes by three, the exponent of a few
    scales oscillates by up to 0.15. Pairs are counted from points at least `FARTHEST` from every
    edge, so that f is exactly proportional to r for a flat boundary.

    The estimator is maximum likelihood in the log-linear Poisson model of the pairs. Its score
    equates the mean log r of pairs in different basins with the mean of all pairs, weighted by
    r^alpha. Pairs share rows; therefore the variance of the score is computed as for a U-statistic
    [2]_, from the sum over the pairs of each row. The interval contains every alpha that a score
    test with Student's t does not reject. The degrees of freedom are the effective number of rows
    near the boundary.

    References
    ----------
    .. [1] C. Grebogi, S. W. McDonald, E. Ott, J. A. Yorke, "Final state sensitivity: an obstruction
       to predictability", Phys. Lett. A 99, 415-418 (1983).
    .. [2] W. Hoeffding, "A class of statistics with asymptotically normal distribution", Ann. Math.
       Stat. 19, 293-325 (1948).
    """
    rows, pairs, weight, differing, distance = _close_pairs(points, basin, kind)
    near = len(np.unique(pairs[:, differing > 0]))
    if near < FEWEST_ROWS:
        return Estimate(
            reason=f"only {counted(near, 'row has', 'rows have')} a close neighbour in another"
            f" basin; {FEWEST_ROWS} are needed"
        )
    goal = float(np.average(distance, weights=differing))

    def excess(alpha: float) -> float:  # of the mean log r of all pairs, weighted by r^alpha
        return float(np.average(distance, weights=weight * np.exp(alpha * distance))) - goal

    def score(alpha: float) -> tuple[float, float]:
        """Return the standardised score, and the effective number of rows behind it."""
        expected = weight * np.exp(alpha * distance)
        expected *= differing.sum() / expected.sum()
        centre = np.average(distance, weights=expected)
        terms = (differing - expected) * (distance - centre)
        influence = np.bincount(pairs[0], terms, rows)
        influence += np.bincount(pairs[1], terms, rows)
        squares = influence**2
        # Each pair contributes to the influence of two rows; the mean influence is the score.
        shared = squares.sum() - (terms**2).sum() - squares.size * influence.mean() ** 2
        variance = max(shared, (terms**2).sum())
        effective = squares.sum() ** 2 / (squares**2).sum()
        return float(terms.sum() / np.sqrt(variance)), float(effective)

    try:
        value = root(excess, (-_STEEPEST, _STEEPEST), _ENOUGH**2)
        limit = student(upper_probability(), score(value)[1] - 1)
        below, above = (value - _STEEPEST, value), (value, value + _STEEPEST)
        low = root(lambda alpha: score(alpha)[0] - limit, below, _ENOUGH)
        high = root(lambda alpha: score(alpha)[0] + limit, above, _ENOUGH)
    except ValueError:
        return Estimate(reason=f"{near} rows with a close neighbour in another basin are too few")
    return Estimate(value, low, high)


def _close_pairs(
    points: Floats, basin: NDArray[np.integer], kind: NDArray[np.integer] | None
) -> tuple[int, NDArray[np.intp], Floats, Floats, Floats]:
    """Return the pairs of rows closer than `FARTHEST`.

    Returns
    -------
    rows : int
        Number of rows compared.
    pairs : ndarray of int, shape (2, p)
        The rows of each pair.
    weight : ndarray, shape (p,)
        Number of points of the pair (0, 1 or 2) that are at least `FARTHEST` from all edges.
    differing : ndarray, shape (p,)
        Weight of pairs in different basins; 0 for all other pairs.
    distance : ndarray, shape (p,)
        Logarithm of the distance divided by `FARTHEST`.
    """
    rows = int(np.sqrt(2 * MOST_PAIRS / (2 * FARTHEST) ** points.shape[1]))
    points, basin = points[:rows], basin[:rows]
    inside = np.asarray(np.abs(points - 0.5).max(axis=1) < 0.5 - FARTHEST)
    if kind is not None:
        points = np.column_stack([points, kind[:rows]])  # other kinds are farther than any pair
    pairs = scipy.spatial.cKDTree(points).query_pairs(FARTHEST, p=np.inf, output_type="ndarray")
    distance = np.abs(np.subtract(*points[pairs.T])).max(axis=1)
    weight = inside[pairs].sum(axis=1).astype(float)
    kept = np.flatnonzero((weight > 0) & (distance > 0))  # imported points may coincide
    pairs, weight = pairs[kept].T, weight[kept]
    differing = weight * (basin[pairs[0]] != basin[pairs[1]])
    return len(points), pairs, weight, differing, np.log(distance[kept] / FARTHEST)
