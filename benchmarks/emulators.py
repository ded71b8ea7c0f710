"""Emulators of functions with known answers, beside plain rows, OpenTURNS alone and scikit-learn.

``python -m benchmarks.emulators [REPETITIONS]`` prints two tables: errors of predictions, and the
coverage and width of intervals, from as many repetitions with 100 rows, half of them with 200 and a
quarter with 400. scikit-learn is left out where it is not installed.
"""

import sys
from functools import cache, partial
from importlib.util import find_spec
from itertools import combinations

import numpy as np
import openturns as ot
from scipy.special import ndtri
from scipy.stats import qmc

from uq.assess.emulate import Refused, check
from uq.indices.expansions import chaos_indices
from uq.indices.first_order import first_order_indices
from uq.indices.index import S1, S2, ST
from uq.indices.method import DesignSample
from uq.machines.emulator import inputs_of, parts_of
from uq.stats.control_variate import controlled_mean, controlled_share
from uq.stats.estimate import Estimate
from uq.stats.intervals import mean_interval, share_interval
from uq.stats.moments import moments
from uq.stats.regressions import FOLDS, Predictor, regress, scale_of, scaled

ROWS = (100, 200, 400)
NEW = 2000
PER_ROW = 100
EXACT = 2**19


def ishigami(x):
    """Return Ishigami's function of x pi."""
    x1, x2, x3 = np.pi * x.T
    return np.sin(x1) + 7 * np.sin(x2) ** 2 + 0.1 * x3**4 * np.sin(x1)


def g_function(x):
    """Return the g-function with a kink in each input."""
    return np.prod([(abs(2 * x[:, i]) + a) / (1 + a) for i, a in enumerate((0, 1, 4.5, 9))], 0)


def ratio(x):
    """Return a smooth ratio of two uniform inputs, times an exponential of a normal one."""
    return (2 + x[:, 0]) / (1.5 + x[:, 1]) ** 2 * np.exp(0.3 * x[:, 2])


def product(x):
    """Return a lognormal product with an interaction."""
    return np.exp(0.5 * x[:, 0] + 0.3 * x[:, 1] - 0.2 * x[:, 2] * x[:, 3])


def noisy(x):
    """Return a sum with noise that no input explains: 5 % of the variance."""
    bits = np.ascontiguousarray(x).view(np.uint64).sum(axis=1) * np.uint64(0x9E3779B97F4A7C15)
    u = ((bits ^ (bits >> np.uint64(31))) >> np.uint64(11)) * 2.0**-53
    return x[:, 0] + x[:, 1] ** 2 + (u - 0.5) * 0.5


def jump(x):
    """Return a slope with a jump across a curve."""
    return x[:, 0] + 1.5 * (x[:, 1] > x[:, 2] ** 2 - 0.3)


UNIFORM, NORMAL = "uniform", "normal"
FUNCTIONS = {
    ishigami: (UNIFORM,) * 3,
    g_function: (UNIFORM,) * 4,
    ratio: (UNIFORM, UNIFORM, NORMAL),
    product: (NORMAL,) * 5,
    noisy: (UNIFORM,) * 3,
    jump: (UNIFORM,) * 3,
}
"""Function -> laws of its inputs, on [-1, 1] or standard normal."""


def inputs(laws, u):
    """Return inputs of points of the unit cube."""
    columns = [2 * c - 1 if law == UNIFORM else ndtri(c) for law, c in zip(laws, u.T, strict=True)]
    return np.column_stack(columns)


