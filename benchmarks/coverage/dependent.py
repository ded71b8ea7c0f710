"""Shapley effects of dependent inputs, in closed form: of sums, a product and an exponential.

y = x1 + x2 + 2 x3, all standard normal; x2 is correlated with x3, and x1 with x4, which the model
does not use. The same with x1 x3 added, or e to the power of a sixth or half of y; or all four
exponential, correlated in the same way. Or y = x1 + x2 + x3, with x1 and x2 either -1 or 1, and all
three correlated.
"""

from dataclasses import replace
from functools import cache
from itertools import combinations
from math import factorial
from typing import Annotated, NamedTuple

import numpy as np
from scipy import special, stats

from benchmarks.coverage.problems import Settings, indices_of, repeated, study_of
from benchmarks.coverage.tally import Tally
from uq.contract import Model, Output, Parameter
from uq.indices.samples import sample_of
from uq.methods.indices import SHAPLEY
from uq.methods.registry import METHODS

NAMES = ("x1", "x2", "x3", "x4")
WEIGHTS = np.array([1.0, 1.0, 2.0, 0.0])
CORRELATIONS = (0.0, 0.3, 0.6, 0.9)
MILD, STEEP = 1 / 6, 1 / 2
NORMAL = {"distribution": "normal", "mean": 0.0, "sd": 1.0}
EXPONENTIAL = {"distribution": "exponential", "mean": 1.0}
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
    found = {
        "weighted": weighted,
        "interacting": weighted + x1 * x3,
        "mild": np.exp(MILD * weighted),
        "steep": np.exp(STEEP * weighted),
        "sum": x1 + x2 + x3,
    }
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
        "mild": Output("1", "e to the power of a sixth of x1 + x2 + 2 x3"),
        "steep": Output("1", "e to the power of half of x1 + x2 + 2 x3"),
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
        return sum(one * WEIGHTS @ q ** (n + 1) @ WEIGHTS for n, one in enumerate(squares))

    return _of_explained(matrix(r), variance)


def _of_explained(c, variance):
    """Return the effects where some inputs u explain a variance that C_u C_uu^-1 C_u' decides."""

    def explained(some):
        some = list(some)
        return variance(c[:, some] @ np.linalg.solve(c[np.ix_(some, some)], c[some])) if some else 0

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


def study(output, laws, correlations, samples, method="shapley"):
    """Return a study of one of the outputs."""
    dependence = {"parameters": list(laws), "rank_correlation": ranks(correlations)}
    return study_of(
        method,
        samples,
        model=NAME,
        laws=laws,
        dependence=dependence,
        analysis={"outputs": [output]},
    )


EXACT = "exact: the output is a polynomial in the normal scores, and its effects a formula"
FAR = "conservative: few paths far out hold most of the errors, and their leverage widens intervals"
TAIL = "few paths hold most of the variance; by default the indices are those of the logarithm"


class Case(NamedTuple):
    """A problem.

    Attributes
    ----------
    output : str
    laws : dict
    correlations : ndarray
        Of normal scores.
    truth : dict of str to float
    reason : str
        Why the coverage is off, or "".
    """

    output: str
    laws: dict
    correlations: np.ndarray
    truth: dict
    reason: str = ""


BELLS, DECAYS = dict.fromkeys(NAMES, NORMAL), dict.fromkeys(NAMES, EXPONENTIAL)
CASES = {
    **{
        f"correlation {r:g}": Case("weighted", BELLS, matrix(r), of_normal(r), EXACT)
        for r in CORRELATIONS
    },
    "interaction": Case("interacting", BELLS, matrix(0.6), of_normal(0.6, 1.0), EXACT),
    **{
        f"exponential, correlation {r:g}": Case(
            "weighted", DECAYS, matrix(r), of_exponential(r), FAR
        )
        for r in CORRELATIONS
    },
    "mild lognormal": Case("mild", BELLS, matrix(0.6), of_lognormal(0.6, MILD), FAR),
    "steep lognormal": Case("steep", BELLS, matrix(0.6), of_lognormal(0.6, STEEP), TAIL),
    "two signs and a number": Case("sum", SIGNED, AMONG_SIGNS, of_signs()),
}
PATHS = 512
REFUSED = dict.fromkeys(NAMES, {"low": None, "high": None})
ALONE = "paths without polynomials"


def of_paths_alone(ds, output):
    """Return the Shapley effects of a result that its paths show, without a control variate."""
    sample = sample_of(ds)
    none = np.full_like(sample.scores, np.nan)
    sample = replace(sample, values=ds[output].values, scores=none)
    return METHODS["shapley"].indices(sample).values[SHAPLEY]


def title(words, rows):
    """Return what a table of some case is called."""
    return f"dependent inputs, {words}, shapley, {PATHS} paths of {rows} rows"


def shapley(repetitions, cases=CASES):
    """Count the Shapley effects of dependent inputs."""
    lines = []
    for words in cases:
        case = CASES[words]
        tally = Tally(title(words, len(case.laws) + 1), {"shapley": case.reason})
        of = study(case.output, case.laws, case.correlations, PATHS)
        for ds in repeated(of, repetitions):
            ours = indices_of(ds, output=[case.output])[case.output].get("shapley", REFUSED)
            alone = of_paths_alone(ds, case.output)
            for name, value in case.truth.items():
                if value > 0:  # else it is zero in every path
                    tally.entry(f"shapley {name}", value, ours[name])
                    tally.estimate(f"shapley {name}", value, alone[name], ALONE)
        lines += tally.lines()
    return lines
