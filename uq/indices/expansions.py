"""Sensitivity indices from expansions: extended FAST, HDMR, polynomial chaos."""

import warnings
from collections.abc import Callable, Mapping
from functools import cache, partial
from importlib.util import find_spec, module_from_spec
from itertools import combinations
from math import floor
from typing import Any

import numpy as np
import scipy  # which imports scipy.linalg when it is first used
from numpy.linalg import matrix_rank, pinv
from scipy.special import ndtr

from uq.contract import Floats
from uq.indices.index import ALL_NOISE, S1, S2, SHAPLEY, ST, IndexKind, Indices, Null, RefusedError
from uq.indices.method import DesignSample
from uq.sampling.unit_cube import HARMONICS
from uq.stats.estimate import Estimate
from uq.stats.intervals import is_constant, upper_probability
from uq.stats.moments import OUTLYING_SQUARES
from uq.stats.quantile_functions import student
from uq.stats.regressions import components, fit_chaos, standard_moment

EXPLAINED = 0.8
"""Smallest explained share of the held-out variance for which an expansion is accepted."""

_DEGREES = (2, 4, 6, 8)  # and the highest degree that an input with few values allows
_ENOUGH = 0.99
_LEAST_VALUES = 10
_MIN_ROWS = 600  # SALib accepts no fewer than the 300 that are not held out
_MOST_ROWS = 2048
_TERMS_PER_ROW = 0.8
_MOST_TERMS = 500


def fast_indices(sample: DesignSample) -> Indices:
    """Estimate first-order and total indices by extended FAST.

    Parameters
    ----------
    sample : DesignSample
        Sample of curves, one for each input.

    Returns
    -------
    Indices
        ``S1`` and ``ST``, means over replicates, without intervals. The notes report the scatter
        between replicates. It does not include the error of representing an input by a few
        harmonics, which is many times larger for the Ishigami function. For a random model they are
        shares of the mean variance at one seed: curves are weighted by their variance.

    Raises
    ------
    RefusedError
        An input has no complete curve, or the output is constant.

    References
    ----------
    A. Saltelli, S. Tarantola, K. P.-S. Chan, "A quantitative model-independent method for global
    sensitivity analysis of model output", Technometrics 41, 39-56 (1999).
    """
    y, whole = sample.grouped, sample.whole
    parameters = [label.removeprefix("curve_") for label in sample.blocks]
    for name, complete in zip(parameters, whole.T, strict=True):
        if not complete.any():
            raise RefusedError(f"none of {len(whole)} curves for {name} has a value in each row")
    moves = np.array([[not sample.is_constant(curve) for curve in curves] for curves in y])
    if sample.random and not (moves & whole).any(axis=0).all():
        raise RefusedError(ALL_NOISE)
    if not sample.random and not moves[whole].all():
        raise RefusedError("the same value along a whole curve: there is no variance to apportion")
    points = y.shape[2]
    omega = floor((points - 1) / (2 * HARMONICS))
    # The estimator loses digits for values far from zero.
    y = y - y[whole].mean(axis=(0, 1))
    indices: dict[IndexKind, dict[str, Estimate]] = {S1: {}, ST: {}}
    scatter = dict.fromkeys(indices, 0.0)
    for i, name in enumerate(parameters):
        moving = y[whole[:, i] & moves[:, i], i]
        shares = np.array([_orders(curve, omega) for curve in moving])
        spread = moving.var(axis=1).reshape(len(moving), -1).sum(axis=1)
        weights = spread if sample.random else None
        for kind, column in zip(indices, shares.T, strict=True):
            indices[kind][name] = Estimate(float(np.average(column, weights=weights)))
            if len(column) > 1:
                scatter[kind] = max(scatter[kind], float(column.std(ddof=1)))
    deviations = " and ".join(f"{kind.key} by {sd:.2g}" for kind, sd in scatter.items() if sd)
    seen = f": between replicates {deviations} at most (standard deviation)" if deviations else ""
    notes = [
        "no intervals: the method's own error, from representing an input by a few harmonics, does"
        f" not show in the scatter{seen}"
    ]
    others, room = len(parameters) - 1, omega // (2 * HARMONICS)
    if room < others:
        needed = 4 * HARMONICS**2 * others + 1
        notes.append(
            f"{others} inputs share {room} frequencies; samples = {needed} would give each its own"
        )
    return Indices(indices, tuple(notes))


