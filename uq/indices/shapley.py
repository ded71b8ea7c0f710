"""Shapley effects, which are shares of the variance that sum to 1, estimated along paths."""

import numpy as np

from uq.contract import Floats, Mask
from uq.errors import choices
from uq.indices.index import ALL_NOISE, SHAPLEY, Indices, RefusedError
from uq.indices.method import NO_VARIANCE, UNSEEN, DesignSample
from uq.indices.polynomials import products, shapley_values, terms_of
from uq.stats.estimate import Estimate
from uq.stats.intervals import ROUNDING, UNKNOWN, is_constant, scatter_interval

MIN_SEEN = 10
"""Minimum number of paths for the conclusion that an input has no effect of its own."""

FOLDS = 4
"""Number of cross-fitting folds: the polynomial used on a fold is fitted to all other folds."""

ROWS_EACH = 4
"""Rows required per fitted coefficient."""

MOST_TERMS = 250
MOST_NUMBERS = 30_000_000
"""Largest number of values of all products over all rows."""

MIN_PATHS = 32
"""Minimum number of paths for Student's interval of a mean."""

EXACT = 1e-9
"""Smallest half-width of an interval: the rounding error of an exact effect."""


def parts_of(sample: DesignSample, y: Floats) -> Floats:
    """Return the contribution of each input to half the squared change along each path.

    Parameters
    ----------
    sample : DesignSample
    y : ndarray, shape (n, k) or (n, k, e)
        Any function of the rows of complete paths; contributions are summed over its elements.

    Returns
    -------
    ndarray, shape (n, d)
        Unbiased estimates of the Shapley values of its variance.
    """
    before, after = y[:, :-1], y[:, 1:]
    steps = (y[:, :1] - (before + after) / 2) * (before - after)
    steps = steps.reshape(*steps.shape[:2], -1).sum(axis=2)
    return np.asarray(np.einsum("ns,nsp->np", steps, sample.direction[sample.whole] != 0))


def changes_alone(sample: DesignSample) -> Mask:
    """Return the mask of complete paths on which each input alone changes the output, shape (n, d).

    This can be observed if the input is the first to change: all others then keep their values.
    """
    y = sample.grouped[sample.whole]
    moved = np.abs(y[:, 1] - y[:, 0]) > ROUNDING * np.abs(y).max()
    moved = moved.reshape(len(y), -1).any(axis=1)  # any element of the output
    return np.asarray((sample.direction[sample.whole][:, 0] != 0) & moved[:, None])


def paths_without_effect(sample: DesignSample, name: str) -> int:
    """Return the number of paths that show no effect of a correlated input itself; else 0.

    Only paths along which the output changes are informative.
    """
    if not sample.correlated.get(name):
        return 0
    whole, place = sample.whole, list(sample.inputs).index(name)
    if changes_alone(sample)[:, place].any():
        return 0
    y, x = sample.grouped[whole], sample.inputs[name][sample.groups[whole]]
    first = sample.direction[whole][:, 0, place] != 0
    moves = (y[:, -1] != y[:, 0]).reshape(len(y), -1).any(axis=1)
    seen = int((first & (x[:, 1] != x[:, 0]) & moves).sum())
    return seen if seen >= MIN_SEEN else 0