@cache
def truth(function):
    """Return mean, 95 % quantile as limit, P(y > limit) and Sobol' indices by quasi-Monte Carlo."""
    laws = FUNCTIONS[function]
    d = len(laws)
    u = np.clip(qmc.Sobol(2 * d, seed=1).random(EXACT), 1e-12, 1 - 1e-12)
    a, b = inputs(laws, u[:, :d]), inputs(laws, u[:, d:])
    ya, yb = function(a), function(b)
    both = np.concatenate([ya, yb])
    values = {"mean": float(both.mean()), "P": 0.05}

    def exchanged(*inputs):
        mixed = a.copy()
        mixed[:, inputs] = b[:, inputs]
        return function(mixed)

    def closed(*inputs):
        return float(np.mean((yb - both.mean()) * (exchanged(*inputs) - ya)) / both.var())

    for i in range(d):
        values[f"S1 {i}"] = max(closed(i), 0.0)
        values[f"ST {i}"] = float(np.mean((ya - exchanged(i)) ** 2) / 2 / both.var())
    for i, j in combinations(range(d), 2):
        pair = closed(i, j) - values[f"S1 {i}"] - values[f"S1 {j}"]
        values[f"S2 {i},{j}"] = max(pair, 0.0)
    return values, float(np.quantile(both, 0.95))


def scikit_learn(x, y):
    """Return the predictor of scikit-learn's Gaussian process, a Matern 5/2 kernel."""
    from sklearn.gaussian_process import GaussianProcessRegressor
    from sklearn.gaussian_process.kernels import ConstantKernel, Matern

    kernel = ConstantKernel(1.0) * Matern(np.ones(x.shape[1]), (1e-2, 1e2), nu=2.5)
    model = GaussianProcessRegressor(kernel, normalize_y=True, alpha=1e-8)
    return model.fit(x, y).predict


def openturns_alone(x, y):
    """Return the predictor of OpenTURNS' polynomial chaos with its default choices."""
    algorithm = ot.FunctionalChaosAlgorithm(ot.Sample(x), ot.Sample(y[:, None]))
    algorithm.run()
    model = algorithm.getResult().getMetaModel()
    return lambda new: np.array(model(ot.Sample(new)))[:, 0]


PEERS = {"OpenTURNS alone": openturns_alone}
if find_spec("sklearn"):
    PEERS["scikit-learn"] = scikit_learn


def fitted(x, y):
    """Return the regression, scaled inputs, parts and laws that `uq emulate` uses."""
    scales = [scale_of(str(i), column) for i, column in enumerate(x.T)]
    rows = inputs_of(scales, x)
    regression = regress(rows, y, np.arange(len(y)))
    predictor = Predictor(regression, rows)
    return regression, predictor, partial(scaled, scales), rows.parts


