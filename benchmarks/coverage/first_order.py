"""Shares that inputs explain alone, of plain samples: bias of four estimators, and coverage."""

import numpy as np
from scipy import special, stats
from scipy.stats import qmc

from benchmarks.coverage.tally import Tally
from uq.assess.answer.rankings import unexplained
from uq.indices.index import S1, RefusedError
from uq.indices.measures import first_order
from uq.indices.method import DesignSample
from uq.indices.methods import METHODS
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.intervals import scatter_interval

ROWS = (100, 300, 1000, 4000)
COUNTED = 2
"""Inputs, the first ones, whose own share is counted."""

SLICES = 20
BALANCE = "random balance, scatter of 8 parts"
LEFT = "no single input explains"
RANK = "rank statistic (Gamboa et al. 2022)"
RATIO = f"correlation ratio, {SLICES} slices (Kelley 1935)"

_MID = (np.arange(200_000) + 0.5) / 200_000


def _normal(u):
    return special.ndtri(u)


def _added(*parts):
    """Return a sum of functions of one uniform number each, and their shares."""
    variances = [np.var(part(_MID)) for part in parts]

    def output(u):
        return sum(part(column) for part, column in zip(parts, u.T, strict=True))

    return output, len(parts), tuple(np.array(variances) / sum(variances))


def _scaled(by, function=_normal):
    return lambda u: by * function(u)


def _ishigami(u):
    x1, x2, x3 = (np.pi * (2 * column - 1) for column in u.T)
    return np.sin(x1) + 7 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1)


def _g_function(u):
    a = np.array([0.0, 1.0, 4.5, 9.0, 99.0])
    return np.prod((np.abs(4 * u - 2) + a) / (1 + a), axis=1)


def _product(u):
    return _normal(u[:, 0]) * _normal(u[:, 1]) + 0.3 * _normal(u[:, 2])


def _unequal(u):
    return u[:, 0] + 2 * u[:, 0] * _normal(u[:, 1])


def _event(u):
    return (u[:, 0] + u[:, 1] > 1.6) * 1.0


def _ramp(u):
    return (u[:, 1] < 3 * (1 - u[:, 0])) * 1.0


def _of_event(first, second):
    """Return the shares of two inputs of an event, from its probability given each."""
    p = np.mean(first)
    return np.var(first) / (p * (1 - p)), np.var(second) / (p * (1 - p))


_DEFECT = np.sqrt(0.09 * 1.5 / (0.03 * 0.97))
_WEAR = _added(_scaled(-0.5), _scaled(0.1))
_OF_G = 1 / 3 / (1 + np.array([0.0, 1.0, 4.5, 9.0, 99.0])) ** 2
_CORNER = np.clip(_MID - 0.6, 0, 1)

PROBLEMS = {
    "exponential wear": _WEAR,
    "a rare defect, 3 %": _added(lambda u: -_DEFECT * (u < 0.03), _scaled(0.3), _scaled(0.02)),
    "-a^2 + 0.6 b + 0.1 c + 0.3 e": _added(
        lambda u: -(_normal(u) ** 2), _scaled(0.6), _scaled(0.1), _scaled(0.3)
    ),
    "-0.5 a^2 + 0.62 b": _added(lambda u: -0.5 * _normal(u) ** 2, _scaled(0.62), _scaled(0.02)),
    "a step at the middle": _added(lambda u: (u > 0.5) * 1.0, lambda u: 0.2 * u),
    "a step at a tenth": _added(lambda u: (u > 0.1) * 1.0, lambda u: u),
    "five stairs": _added(lambda u: np.floor(5 * u), _normal),
    "one wave, little else": _added(lambda u: np.sin(2 * np.pi * u), _scaled(0.1)),
    "three waves": _added(lambda u: np.sin(6 * np.pi * u), _scaled(0.5), _scaled(0.1)),
    "twenty waves": _added(lambda u: np.sin(40 * np.pi * u), _scaled(0.5)),
    "a jump in 0.5 % of the rows": _added(lambda u: (u < 0.005) * 5.0, lambda u: u),
    "a narrow bump": _added(lambda u: 3 * np.exp(-(((u - 0.6) / 0.02) ** 2)), _scaled(0.3)),
    "a kink": _added(lambda u: np.abs(u - 0.3), _scaled(0.1)),
    "the power 8": _added(lambda u: u**8, _scaled(0.1)),
    "an exponential input": _added(lambda u: -np.log1p(-u), _scaled(0.5)),
    "a lognormal input": _added(lambda u: np.exp(0.5 * _normal(u)), _scaled(0.3)),
    "the logarithm of a uniform input": _added(np.log, _scaled(0.3)),
    "uniform inputs": _added(*(lambda u, k=k: k * u for k in (4.0, 3.0, 2.0, 1.0))),
    "Ishigami": (_ishigami, 3, (0.313905, 0.442411, 0.0)),
    "the g-function": (
        _g_function,
        5,
        tuple(_OF_G / (np.prod(1 + _OF_G) - 1)),
    ),
    "a product and 0.3 c": (_product, 3, (0.0, 0.0, 0.09 / 1.09)),
    "unequal scatter": (_unequal, 2, (1 / 17, 12 / 17)),
    "an event of 8 %": (_event, 2, _of_event(_CORNER, _CORNER)),
    "a ramp's event": (_ramp, 2, _of_event(np.minimum(1, 3 * (1 - _MID)), 1 - _MID / 3)),
    "values of a die": (
        lambda u: (np.ceil(6 * u[:, 0]) - 3.5) ** 2 + _normal(u[:, 1]),
        2,
        (
            np.var((np.arange(1, 7) - 3.5) ** 2) / (1 + np.var((np.arange(1, 7) - 3.5) ** 2)),
            1 / (1 + np.var((np.arange(1, 7) - 3.5) ** 2)),
        ),
    ),
}
"""Name -> output of uniform numbers, how many there are, and the share of each."""