def controlled(sample: DesignSample, parts: Floats) -> tuple[Floats, Floats]:
    """Return the contributions corrected by a polynomial as control variate.

    Parameters
    ----------
    sample : DesignSample
        Sample of paths.
    parts : ndarray, shape (n, d)
        Contribution of each input on each complete path (`parts_of`).

    Returns
    -------
    parts : ndarray, shape (n, d)
        Contributions with the same expectation, and less scatter if the output resembles a
        polynomial in the normal scores. The errors of the polynomial's contributions on the paths
        are subtracted, times their regression coefficient, which is between 0 (no use) and 1.
    leverage : ndarray, shape (n, d)
        Leverage of each path in the regression: the part of its error that the fit absorbs.

    Notes
    -----
    The method is control variates with cross-fitting [1]_. The polynomial used on a path is fitted
    to other paths, and is therefore independent of it. The errors of its contributions have mean
    zero, whether or not the fit is good.

    References
    ----------
    .. [1] A. B. Owen, "Monte Carlo theory, methods and examples" (2013), section 8.9.
    """
    errors = _errors(sample, parts)
    spread = errors - errors.mean(axis=0)
    squares = (spread**2).sum(axis=0)
    squares = np.where(squares > 0, squares, 1.0)
    slopes = np.clip((spread * (parts - parts.mean(axis=0))).sum(axis=0) / squares, 0.0, 1.0)
    return parts - slopes * errors, spread**2 / squares


def _errors(sample: DesignSample, parts: Floats) -> Floats:
    """Return the errors of a polynomial's contributions: estimates on paths minus exact values."""
    errors = np.zeros_like(parts)
    y = sample.grouped[sample.whole]
    n, rows = y.shape[:2]
    y = (y - y.mean(axis=(0, 1))).reshape(n, rows, -1)  # last axis: elements of the output
    enough = n * rows * (1 - 1 / FOLDS) / ROWS_EACH
    most = min(enough, MOST_TERMS, MOST_NUMBERS / (n * rows))
    # Inputs that never change the output alone are excluded: if they have no effect, paths show
    # this exactly.
    used = np.isfinite(sample.scores[0, 0, 0]) & changes_alone(sample).any(axis=0)
    terms = terms_of(np.flatnonzero(used).tolist(), sample.matrix, most)
    if not terms:
        return errors
    values = products(sample.scores[sample.whole], terms, sample.matrix)
    values = np.concatenate([np.ones((n, rows, 1)), values], axis=2)
    control = np.empty_like(y)
    folds = [np.arange(n) % FOLDS == i for i in range(FOLDS)]
    squares = np.stack([_products_of(values[fold], values[fold]) for fold in folds])
    sums = np.stack([_products_of(values[fold], y[fold]) for fold in folds])
    for fold, fold_squares, fold_sums in zip(folds, squares, sums, strict=True):
        others = squares.sum(axis=0) - fold_squares, sums.sum(axis=0) - fold_sums
        weights = np.linalg.lstsq(*others, rcond=None)[0]
        control[fold] = values[fold] @ weights
        errors[fold] -= shapley_values(weights[1:], terms, sample.matrix)
    return errors + parts_of(sample, control)


def _products_of(left: Floats, right: Floats) -> Floats:
    """Return the cross products of columns, summed over paths and rows."""
    return np.asarray(np.tensordot(left, right, axes=((0, 1), (0, 1))))


