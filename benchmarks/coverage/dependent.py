"""Shapley effects of dependent inputs, in closed form: normal and two-valued ones, and their sum.

y = x1 + x2 + 2 x3, all standard normal; x2 is correlated with x3, and x1 with x4, which the model
does not use. The same with x1 x3 added. Or y = x1 + x2 + x3, with x1 and x2 either -1 or 1, and all
three correlated.
"""

from functools import cache
from itertools import combinations
from math import factorial
from typing import Annotated, NamedTuple

import numpy as np
from scipy import stats
from scipy.spatial import cKDTree

from benchmarks.coverage.problems import Settings, indices_of, repeated, study_of
from benchmarks.coverage.tally import Tally
from uq.contract import Model, Output, Parameter
from uq.intervals import scatter_interval

NAMES = ("x1", "x2", "x3", "x4")
WEIGHTS = np.array([1.0, 1.0, 2.0, 0.0])
CORRELATIONS = (0.0, 0.3, 0.6, 0.9)
NORMAL = {"distribution": "normal", "mean": 0.0, "sd": 1.0}
SIGN = {"distribution": "discrete-choice", "values": [-1.0, 1.0]}
SIGNED = {"x1": SIGN, "x2": SIGN, "x3": NORMAL}
AMONG_SIGNS = np.array([[1.0, 0.7, 0.5], [0.7, 1.0, -0.2], [0.5, -0.2, 1.0]])
"""Of the normal variables behind two signs and a number."""


def _number(symbol):
    return Parameter(symbol, "1", "a number", (-1e3, 1e3), "definition of the problem")


class Inputs(NamedTuple):
    """Inputs of the sums."""

    x1: Annotated[float, _number("x_1")] = 0.0
    x2: Annotated[float, _number("x_2")] = 0.0
    x3: Annotated[float, _number("x_3")] = 0.0
    x4: Annotated[float, _number("x_4")] = 0.0


def _batch(x, seed, settings):
    x1, x2, x3, _ = np.ascontiguousarray(x.T)
    weighted = x1 + x2 + 2 * x3
    found = {"weighted": weighted, "interacting": weighted + x1 * x3, "sum": x1 + x2 + x3}
    return found, np.zeros(len(x), np.int8)


SUMS = Model(
    "sums",
    "Sums of dependent inputs",
    "1",
    Inputs,
    Settings,
    {
        "weighted": Output("1", "x1 + x2 + 2 x3"),
        "interacting": Output("1", "x1 + x2 + 2 x3 + x1 x3"),
        "sum": Output("1", "x1 + x2 + x3"),
    },
    _batch,
    block=1024,
)
NAME = "benchmarks.coverage.dependent:SUMS"


def shares(value, d):
    """Return Shapley's shares of a value of sets of inputs.

    L. S. Shapley, "A value for n-person games", Contributions to the Theory of Games 2 (1953).
    """
    found = np.zeros(d)
    for i in range(d):
        others = [j for j in range(d) if j != i]
        for k in range(d):
            weight = factorial(k) * factorial(d - k - 1) / factorial(d)
            for some in combinations(others, k):
                found[i] += weight * (value((*some, i)) - value(some))
    return found / value(range(d))


def matrix(r):
    """Return the correlations of the normal inputs."""
    found = np.eye(4)
    found[1, 2] = found[2, 1] = found[0, 3] = found[3, 0] = r
    return found


def ranks(correlations):
    """Return the rank correlations of normal variables with some correlations."""
    found = 6 / np.pi * np.arcsin(np.asarray(correlations) / 2)
    np.fill_diagonal(found, 1.0)
    return found.tolist()