TIED = {"values of a die": lambda u: np.column_stack([np.ceil(6 * u[:, 0]), u[:, 1:]])}
"""What the first inputs are where they are not the uniform numbers themselves."""


def rows(n, repetitions):
    """Count the intervals of independent rows, and the errors of other estimators."""
    lines = []
    for name, (output, d, shares) in PROBLEMS.items():
        tally = Tally(f"first-order, {name}, {n} independent rows", REASONS)
        for seed in range(repetitions):
            u = np.random.default_rng((n, seed)).random((n, d))
            y = output(u)
            if np.ptp(y) == 0:
                continue
            x = TIED.get(name, lambda u: u)(u)
            try:
                _count(tally, x, y, shares)
            except RefusedError:
                continue
            for i, share in enumerate(shares[:COUNTED]):
                quantity = f"S1 = {share:.3f}"
                by = np.nan, np.nan
                tally.add(quantity, share, *by, by=RANK, value=rank_statistic(x[:, i], y))
                tally.add(quantity, share, *by, by=RATIO, value=correlation_ratio(x[:, i], y))
                value = float(first_order(x[:, i : i + 1], y)[0])
                if n >= 512:
                    parts = [first_order(x[k::8, i : i + 1], y[k::8])[0] for k in range(8)]
                    by = scatter_interval(value, np.array(parts))
                tally.add(quantity, share, *by, by=BALANCE, value=value)
        lines += tally.lines()
    return lines


def _count(tally, x, y, shares, dependence=INDEPENDENT):
    inputs = {str(i): x[:, i] for i in range(x.shape[1])}
    sample = DesignSample.plain(y, inputs, dependence=dependence, nulls=False)
    indices = METHODS["first-order"].indices(sample)
    for i, share in enumerate(shares[:COUNTED]):
        index = indices.values[S1][str(i)]
        tally.add(f"S1 = {share:.3f}", share, index.low, index.high, value=index.value)
    left = 1 - sum(shares)
    alone = unexplained(indices)
    tally.add(f"{LEFT} = {left:.3f}", left, alone.low, alone.high, value=alone.value)


def replicates(repetitions):
    """Count the intervals from replicates of designs whose rows depend on each other."""
    designs = {
        "sobol": lambda d, seed: qmc.Sobol(d, seed=seed).random(64),
        "latin-hypercube": lambda d, seed: qmc.LatinHypercube(d, seed=seed).random(64),
    }
    lines = []
    for design, draw in designs.items():
        for name in ("exponential wear", "a step at a tenth", "Ishigami", "uniform inputs"):
            output, d, shares = PROBLEMS[name]
            tally = Tally(f"first-order, {name}, {design}, 8 replicates of 64 rows", WIDE)
            for seed in range(repetitions):
                u = np.concatenate([draw(d, 8 * seed + k) for k in range(8)])
                u = np.clip(u, 1e-12, 1 - 1e-12)
                try:
                    _count(tally, u, output(u), shares, Dependence(np.repeat(np.arange(8), 64)))
                except RefusedError:
                    continue
            lines += tally.lines()
    return lines


def rank_statistic(x, y):
    """Return S1 by the output of the next row in the order of the input."""
    ordered = y[np.argsort(x, kind="stable")]
    return float((np.mean(ordered * np.roll(ordered, -1)) - y.mean() ** 2) / y.var())


def correlation_ratio(x, y):
    """Return S1 by means in slices, without the bias of their noise."""
    number = (stats.rankdata(x, method="ordinal").astype(int) - 1) * SLICES // len(y)
    means = np.bincount(number, y) / np.bincount(number)
    within = np.sum((y - means[number]) ** 2) / (len(y) - SLICES)
    return float(1 - within / y.var(ddof=1))


FEW = (
    "the error rests on few rows of a skewed law, or nothing shows what decides: jumps in 0.5 % of"
    " the rows, waves of 15 rows; of fewer than 200 rows there is no interval"
)
REASONS = {"S1": FEW, LEFT: FEW}
EVENLY = "conservative: the interval of independent rows, of designs that spread more evenly"
WIDE = {"S1": EVENLY, LEFT: EVENLY}
