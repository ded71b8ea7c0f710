"""The uncertainty exponent of the boundary between basins: how intermingled they are."""

import numpy as np
import scipy  # which imports scipy.spatial when it is first used
from numpy.typing import NDArray

from uq.contract import Floats
from uq.stats.estimate import Estimate
from uq.stats.intervals import upper_probability
from uq.stats.quantile_functions import student
from uq.stats.roots import root
from uq.text.numbers import counted

FARTHEST = 0.1
"""Points farther apart in any coordinate are not compared."""

MOST_PAIRS = 400_000
"""Of more rows than give about so many pairs, the first ones are compared."""

FEWEST_ROWS = 20
"""So many must have a close neighbour in another basin."""

_STEEPEST = 8.0
_ENOUGH = 1e-4


def uncertainty_exponent(
    points: Floats, basin: NDArray[np.integer], kind: NDArray[np.integer] | None = None
) -> Estimate:
    """Estimate how fast uncertain outcomes become fewer as the start is known better.

    Parameters
    ----------
    points : ndarray, shape (n, d)
        Independent and uniform in the unit cube.
    basin : ndarray of int, shape (n,)
        Where each of them ends.
    kind : ndarray of int, shape (n,), optional
        Points of different kinds are not compared.

    Returns
    -------
    Estimate
        Of alpha, where the share of pairs in different basins is f(r) = c r^alpha, r their distance
        [1]_: 1 for a smooth boundary, less for a fractal one, whose dimension is d - alpha, and 0
        where the outcome cannot be predicted at all. Scatter may take it above 1 and below 0.
        Without a value, or an interval, where too few rows have a close neighbour elsewhere.

    Notes
    -----
    It is the exponent at distances up to `FARTHEST`, the largest over all coordinates: that of the
    limit, if f is a power. About Cantor's set, which repeats at every third scale only, the
    exponent of so few scales oscillates by up to 0.15. Pairs are counted from points at least as
    far from every edge, so that a flat boundary gives f exactly proportional to r.

    The exponent is that of the log-linear Poisson model of the pairs, in which the mean log r of
    those in different basins is that of all pairs weighted by r^alpha. Pairs share rows; therefore
    the variance of the score is that of a U-statistic [2]_, from the sum over the pairs of each
    row, and the interval contains each alpha whose score Student's t does not reject, its degrees
    of freedom the effective number of rows near the boundary.

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
        """Return the score over its standard deviation, and how many rows carry it."""
        expected = weight * np.exp(alpha * distance)
        expected *= differing.sum() / expected.sum()
        centre = np.average(distance, weights=expected)
        terms = (differing - expected) * (distance - centre)
        pulls = np.bincount(pairs[0], terms, rows)
        pulls += np.bincount(pairs[1], terms, rows)
        squares = pulls**2
        # Each pair is in the pulls of two rows; the mean pull is that of the score itself.
        shared = squares.sum() - (terms**2).sum() - squares.size * pulls.mean() ** 2
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
    """Find the pairs of close rows.

    Returns
    -------
    rows : int
        Number of rows compared.
    pairs : ndarray of int, shape (2, p)
        The rows of each pair.
    weight : ndarray, shape (p,)
        How many of the two are as far from all edges as the farthest pair is wide.
    differing : ndarray, shape (p,)
        The weight of a pair in different basins, else 0.
    distance : ndarray, shape (p,)
        Logarithm of the distance over `FARTHEST`.
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