def of_normal(r, interaction=0.0):
    """Return the Shapley effects of the weighted sum, and of it with x1 x3 times a factor added.

    Of normal inputs with covariances C, b'x + x'Ax has Var(E[y | x_u]) = b'Qb + 2 tr(AQAQ), where
    Q = C_u C_uu^-1 C_u'; for the linear part see Owen & Prieur (2017), Gaussian variables.
    """
    c, a = matrix(r), np.zeros((4, 4))
    a[0, 2] = a[2, 0] = interaction / 2

    def explained(some):
        some = list(some)
        if not some:
            return 0.0
        q = c[:, some] @ np.linalg.solve(c[np.ix_(some, some)], c[some])
        return float(WEIGHTS @ q @ WEIGHTS + 2 * np.trace(a @ q @ a @ q))

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
    joint = np.stack([given[one] * density for one in signs])  # (4, points)
    y = np.array([a + b for a, b in signs])[:, None] + z
    cells = {
        (): np.zeros((4, points), int),
        (0,): np.array([[a] * points for a, _ in signs]),
        (1,): np.array([[b] * points for _, b in signs]),
        (0, 1): np.array([[2 * a + b] * points for a, b in signs]),
    }

    def explained(some):
        some = tuple(sorted(some))
        cell = cells[tuple(i for i in some if i < 2)] * 10_000
        cell = cell + np.arange(points) if 2 in some else cell
        _, place = np.unique(cell, return_inverse=True)
        weight, total = (np.bincount(place.ravel(), w.ravel()) for w in (joint, joint * y))
        weight, total = (one[weight > 0] / joint.sum() for one in (weight, total))
        return float((total**2 / weight).sum() - total.sum() ** 2)

    return dict(zip(SIGNED, shares(explained, 3).tolist(), strict=True))


def _mirrored(matrix):
    found = matrix.copy()
    found[0, 1] = found[1, 0] = -matrix[0, 1]
    return found


def study(output, laws, correlations, samples, **design):
    """Return a study of Shapley effects of one of the sums."""
    dependence = {"parameters": list(laws), "rank_correlation": ranks(correlations)}
    return study_of(
        "shapley",
        samples,
        model=NAME,
        laws=laws,
        dependence=dependence,
        analysis={"outputs": [output]},
        **design,
    )


def shapley(repetitions):
    """Count the Shapley effects of dependent inputs."""
    lines = []
    laws = dict.fromkeys(NAMES, NORMAL)
    cases = [
        *((f"correlation {r:g}", "weighted", matrix(r), of_normal(r)) for r in CORRELATIONS),
        ("interaction", "interacting", matrix(0.6), of_normal(0.6, 1.0)),
        ("two signs and a number", "sum", AMONG_SIGNS, of_signs()),
    ]
    for words, output, correlations, truth in cases:
        own = SIGNED if output == "sum" else laws
        tally = Tally(f"dependent inputs, {words}, shapley, 512 paths of {len(own) + 1} rows")
        for ds in repeated(study(output, own, correlations, 512), repetitions):
            for method in ("shapley", "shapley-additive")[: 1 + (output == "interacting")]:
                entry = indices_of(ds, method)[output]["shapley"]
                for name, value in truth.items():
                    if value > 0:  # else it is zero in every path
                        tally.entry(f"{method} {name}", value, entry[name])
        lines += tally.lines()
    return lines


# Nearest neighbours -------------------------------------------------------------------------------

PARTS = 8
NEIGHBOURS = 3


def by_neighbours(x, y):
    """Estimate Shapley effects from independent rows: rows nearest in some inputs share these.

    B. Broto, F. Bachoc, M. Depecker, "Variance reduction for estimation of Shapley effects and
    adaptation to unknown input distribution", SIAM/ASA J. Uncertain. Quantif. 8, 693-716 (2020).
    """
    d = x.shape[1]
    left = {(): y.var(ddof=1), tuple(range(d)): 0.0}
    for size in range(1, d):
        for some in combinations(range(d), size):
            _, near = cKDTree(x[:, some]).query(x[:, some], NEIGHBOURS)
            left[some] = y[near].var(axis=1, ddof=1).mean()
    return shares(lambda some: left[()] - left[tuple(sorted(some))], d)


def neighbours(repetitions):
    """Count the intervals of nearest neighbours, by Student's t of parts of as many rows."""
    lines = []
    cases = [
        *((f"correlation {r:g}", r, 0.0) for r in CORRELATIONS),
        ("interaction", 0.6, 1.0),
    ]
    for words, r, interaction in cases:
        tally = Tally(f"dependent inputs, {words}, shapley, 512 paths of 5 rows")
        truth, factor = of_normal(r, interaction), np.linalg.cholesky(matrix(r))
        for seed in range(repetitions):
            x = np.random.default_rng(seed).standard_normal((512 * 5, 4)) @ factor.T
            y = x @ WEIGHTS + interaction * x[:, 0] * x[:, 2]
            found = np.array([by_neighbours(x[i::PARTS], y[i::PARTS]) for i in range(PARTS)])
            for name, one in zip(NAMES, found.T, strict=True):
                ends = scatter_interval(one.mean(), one)
                by = f"nearest neighbours in {PARTS} parts"
                if truth[name] > 0:
                    tally.add(f"shapley {name}", truth[name], *ends, by)
        lines += tally.lines()
    return lines
