"""Distribution of a sum of independent terms, each a multiple of the logarithm of an input."""

from functools import cached_property
from math import inf

import numpy as np
from numpy.polynomial import chebyshev
from scipy import special

from uq.contract import Floats
from uq.sampling.law import Law
from uq.sampling.scipy_laws import Elementary
from uq.sampling.truncation import cdf_within, ppf_within

ACCURACY = 1e-10
"""Largest absolute error of the distribution function of a sum."""

_FARTHEST = 8.2  # standard normal quantile beyond which a probability is negligible
_CERTAIN = 8.5  # beyond which it rounds to 0 beside 1
_NODES = 96
_DEGREE = 24
_DEEPEST = 12
_HALVINGS = 50


class LogTerm:
    """A multiple of the logarithm of an input.

    Parameters
    ----------
    law : Law
        Continuous, of a positive quantity.
    bounds : tuple of float
        Bounds on which the law is conditioned.
    exponent : float
        Not zero.

    Attributes
    ----------
    breaks : ndarray, shape (k,)
        Ascending; the ends, beyond which the probability is negligible, and the interior points at
        which the density is not smooth.
    """

    def __init__(self, law: Law, bounds: tuple[float, float], exponent: float):
        self._law, self._bounds, self.exponent = law, bounds, exponent
        ends = ppf_within(law, special.ndtr(np.array([-_FARTHEST, _FARTHEST])), bounds)
        inner = [x for x in law.kinks() if ends[0] < x < ends[1]]
        self.breaks = np.sort(exponent * np.log([ends[0], *inner, ends[1]]))

    def below(self, value: Floats) -> Floats:
        """Return the probability of less than each value."""
        with np.errstate(over="ignore", under="ignore"):
            share = cdf_within(self._law, np.exp(value / self.exponent), self._bounds)
        return share if self.exponent > 0 else 1 - share

    def at(self, z: Floats) -> Floats:
        """Return the quantiles at the probabilities of standard normal quantiles."""
        u = special.ndtr(np.sign(self.exponent) * z)
        u = np.clip(u, 2.0**-54, 1 - 2.0**-53)
        return self.exponent * np.log(ppf_within(self._law, u.ravel(), self._bounds)).reshape(
            z.shape
        )

    @cached_property
    def certain(self) -> tuple[float, float]:
        """Value up to which 1 - P rounds to 1, and value from which P is 1; infinite if unknown."""
        parent = self._law.frozen()
        if not isinstance(parent, Elementary) or parent.uniform:
            return -inf, inf
        x = np.maximum(parent.value(np.array([-_CERTAIN, _CERTAIN])), 1e-300)
        low, high = np.sort(self.exponent * np.log(x)).tolist()
        below = self.below(np.array([low, high]))
        return (low, high) if below[0] < 2.0**-55 and 1 - below[1] == 0 else (-inf, inf)

    @cached_property
    def moments(self) -> tuple[float, float]:
        """Its mean and variance."""
        at, weight = normal_rule(special.ndtri(self.below(self.breaks)), _NODES)
        values = self.at(at)
        mean = np.average(values, weights=weight)
        return float(mean), float(np.average((values - mean) ** 2, weights=weight))

    @property
    def spread(self) -> float:
        """Its standard deviation."""
        return float(np.sqrt(self.moments[1]))


