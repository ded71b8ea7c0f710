"""Shapley effects of dependent inputs, in closed form: of sums, a product and an exponential.

y = x1 + x2 + 2 x3, all standard normal; x2 is correlated with x3, and x1 with x4, which the model
does not use. The same with x1 x3 added, or e to the power of a sixth or half of y; or all four
exponential, correlated in the same way. Or y = x1 + x2 + x3, with x1 and x2 either -1 or 1, and all
three correlated. Or Ishigami's function of uniform inputs, of which x1 and x3 are correlated.
"""

from functools import cache
from itertools import combinations
from math import factorial

import numpy as np
from scipy import special, stats

NAMES = ("x1", "x2", "x3", "x4")
WEIGHTS = np.array([1.0, 1.0, 2.0, 0.0])
AMONG_SIGNS = np.array([[1.0, 0.7, 0.5], [0.7, 1.0, -0.2], [0.5, -0.2, 1.0]])
"""Of the normal variables behind two signs and a number."""


def shares(value, d):
    """Return Shapley's shares of a value of sets of inputs.

    L. S. Shapley, "A value for n-person games", Contributions to the Theory of Games 2 (1953).
    """
    effects = np.zeros(d)
    for i in range(d):
        others = [j for j in range(d) if j != i]
        for k in range(d):
            weight = factorial(k) * factorial(d - k - 1) / factorial(d)
            for subset in combinations(others, k):
                effects[i] += weight * (value((*subset, i)) - value(subset))
    return effects / value(range(d))


def matrix(r):
    """Return the correlations of the normal inputs."""
    correlations = np.eye(4)
    correlations[1, 2] = correlations[2, 1] = correlations[0, 3] = correlations[3, 0] = r
    return correlations


def of_normal(r, interaction=0.0):
    """Return the Shapley effects of the weighted sum, and of it with x1 x3 times a factor added.

    Of normal inputs with covariances C, b'x + x'Ax has Var(E[y | x_u]) = b'Qb + 2 tr(AQAQ), where
    Q = C_u C_uu^-1 C_u'; for the linear part see Owen & Prieur (2017), Gaussian variables.
    """
    c, a = matrix(r), np.zeros((4, 4))
    a[0, 2] = a[2, 0] = interaction / 2

    def variance(q):
        return WEIGHTS @ q @ WEIGHTS + 2 * np.trace(a @ q @ a @ q)

    return _of_explained(c, variance)


def of_lognormal(r, scale):
    """Return the Shapley effects of e to the power of the weighted sum of normal inputs, scaled.

    The mean given some inputs is lognormal: its variance is e^v - 1 times its squared mean, with v
    that of its logarithm.
    """
    return _of_explained(matrix(r), lambda q: np.expm1(scale**2 * WEIGHTS @ q @ WEIGHTS))


def of_exponential(r, degrees=60):
    """Return the Shapley effects of the weighted sum of exponential inputs.

    Hermite polynomials of degree n in two scores have the correlation of the scores to the power n
    (Mehler 1866); coefficients by the trapezoidal rule.
    """
    z = np.linspace(-12.0, 12.0, 48_001)
    weight = stats.norm.pdf(z) * (z[1] - z[0])
    x, last, now = -special.log_ndtr(-z), np.zeros_like(z), np.ones_like(z)
    squares = []
    for n in range(degrees):
        last, now = now, (z * now - np.sqrt(n) * last) / np.sqrt(n + 1)
        squares.append((weight @ (x * now)) ** 2)

    def variance(q):
        return sum(square * WEIGHTS @ q ** (n + 1) @ WEIGHTS for n, square in enumerate(squares))

    return _of_explained(matrix(r), variance)


def _of_explained(c, variance):
    """Return the effects where some inputs u explain a variance that C_u C_uu^-1 C_u' decides."""

    def explained(subset):
        subset = list(subset)
        return (
            variance(c[:, subset] @ np.linalg.solve(c[np.ix_(subset, subset)], c[subset]))
            if subset
            else 0
        )

    return dict(zip(NAMES, shares(explained, 4).tolist(), strict=True))


@cache
def of_signs(points=1201):
    """Return the Shapley effects of two signs and a number, by the trapezoidal rule over x3."""
    c, z = AMONG_SIGNS, np.linspace(-9.0, 9.0, points)
    density = stats.norm.pdf(z) * (z[1] - z[0])
    slopes = c[:2, 2]
    rest = c[:2, :2] - np.outer(slopes, slopes)
    sd = np.sqrt(np.diag(rest))
    both = stats.multivariate_normal(cov=rest / np.outer(sd, sd))
    # P(x1 = a, x2 = b | x3): of the mirrored variables, correlated alike if a = b, else oppositely.
    signs = [(a, b) for a in (-1, 1) for b in (-1, 1)]
    given = {}
    for a, b in signs:
        law = both if a == b else stats.multivariate_normal(cov=_mirrored(rest / np.outer(sd, sd)))
        given[a, b] = law.cdf(np.stack([a * slopes[0] * z / sd[0], b * slopes[1] * z / sd[1]], 1))
    joint = np.stack([given[sign] * density for sign in signs])  # (4, points)
    y = np.array([a + b for a, b in signs])[:, None] + z
    cells = {
        (): np.zeros((4, points), int),
        (0,): np.array([[a] * points for a, _ in signs]),
        (1,): np.array([[b] * points for _, b in signs]),
        (0, 1): np.array([[2 * a + b] * points for a, b in signs]),
    }

    def explained(subset):
        subset = tuple(sorted(subset))
        cell = cells[tuple(i for i in subset if i < 2)] * 10_000
        cell = cell + np.arange(points) if 2 in subset else cell
        _, place = np.unique(cell, return_inverse=True)
        weight, total = (np.bincount(place.ravel(), w.ravel()) for w in (joint, joint * y))
        weight, total = (sums[weight > 0] / joint.sum() for sums in (weight, total))
        return float((total**2 / weight).sum() - total.sum() ** 2)

    return dict(zip(NAMES[:3], shares(explained, 3).tolist(), strict=True))


def among_waves(r):
    """Return the correlations of the normal variables behind the inputs of Ishigami's function."""
    correlations = np.eye(3)
    correlations[0, 2] = correlations[2, 0] = r
    return correlations


def of_waves(r, points=1601):
    """Return the Shapley effects of Ishigami's function by the trapezoidal rule over x1 and x3.

    x2 is independent, and adds 7 sin(x2)^2 to a function of the others.
    """
    z = np.linspace(-8.0, 8.0, points)
    both = stats.multivariate_normal(cov=[[1.0, r], [r, 1.0]])
    weight = both.pdf(np.stack(np.meshgrid(z, z, indexing="ij"), axis=-1))
    weight /= weight.sum()
    x = 2 * np.pi * (special.ndtr(z) - 0.5)
    y = np.sin(x)[:, None] * (1 + 0.1 * x**4)
    centred = weight * (y - (weight * y).sum())
    given = [(centred.sum(axis=i) ** 2 / weight.sum(axis=i)).sum() for i in (1, 0)]
    whole = (centred**2 / weight).sum()

    def explained(subset):
        of_both = {(): 0.0, (0,): given[0], (2,): given[1], (0, 2): whole}
        return of_both[tuple(sorted(set(subset) - {1}))] + 49 / 8 * (1 in subset)

    return dict(zip(NAMES[:3], shares(explained, 3).tolist(), strict=True))


def _mirrored(matrix):
    mirrored = matrix.copy()
    mirrored[0, 1] = mirrored[1, 0] = -matrix[0, 1]
    return mirrored
