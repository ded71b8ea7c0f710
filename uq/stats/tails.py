"""Tail index of an output, which determines the moments that exist.

Above a high threshold the values of almost any law follow a generalised Pareto law [1]_. Its shape
k determines how fast the tail decays: P(Y > y) ~ y^(-1/k) for k > 0. The variance exists if
k < 1/2, the mean if k < 1. Without a variance, intervals of means, standard deviations and
variance-based indices are meaningless for any sample size.

References
----------
.. [1] J. Pickands, "Statistical inference using extreme order statistics", Ann. Stat. 3, 119-131
   (1975).
"""

from typing import NamedTuple

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.stats.intervals import sized
from uq.stats.quantile_functions import normal

MIN_TAIL = 20
"""Minimum sample size for a diagnosis of the tails."""

MAX_TAIL = 1000
"""Largest tail size: with more rows the tail starts farther out, closer to its limiting law."""

LARGEST_SHARE = 0.4
"""Largest share of rows used as the tail, if a generalised Pareto law fits them."""

DISTINCT = 10
"""Fewest distinct values in a tail; with fewer, the law is treated as discrete."""

LUMP = 0.2
"""Largest share of tied values in a tail; above it the value is an atom of the law, not a tail."""

LIGHT = 1 / 3
"""Estimated k of samples from a lognormal law with sigma = 1, for which all moments exist."""

SIGNIFICANCE = 0.01
"""Probability of classifying this light tail as heavy (false positive rate)."""

MISFIT = 1.0
"""Critical Anderson-Darling statistic of the tail fit: 1 % of heavy-tailed samples exceed it."""

_PRIOR_VALUES, _PRIOR_K = 10, 0.5


class Tail(NamedTuple):
    """Tail diagnosis: the fitted generalised Pareto law of the heavier tail.

    Attributes
    ----------
    k : float
        Shape of the generalised Pareto law.
    low, high : float
        95 % confidence interval of k.
    values : int
        Number of extreme values used in the fit.
    side : {"upper", "lower"}
    """

    k: float
    low: float
    high: float
    values: int
    side: str

    @property
    def no_variance(self) -> bool:
        """Whether the rows reject a finite variance: k is significantly above 1/2."""
        light = shrunk(LIGHT, self.values)
        reach = -normal(SIGNIFICANCE) * _error(LIGHT, self.values)
        return self.k > max(0.5, light + reach)

    @property
    def no_mean(self) -> bool:
        """Whether the rows reject a finite mean: k is significantly above 1."""
        return self.no_variance and self.k >= 1


def heavier_tail(values: Floats) -> Tail | None:
    """Estimate the tail index of the heavier tail.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite.

    Returns
    -------
    Tail or None
        The heavier of the upper and the lower tail. A tail starts with at most 40 % of the rows, or
        1000 rows. It is halved until a generalised Pareto law fits. k is the estimate of Zhang and
        Stephens [1]_, shrunk towards 1/2 with the weight of ten values [2]_, as in Pareto-smoothed
        importance sampling. Equal values, as on a lattice, are spread halfway to their neighbours.
        None if the law fits no tail of 20 or more values: for distant regimes, few rows, or fewer
        than 10 different values.

    References
    ----------
    .. [1] J. Zhang, M. A. Stephens, "A new and efficient estimation method for the generalized
       Pareto distribution", Technometrics 51, 316-325 (2009).
    .. [2] A. Vehtari, D. Simpson, A. Gelman, Y. Yao, J. Gabry, "Pareto smoothed importance
       sampling", J. Mach. Learn. Res. 25, 72 (2024), appendix G.

    Examples
    --------
    >>> import numpy as np
    >>> u = (np.arange(1000) + 0.5) / 1000
    >>> heavier_tail(u ** (-1 / 1.5)).no_variance  # Pareto's law with index 1.5
    True
    >>> heavier_tail(-np.log(u)).no_variance  # exponential
    False
    """
    size = min(int(LARGEST_SHARE * len(values)), MAX_TAIL)
    if size < MIN_TAIL:
        return None
    parted = np.partition(values, (size, len(values) - size - 1))
    upper, lower = np.sort(parted[-size - 1 :]), np.sort(-parted[: size + 1])
    tails = [
        tail
        for side, extreme in (("upper", upper), ("lower", lower))
        if (tail := _tail(extreme, side)) is not None
    ]
    return max(tails, key=lambda tail: tail.k, default=None)