def errors(repetitions):
    """Print the errors of predictions over the standard deviation of the output."""
    print("| function | rows | kind | stated | true |", *(f" {p} |" for p in PEERS), sep="")
    print("|---|---|---|---|---|" + "---|" * len(PEERS))
    for function, laws in FUNCTIONS.items():
        for n in ROWS:
            table, kinds = [], []
            for seed in range(repetitions * ROWS[0] // n):
                rng = np.random.default_rng((seed, n))
                x, new = (inputs(laws, rng.random((k, len(laws)))) for k in (n, NEW))
                y, expected = function(x), function(new)
                regression, predictor, scale, _ = fitted(x, y)
                predictions = [predictor(scale(new))[0], *(p(x, y)(new) for p in PEERS.values())]
                true = [np.sqrt(np.mean((p - expected) ** 2)) / expected.std() for p in predictions]
                table.append([regression.error_sd / y.std(), *true])
                kinds.append(regression.kind)
            most = max(set(kinds), key=kinds.count)
            cells = " | ".join(f"{100 * error:.2g} %" for error in np.median(table, axis=0))
            print(f"| {function.__name__} | {n} | {most} | {cells} |", flush=True)


def is_refused(regression):
    """Return whether `uq emulate` refuses a regression."""
    try:
        check(regression)
    except Refused:
        return True
    return False


def estimates(function, n, seed):
    """Return estimates of one repetition: quantity -> method -> Estimate.

    The many predictions of a peer are treated as rows, as its user would: it states no interval.
    """
    laws, limit = FUNCTIONS[function], truth(function)[1]
    rng = np.random.default_rng((seed, n, 1))
    x, many = (inputs(laws, rng.random((k, len(laws)))) for k in (n, PER_ROW * n))
    y = function(x)
    methods = {"uq": with_emulator(x, y, many, limit), "rows alone": alone(y, limit)}
    for name, peer in PEERS.items():
        methods[name] = alone(peer(x, y)(many), limit)
    table = {quantity: {m: e[quantity] for m, e in methods.items()} for quantity in ("mean", "P")}
    table["refused"] = methods["uq"]["refused"]
    names = [str(i) for i in range(len(laws))]
    sample = DesignSample.plain(
        y,
        dict(zip(names, x.T, strict=True)),
        normal={
            name: (lambda v: ndtri((v + 1) / 2)) if law == UNIFORM else (lambda v: v)
            for name, law in zip(names, laws, strict=True)
        },
    )
    by_chaos, by_rows = chaos_indices(sample).values, first_order_indices(sample).values
    for name in names:
        table[f"S1 {name}"] = {"uq": by_chaos[S1][name], "rows alone": by_rows[S1][name]}
        table[f"ST {name}"] = {"uq": by_chaos[ST][name]}
    return table | {f"S2 {pair}": {"uq": by_chaos[S2][pair]} for pair in by_chaos[S2]}


def coverage(repetitions, rows=ROWS):
    """Print how often intervals cover, and their median width over that of the rows alone."""
    methods = ["uq", "rows alone", *PEERS]
    columns = [(quantity, method) for quantity in ("mean", "P") for method in methods]
    columns += [("S1", "uq"), ("S1", "rows alone"), ("ST", "uq"), ("S2", "uq")]
    print("| function | rows | refused |", *(f" {q}, {m} |" for q, m in columns), sep="")
    print("|---|---|---|" + "---|" * len(columns))
    for function in FUNCTIONS:
        for n in rows:
            count = max(repetitions * ROWS[0] // n, 1)
            tables = [estimates(function, n, seed) for seed in range(count)]
            cells = [cell(function, tables, *column) for column in columns]
            refused = f"{sum(table['refused'] for table in tables)} of {count}"
            print(f"| {function.__name__} | {n} | {refused} | {' | '.join(cells)} |", flush=True)


def cell(function, tables, quantity, method):
    """Return the coverage and width of intervals over the tables of repetitions.

    Indices are counted together over all inputs.
    """
    (exact, _), held, widths = truth(function), [], []
    for table in tables:
        for name, by_method in table.items():
            if name.split()[0] == quantity and by_method[method].has_interval:
                estimate = by_method[method]
                held.append(estimate.low <= exact[name] <= estimate.high)
                reference = by_method["rows alone"] if quantity in ("mean", "P") else None
                width = estimate.high - estimate.low
                widths.append(width / (reference.high - reference.low) if reference else width)
    return f"{100 * np.mean(held):.0f} %, {np.median(widths):.2g}" if held else "none"


def alone(y, limit):
    """Return the mean and the share beyond a limit of values as of independent rows."""
    mean = moments(y).mean
    hits = y > limit
    return {
        "mean": mean if mean.has_interval else Estimate(mean.value, *mean_interval(y)),
        "P": Estimate(hits.mean(), *share_interval(hits)),
    }


def with_emulator(x, y, many, limit):
    """Return the mean and the share beyond a limit with an emulator as control variate.

    Also whether `uq emulate` would refuse it.
    """
    regression, predictor, scale, parts = fitted(x, y)
    here = predictor.cross_fitted(scale(x), parts)
    there = predictor.cross_fitted(scale(many), parts_of(many))
    kept, hits = np.ones(len(y), bool), y > limit
    controls = [np.stack([c, np.zeros(len(c))], axis=1) for c in (here, there)]
    return {
        "mean": controlled_mean(y, kept, controls=controls[0], many=controls[1], parts=FOLDS)[0],
        "P": controlled_share(hits, kept, control=here, many=there)[0],
        "refused": is_refused(regression),
    }


if __name__ == "__main__":
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 100
    errors(max(count // 5, 5))
    print()
    coverage(count)