def shapley_indices(sample: DesignSample) -> Indices:
    """Estimate the Shapley effect of each input.

    Parameters
    ----------
    sample : DesignSample
        Sample of paths.

    Returns
    -------
    Indices
        ``shapley``, shares of the variance. Paths are independent: intervals are Student's for the
        linearised ratio. Inputs whose share is due to correlation alone are listed.

    Raises
    ------
    RefusedError
        The output is constant, or constant along each path. Or there are too few paths to
        distinguish the variance from zero: a ratio to it then has no bounded interval [5]_.

    Notes
    -----
    Along a path, inputs change one by one in random order. Changed inputs are drawn conditionally
    on the unchanged ones. The output y at the start of the path and the output after a number of
    steps are therefore independent given the unchanged inputs. Half their squared difference is an
    unbiased estimate of the residual variance given these inputs: the value of a set of inputs in
    [1]_, from one outer and two inner rows [2]_. Its increase, the mean of
    (y - (before + after)/2) (before - after) over the steps of an input, is the input's Shapley
    effect times the variance. For independent inputs this is the estimator of [3]_. The sum over a
    path is (y - end)^2/2. A polynomial with known effects is used as control variate
    (`controlled`). The error of a path is its residual from the regression on all other
    paths ("HC3" of [4]_).

    References
    ----------
    .. [1] A. B. Owen, C. Prieur, "On Shapley value for measuring importance of dependent inputs",
       SIAM/ASA J. Uncertain. Quantif. 5, 986-1002 (2017).
    .. [2] E. Song, B. L. Nelson, J. Staum, "Shapley effects for global sensitivity analysis: theory
       and computation", SIAM/ASA J. Uncertain. Quantif. 4, 1060-1083 (2016).
    .. [3] T. Goda, "A simple algorithm for global sensitivity analysis with Shapley effects",
       Reliab. Eng. Syst. Saf. 213, 107702 (2021).
    .. [4] J. G. MacKinnon, H. White, "Some heteroskedasticity-consistent covariance matrix
       estimators with improved finite sample properties", J. Econometrics 29, 305-325 (1985).
    .. [5] E. C. Fieller, "Some problems in interval estimation", J. R. Stat. Soc. B 16, 175-185
       (1954).
    """
    y = sample.grouped[sample.whole]
    if sample.is_constant(y):
        raise RefusedError(NO_VARIANCE)
    if is_constant(y - y[:, :1]):
        raise RefusedError(ALL_NOISE)
    if sample.is_constant(y[:, -1] - y[:, 0]):
        raise RefusedError(UNSEEN)
    plain = parts_of(sample, y)
    seen = _linearised(plain)
    parts = controlled(sample, plain)
    _refuse_unknown_variance(*parts, sample.confidence)
    shares, errors = _linearised(*parts)
    names, single = list(sample.inputs), np.eye(plain.shape[1])
    contrasts = dict(zip(names, single, strict=True))
    if sample.difference:
        first, second = (contrasts[name] for name in sample.difference)
        contrasts[" - ".join(sample.difference)] = first - second
    effects, alike = {}, []
    for name, contrast in contrasts.items():
        share, error = float(shares @ contrast), errors @ contrast
        # If all paths agree, the scatter is only rounding.
        certain = is_constant(seen[0] @ contrast + seen[1] @ contrast)
        alike += [name] * certain
        low, high = scatter_interval(share, error, sample.confidence)
        ends = np.fmin(low, share - EXACT), np.fmax(high, share + EXACT)
        effects[name] = Estimate(share, *(UNKNOWN if certain else ends))
    idle = {name: paths for name in names if (paths := paths_without_effect(sample, name))}
    notes = tuple(
        f"{name} does not change the output by itself in any of {paths} paths: its share is due to"
        f" its correlation with {choices(sample.correlated[name])}"
        for name, paths in idle.items()
    )
    inert = [name for name in alike if effects[name].value == 0 and name not in idle]
    if inert:
        notes += (f"no effect in any row, hence no interval: {', '.join(inert)}",)
    if others := [name for name in alike if effects[name].value != 0]:
        notes += (f"the same share along each path, hence no interval: {', '.join(others)}",)
    return Indices({SHAPLEY: effects}, notes, by_correlation=tuple(idle))


def _linearised(parts: Floats, leverage: Floats | float = 0.0) -> tuple[Floats, Floats]:
    """Return linearised shares of the variance, shape (d,), and errors of paths, shape (n, d)."""
    mean = parts.mean(axis=0)
    shares, scatter = mean / mean.sum(), (parts - mean) / (1 - leverage)
    return shares, (scatter - shares * scatter.sum(axis=1, keepdims=True)) / mean.sum()


def _refuse_unknown_variance(parts: Floats, leverage: Floats, confidence: float) -> None:
    mean = parts.mean(axis=0)
    variance, errors = float(mean.sum()), ((parts - mean) / (1 - leverage)).sum(axis=1)
    if variance <= 0 or scatter_interval(variance, errors, confidence)[0] <= 0:
        raise RefusedError(
            f"{len(parts)} paths do not distinguish the variance from zero: more samples are needed"
            " for shares of it"
        )