class Sum:
    """Sum of a random number and an independent term.

    The distribution function is an integral over the quantiles of the term. It is computed by
    Gauss-Legendre quadrature between the points at which the integrand is not smooth, and stored as
    Chebyshev polynomials.

    Parameters
    ----------
    first : LogTerm or Sum
    second : LogTerm

    Raises
    ------
    ArithmeticError
        The probabilities are not accurate to `ACCURACY`.
    """

    def __init__(self, first: "LogTerm | Sum", second: LogTerm):
        self._first, self._second = first, second
        self.breaks: Floats = np.unique(np.add.outer(first.breaks, second.breaks))
        coarse = self._pieces(_NODES)
        self.ends = np.array([*(low for low, _, _ in coarse), coarse[-1][1]])
        self.coefficients = np.array([c for _, _, c in coarse])
        middle = (self.ends[1:] + self.ends[:-1]) / 2
        if np.abs(self._exactly(middle, 3 * _NODES) - self.below(middle)).max() > ACCURACY:
            raise ArithmeticError("the probability of the sum is not accurate enough")

    @property
    def certain(self) -> tuple[float, float]:
        """Value up to which P is 0, and value from which it is 1."""
        return float(self.ends[0]), float(self.ends[-1])

    @property
    def moments(self) -> tuple[float, float]:
        """Its mean and variance."""
        pairs = zip(self._first.moments, self._second.moments, strict=True)
        mean, variance = map(sum, pairs)
        return mean, variance

    def below(self, value: Floats) -> Floats:
        """Return the probability of less than each value."""
        value = np.asarray(value)
        inside = np.clip(value, self.ends[0], self.ends[-1])
        piece = np.clip(np.searchsorted(self.ends, inside) - 1, 0, len(self.ends) - 2)
        low, high = self.ends[piece], self.ends[piece + 1]
        x = (2 * inside - low - high) / (high - low)
        coefficients = np.moveaxis(self.coefficients[piece], -1, 0)
        probability = chebyshev.chebval(x, coefficients, tensor=False)
        probability = np.where(value <= self.ends[0], 0.0, probability)
        return np.clip(np.where(value >= self.ends[-1], 1.0, probability), 0.0, 1.0)

    def at(self, z: Floats) -> Floats:
        """Return the quantiles at the probabilities of standard normal quantiles, by bisection."""
        low, high = (np.full(z.shape, end) for end in self.ends[[0, -1]])
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            above = self.below(middle) > special.ndtr(z)
            low, high = np.where(above, low, middle), np.where(above, middle, high)
        return np.asarray((low + high) / 2)

    def _pieces(self, nodes: int) -> list[tuple[float, float, Floats]]:
        """Return limits and coefficients of polynomials on intervals halved until accurate."""
        pieces = []
        waiting = [(low, high, 0) for low, high in zip(self.breaks, self.breaks[1:], strict=False)]
        test = np.array([-0.97, -0.31, 0.44, 0.99])
        while waiting:
            low, high, depth = waiting.pop(0)

            def value(x: Floats, low: float = low, high: float = high) -> Floats:
                return self._exactly((low + high) / 2 + (high - low) / 2 * x, nodes)

            c: Floats = chebyshev.chebinterpolate(value, _DEGREE)  # type: ignore[arg-type]
            wrong = np.abs(chebyshev.chebval(test, c) - value(test)).max() > ACCURACY / 10
            if wrong and depth < _DEEPEST:
                middle = (low + high) / 2
                waiting += [(low, middle, depth + 1), (middle, high, depth + 1)]
            else:
                pieces.append((low, high, c))
        return sorted(pieces, key=lambda piece: piece[0])

    def _exactly(self, value: Floats, nodes: int) -> Floats:
        """Return the distribution function at each value, shape (k,), by quadrature."""
        kinks = value[:, None] - self._first.breaks
        breaks = self._second.breaks
        places = np.sort(
            np.hstack([np.clip(kinks, breaks[0], breaks[-1]), np.tile(breaks, (len(value), 1))]),
            axis=1,
        )
        at, density = normal_rule(special.ndtri(self._second.below(places)), nodes)
        inner = self._first.below(value[:, None, None] - self._second.at(at))
        probability: Floats = (density * inner).sum(axis=(1, 2))
        return probability


Term = LogTerm | Sum
"""A random number with `breaks`, `moments`, distribution function and quantiles."""


def normal_rule(z: Floats, nodes: int) -> tuple[Floats, Floats]:
    """Return Gauss-Legendre nodes and weights for the mean over a standard normal variable.

    Parameters
    ----------
    z : ndarray, shape (..., pieces + 1)
        Ends of the pieces, ascending; the first and the last represent infinity.
    nodes : int
        Number of nodes in each piece.

    Returns
    -------
    nodes, weights : ndarray, shape (..., pieces, nodes)
    """
    z = np.clip(z, -_FARTHEST, _FARTHEST)
    z[..., 0], z[..., -1] = -_FARTHEST, _FARTHEST
    x, weight = np.polynomial.legendre.leggauss(nodes)
    half, middle = np.diff(z)[..., None] / 2, ((z[..., 1:] + z[..., :-1]) / 2)[..., None]
    at = middle + half * x
    return at, np.exp(-(at**2) / 2) / np.sqrt(2 * np.pi) * half * weight


def law_of_sum(terms: list[LogTerm]) -> Term:
    """Return the distribution of a sum of independent terms; the widest term enters exactly."""
    widest, *others = sorted(terms, key=lambda term: -term.spread)
    total: Term = widest
    for term in others:
        total = Sum(total, term)
    return total