def _orders(curve: Floats, omega: int) -> Floats:
    """Return S1 and ST from the output along a curve, shape (points,) or (points, e).

    Indices of several elements are averaged with their variances as weights.
    """
    from SALib.analyze.fast import compute_orders

    elements = curve.reshape(len(curve), -1).T
    moving = elements[[not is_constant(element) for element in elements]]
    orders = [compute_orders(element, len(element), HARMONICS, omega) for element in moving]
    weights = moving.var(axis=1)
    return np.average(orders, axis=0, weights=weights / weights.sum())


def hdmr_indices(sample: DesignSample) -> Indices:
    """Estimate sensitivity indices by HDMR, an expansion in functions of one and two inputs.

    Parameters
    ----------
    sample : DesignSample
        Sample with independent inputs.

    Returns
    -------
    Indices
        ``S1``, ``S2``, ``ST`` and ``shapley``. The latter is S1 plus half of every S2 of the input:
        its Shapley effect if no three inputs interact [2]_. There are no intervals; the null is the
        index of one input without effect.

    Raises
    ------
    RefusedError
        There are too few values or rows, an input has a single value, or no polynomial degree
        explains enough of the held-out variance.

    References
    ----------
    .. [1] G. Li et al., "Global sensitivity analysis for systems with independent and/or
       correlated inputs", J. Phys. Chem. A 114, 6022-6032 (2010).
    .. [2] A. B. Owen, "Sobol' indices and Shapley value", SIAM/ASA J. Uncertainty Quantification
       2, 245-251 (2014).
    """
    x, y = sample.inputs, sample.values
    if len(np.unique(y)) < _LEAST_VALUES:
        raise RefusedError(
            f"the output takes fewer than {_LEAST_VALUES} values, and polynomials cannot represent"
            " it; use pawn"
        )
    if len(y) < _MIN_ROWS:
        raise RefusedError(
            f"only {len(y)} rows have a value; {_MIN_ROWS} are needed, half of them held out; chaos"
            " gives the same indices from fewer rows, with intervals"
        )
    n = min(len(y), _MOST_ROWS)
    names = [*x, ""]
    rng = np.random.default_rng(0)
    chosen = rng.permutation(len(y))[:n]  # imported rows may come in a meaningful order
    columns = np.column_stack([*(column[chosen] for column in x.values()), rng.random(n)])
    y = (y[chosen] - y[chosen].mean()) / y[chosen].std()
    degrees, least = _degrees(names, columns[: n // 2])
    degree, explained = _best(columns, y, degrees)
    if not degree:
        raise RefusedError(f"{n} rows are too few for the pairs of {len(x)} inputs")
    if explained < EXPLAINED:
        raise RefusedError(
            f"functions of one and of two inputs explain {max(explained, 0):.0%} of the variance of"
            f" rows held out; {EXPLAINED:.0%} are needed{least}"
        )
    share, k = np.ravel(_expansion(columns, y, degree)["S"]), len(names)
    second = dict(zip(combinations(range(k), 2), share[k:], strict=True))
    shared = np.array([sum(v for pair, v in second.items() if i in pair) for i in range(k)])
    kinds = {S1: share[:k], ST: share[:k] + shared, SHAPLEY: share[:k] + shared / 2}
    values = {
        kind: {name: Estimate(float(v)) for name, v in zip(x, shares, strict=False)}
        for kind, shares in kinds.items()
    }
    values[S2] = {
        f"{names[i]},{names[j]}": Estimate(float(v)) for (i, j), v in second.items() if names[j]
    }
    note = (
        f"polynomials of degree {degree} in one and in two inputs explain {explained:.1%} of the"
        " variance of rows held out; half of the inputs without effect exceed the null"
    )
    nulls = {kind: Null(float(shares[-1]), exceeded=0.5) for kind, shares in kinds.items()}
    return Indices(values, (note,), nulls)


_FOLDS = 5
_VARIANCES = 3.0  # largest ratio of the variance by expansions and that of the rows
_ROUNDING = 1e-12
_LONG_TAIL = 5.0  # kurtosis of an output that grows with normal inputs


def chaos_indices(sample: DesignSample) -> Indices:
    """Estimate sensitivity indices by polynomial chaos, corrected by the rows.

    Parameters
    ----------
    sample : DesignSample
        Plain sample with independent inputs of continuous laws.

    Returns
    -------
    Indices
        ``S1``, ``S2``, ``ST`` and ``shapley``, as the expansion explains them. The upper ends
        include the share that it does not explain, since this might be due to any input.

    Raises
    ------
    RefusedError
        An input is discrete, or without a stated law, or the expansion explains nothing.

    Notes
    -----
    The rows are divided into five parts. Inputs are scores of normal or uniform laws; polynomials
    of normal ones have a degree of 3 at most, since higher ones grow beyond the rows, where nothing
    corrects them. Uniform scores of all inputs are tried, too, unless the output has a long tail.
    The better expansion f of the rows of four parts [1]_ is a sum of
    uncorrelated components f_v, each of the inputs v alone. With r = y - f in the rows of the fifth
    part, which f does not know, the component of the output has the variance
    Var(f_v) + 2 E[f_v r] + e, and e lies between 0 and Var(r). The first two are means over rows
    without bias, whatever the expansion is worth. Their intervals are Student's for ratios, widened
    by further rows as influential as the most influential, as those of standard deviations: where
    an output has a long tail, few rows show how the expansion errs there. For a lognormal output of
    200 rows they cover in 97 % of cases, without this in 90 %.

    References
    ----------
    .. [1] B. Sudret, "Global sensitivity analysis using polynomial chaos expansions", Reliab. Eng.
       Syst. Saf. 93, 964-979 (2008).
    """
    if without := [name for name in sample.inputs if name not in sample.normal]:
        raise RefusedError(f"'{without[0]}' has no continuous law, which polynomials need")
    y, names = (sample.values - sample.values.mean()) / sample.values.std(), list(sample.inputs)
    standards = _standards(sample)
    n = len(y)
    part = np.random.default_rng(0).permutation(n) % _FOLDS
    explained: dict[tuple[int, ...], Floats] = {}
    total, error = np.empty(n), np.empty(n)
    for fold in range(_FOLDS):
        inside = part == fold
        fits = [(fit_chaos(z[~inside], y[~inside], flat), z, flat) for z, flat in standards]
        fit, z, flat = min(fits, key=lambda candidate: candidate[0]["error"])
        parts = components(fit, z[inside], flat)
        prediction = sum((values for _, values in parts.values()), np.zeros(inside.sum()))
        rest = y[inside] - prediction
        error[inside] = (rest - rest.mean()) ** 2
        for inputs, (variance, values) in parts.items():
            explained.setdefault(inputs, np.zeros(n))[inside] = variance + 2 * values * rest
        sums = [explained[inputs][inside] for inputs in parts if inputs]
        total[inside] = np.sum(sums, axis=0) + error[inside]
    if error.mean() > 1:
        raise RefusedError(
            f"polynomials leave {error.mean():.0%} of the variance of rows held out unexplained"
        )
    if not 1 / _VARIANCES < total.mean() < _VARIANCES:
        raise RefusedError(
            "expansions of parts of the rows and the rows themselves disagree on the variance by a"
            f" factor of {total.mean():.2g}: too few rows are where the output varies most"
        )
    explained.pop((), None)
    t = float(student(upper_probability(sample.confidence), n - 1))
    indices = {
        kind: {
            label: _between(_weighted(explained, weight, n), error, total, t)
            for label, weight in labels.items()
        }
        for kind, labels in _weights(names).items()
    }
    left = _between(np.zeros(n), error, total, t)
    note = (
        f"polynomial chaos leaves {100 * error.mean() / total.mean():.2g} % of the variance"
        f" unexplained, which the upper ends include ({100 * left.high:.2g} % at most)"
    )
    notes = [note]
    if standard_moment(sample.values, 4) > _LONG_TAIL:
        notes.append(
            "few rows of a long tail hold much of the variance: where the output bends there, the"
            " intervals may be too narrow; those of its logarithm are safer"
        )
    return Indices(indices, tuple(notes))


def _standards(sample: DesignSample) -> list[tuple[Floats, tuple[bool, ...]]]:
    """Return the inputs, shape (n, d), as scores of laws, and which of these are uniform.

    First all as uniform on [-1, 1], then as standard normal where these are nearer to linear.
    """
    scores = {name: sample.normal[name](values) for name, values in sample.inputs.items()}
    flat = {name: 2 * ndtr(normal) - 1 for name, normal in scores.items()}
    uniform = [
        abs(np.corrcoef(values, flat[name])[0, 1]) > abs(np.corrcoef(values, scores[name])[0, 1])
        for name, values in sample.inputs.items()
    ]
    choices = [tuple(map(bool, uniform))]
    if standard_moment(sample.values, 4) < _LONG_TAIL:
        choices.append((True,) * len(scores))
    standards = []
    for flags in dict.fromkeys(choices):
        pairs = zip(scores, flags, strict=True)
        columns = [(flat if is_flat else scores)[name] for name, is_flat in pairs]
        standards.append((np.column_stack(columns), flags))
    return standards


Weight = Callable[[tuple[int, ...]], float]
"""Positions of the inputs of a component -> the share of its variance in an index."""


def _weights(names: list[str]) -> dict[IndexKind, dict[str, Weight]]:
    """Return the weight of each component in each index."""

    def alone(i: int) -> Weight:
        return lambda inputs: float(inputs == (i,))

    def total(i: int) -> Weight:
        return lambda inputs: float(i in inputs)

    def shared(i: int) -> Weight:
        return lambda inputs: (i in inputs) / len(inputs)

    def pair(i: int, j: int) -> Weight:
        return lambda inputs: float(inputs == (i, j))

    singles = ((S1, alone), (ST, total), (SHAPLEY, shared))
    kinds = {kind: {n: weight(i) for i, n in enumerate(names)} for kind, weight in singles}
    pairs = combinations(range(len(names)), 2)
    return kinds | {S2: {f"{names[i]},{names[j]}": pair(i, j) for i, j in pairs}}


def _weighted(explained: Mapping[tuple[int, ...], Floats], weight: Weight, n: int) -> Floats:
    return sum((weight(inputs) * rows for inputs, rows in explained.items()), np.zeros(n))


def _between(explained: Floats, error: Floats, total: Floats, t: float) -> Estimate:
    """Return a ratio of means, with an interval from no error to all of it due to an input.

    The interval does not leave that from 0 to 1, to which indices belong, but contains the value.
    """
    value, low, _ = _ratio(explained, total, t)
    _, _, high = _ratio(explained + error, total, t)
    return Estimate(value, max(low, min(value, 0.0)), min(high, max(value, 1.0)))


def _ratio(part: Floats, total: Floats, t: float) -> tuple[float, float, float]:
    """Return a ratio of means with its interval, widened for rows that are far out and missing."""
    value = float(part.mean() / total.mean())
    influence = (part - value * total) / total.mean() / len(total)
    half = t * influence.std(ddof=1) * len(total) ** 0.5
    half += OUTLYING_SQUARES * np.abs(influence).max() + _ROUNDING
    return value, float(value - half), float(value + half)


def _best(x: Floats, y: Floats, degrees: tuple[int, ...]) -> tuple[int, float]:
    """Return the degree that explains most of the held-out variance (0: none), and its share."""
    half, k = len(y) // 2, x.shape[1]
    best, explained = 0, float("-inf")
    for degree in degrees:
        terms = k * degree + k * (k - 1) // 2 * degree**2
        if explained > _ENOUGH or terms > min(_TERMS_PER_ROW * half, _MOST_TERMS):
            break
        # SALib takes the ranges of the inputs from the given rows: here from all rows.
        expected = _expansion(x[:half], y[:half], degree).emulate(x)
        gain = float(1 - (y - expected)[half:].var() / y[half:].var())
        if not gain > explained:
            break  # more terms than the rows can identify
        best, explained = degree, gain
    return best, explained


def _degrees(names: list[str], x: Floats) -> tuple[tuple[int, ...], str]:
    """Return the degrees to try, and the reason for their limit: k values allow degree k - 1.

    Raises
    ------
    RefusedError
        An input has a single value.
    """
    counts = [len(np.unique(column)) for column in x.T]
    fewest, name = min(zip(counts, names, strict=True), key=lambda pair: pair[0])
    if fewest == 1:
        raise RefusedError(
            f"{name} has the same value in all of {len(x)} rows: no polynomial can be fitted"
        )
    if fewest > max(_DEGREES):
        return _DEGREES, ""
    allowed = (*(d for d in _DEGREES if d < fewest - 1), fewest - 1)
    return allowed, f" ({name} has {fewest} values, which allow no degree above {allowed[-1]})"


@cache
def _hdmr() -> Any:
    """Return a copy of SALib's module that keeps what follows from the inputs alone.

    Its basis and the matrices of its regression are the same for every output. It does without
    its test of each term, which nothing reads here, and so without ``scipy.stats``, whose import
    takes as long as the expansion.
    """
    spec = find_spec("SALib.analyze.enhanced_hdmr")
    assert spec is not None and spec.loader is not None, "SALib is installed"
    module: Any = module_from_spec(spec)
    unused = "stats" not in vars(scipy)
    if unused:
        vars(scipy)["stats"] = None
    try:
        spec.loader.exec_module(module)
    finally:
        if unused:
            del vars(scipy)["stats"]
    module._f_test = lambda *_: 0.0
    module._basis_matrix = _kept(module._basis_matrix)
    module._cost_matrix = _kept(partial(_regression, module._cost_matrix))
    module._d_morph = lambda basis, matrices, y, subset, _: (
        matrices[1] @ (matrices[0] @ ((basis.T @ y) / subset))
    )
    return module


def _regression(cost_matrix: Callable[..., Floats], basis: Floats, settings: Any) -> Any:
    """Return the matrices of SALib's ``_d_morph`` that follow from its basis.

    The products of basis and output times the first, then times the second, are the coefficients.
    """
    products = basis.T @ basis
    inverse, rank = pinv(products, hermitian=True), matrix_rank(products)
    rest = np.eye(len(products)) - inverse @ products
    left, _, right = scipy.linalg.svd(rest @ cost_matrix(basis, settings))
    null = range(min(basis.shape) - rank)
    left, right = (np.delete(matrix, null, axis=1) for matrix in (left, right.T))
    return inverse, right @ pinv(left.T @ right) @ left.T


_MOST_KEPT = 6  # degrees times the halves of the rows and all of them


def _kept(function: Callable[..., Any]) -> Callable[..., Any]:
    """Return a function of numbers and SALib's settings that keeps its last results."""
    results: dict[tuple[bytes, int], Any] = {}

    def kept(numbers: Floats, settings: Any) -> Any:
        key = numbers.tobytes(), settings.p_o
        if key not in results:
            if len(results) >= _MOST_KEPT:
                results.clear()
            results[key] = function(numbers, settings)
            for array in results[key] if isinstance(results[key], tuple) else (results[key],):
                array.flags.writeable = False
        return results[key]

    return kept


def _expansion(x: Floats, y: Floats, degree: int) -> Any:
    names = [str(i) for i in range(x.shape[1])]
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # the warning that there is no bootstrap
        return _hdmr().analyze(
            {"num_vars": len(names), "names": names},
            x,
            y,
            poly_order=degree,
            bootstrap=1,
            subset=len(y),
            return_emulator=True,
        )