def lacks_variance(values: Floats) -> bool:
    """Whether the finite values reject a finite variance."""
    tail = heavier_tail(values[np.isfinite(values)])
    return tail is not None and tail.no_variance


def _tail(ascending: Floats, side: str) -> Tail | None:
    size = len(ascending) - 1
    while size >= MIN_TAIL:
        extreme = _spread(ascending[-size - 1 :])
        excess = extreme[1:] - extreme[0]
        counts = np.unique(ascending[-size:], return_counts=True)[1]
        if len(counts) >= DISTINCT and counts.max() <= LUMP * size and (excess > 0).all():
            shape, scale = generalised_pareto(excess)
            if _distance(excess, shape, scale) <= MISFIT:
                k, reach = shrunk(shape, size), 1.96 * _error(shape, size)
                return Tail(k, k - reach, k + reach, size, side)
        size //= 2
    return None


def _spread(ascending: Floats) -> Floats:
    """Spread equal values evenly, halfway to their neighbours."""
    values, counts = np.unique(ascending, return_counts=True)
    if len(values) in (1, len(ascending)):
        return ascending
    half = np.diff(values) / 2
    below, above = np.r_[half[0], half], np.r_[half, half[-1]]
    first = np.repeat(np.cumsum(counts) - counts, counts)
    share = (np.arange(len(ascending)) - first + 0.5) / np.repeat(counts, counts)
    low, width = np.repeat(values - below, counts), np.repeat(below + above, counts)
    return np.where(np.repeat(counts, counts) > 1, low + share * width, ascending)


def generalised_pareto(excess: Floats) -> tuple[float, float]:
    """Estimate shape k and scale of a generalised Pareto law (Zhang and Stephens 2009).

    Parameters
    ----------
    excess : ndarray, shape (n,)
        Positive, ascending.

    Returns
    -------
    shape, scale : float
    """
    excess, size = sized(excess)
    n = len(excess)
    points = 30 + int(np.sqrt(n))
    quartile = excess[int(n / 4 + 0.5) - 1]
    theta = 1 / excess[-1] + (1 - np.sqrt(points / (np.arange(points) + 0.5))) / (3 * quartile)
    theta = theta[theta != 0]  # 0 is the exponential law; it occurs for lattices
    shapes = np.log1p(-theta[:, None] * excess).mean(axis=1)
    likelihood = n * (np.log(-theta / shapes) - shapes - 1)
    weights = np.exp(likelihood - likelihood.max())
    mean = float(theta @ weights / weights.sum())
    shape = float(np.log1p(-mean * excess).mean())
    return shape, -shape / mean * size


def _distance(excess: Floats, shape: float, scale: float) -> float:
    """Return the Anderson-Darling statistic of ascending values for this law."""
    x = excess / scale
    right = -special.log1p(shape * x) / shape
    below, above = -special.inv_boxcox1p(-x, -shape), special.inv_boxcox(-x, -shape)
    with np.errstate(divide="ignore"):  # in the branch that is not selected
        left = np.where(below < 0.5, np.log(below), np.log1p(-above))
    n = len(excess)
    return float(-n - (2 * np.arange(1, n + 1) - 1) @ (left + right[::-1]) / n)


def shrunk(shape: float, size: int) -> float:
    """Return the shape shrunk towards 1/2 with the prior weight of ten values."""
    return (size * shape + _PRIOR_VALUES * _PRIOR_K) / (size + _PRIOR_VALUES)


def _error(shape: float, size: int) -> float:
    """Return the standard error of the shape (Smith 1987) after shrinkage towards the prior."""
    return max(1 + shape, 0.0) * np.sqrt(size) / (size + _PRIOR_VALUES)
