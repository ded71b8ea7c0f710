"""Shapley effects: shares of the variance that sum to one, estimated along paths."""

import numpy as np

from uq.contract import Floats, Mask
from uq.errors import choices
from uq.indices.index import ALL_NOISE, SHAPLEY, Indices, RefusedError
from uq.indices.method import NO_VARIANCE, UNSEEN, DesignSample
from uq.indices.polynomials import products, shapley_values, terms_of
from uq.stats.estimate import Estimate
from uq.stats.intervals import ROUNDING, UNKNOWN, is_constant, scatter_interval

MIN_SEEN = 10
"""With fewer paths an effect of the input itself cannot be excluded."""


def parts_of(sample: DesignSample, y: Floats) -> Floats:
    """Return the contribution of each input to half the squared change along each path.

    Parameters
    ----------
    sample : DesignSample
    y : ndarray, shape (n, k) or (n, k, e)
        Any function of the rows of whole paths; its elements add up.

    Returns
    -------
    ndarray, shape (n, d)
        Unbiased for the Shapley values of its variance.
    """
    before, after = y[:, :-1], y[:, 1:]
    steps = (y[:, :1] - (before + after) / 2) * (before - after)
    steps = steps.reshape(*steps.shape[:2], -1).sum(axis=2)
    return np.asarray(np.einsum("ns,nsp->np", steps, sample.direction[sample.whole] != 0))


def changes_alone(sample: DesignSample) -> Mask:
    """Return the mask of whole paths along which each input alone changes the output, shape (n, d).

    An input shows this where it is the first to change: all others then keep their values.
    """
    y = sample.grouped[sample.whole]
    moved = np.abs(y[:, 1] - y[:, 0]) > ROUNDING * np.abs(y).max()
    moved = moved.reshape(len(y), -1).any(axis=1)  # some element of a whole output
    return np.asarray((sample.direction[sample.whole][:, 0] != 0) & moved[:, None])


def paths_without_effect(sample: DesignSample, name: str) -> int:
    """Return how many paths show that a correlated input has no effect of its own; else 0.

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


FOLDS = 4
"""Of the paths: the polynomial that serves on one is fitted to the rows of all others."""

ROWS_EACH = 4
"""Rows for each weight that is fitted to them."""

MOST_TERMS = 250
MOST_NUMBERS = 30_000_000
"""In all products of all rows."""


def controlled(sample: DesignSample, parts: Floats) -> tuple[Floats, Floats]:
    """Correct the parts of the variance by a polynomial as control variate.

    Parameters
    ----------
    sample : DesignSample
        Of paths.
    parts : ndarray, shape (n, d)
        Of the output, on each whole path.

    Returns
    -------
    parts : ndarray, shape (n, d)
        With the same expectation, and less scatter where the output resembles a polynomial in the
        normal scores: the errors of the polynomial's parts on the paths are subtracted, times the
        coefficient of their regression, from 0 (of no use) to 1.
    leverage : ndarray, shape (n, d)
        Of each path in that regression: the part of its error that the regression hides.

    Notes
    -----
    The method is that of control variates [1]_. Fitted to other paths, the polynomial is a given
    one, whatever its fit, and the errors of its parts have mean zero.

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
    """Return the parts of a polynomial estimated on each path, less their exact values."""
    errors = np.zeros_like(parts)
    y = sample.grouped[sample.whole]
    n, rows = y.shape[:2]
    y = (y - y.mean(axis=(0, 1))).reshape(n, rows, -1)  # with the elements of a whole output
    enough = n * rows * (1 - 1 / FOLDS) / ROWS_EACH
    most = min(enough, MOST_TERMS, MOST_NUMBERS / (n * rows))
    # Inputs that never change the output by themselves are left out: if they have no effect, paths
    # show that exactly.
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


MIN_PATHS = 32
"""With fewer paths Student's law does not give the interval of a mean."""

EXACT = 1e-9
"""The least half-width of an interval: the rounding error of an exact effect."""


def shapley_indices(sample: DesignSample) -> Indices:
    """Estimate the Shapley effect of each input.

    Parameters
    ----------
    sample : DesignSample
        Of paths.

    Returns
    -------
    Indices
        ``shapley``, shares of the variance. Paths are independent: intervals are Student's, for the
        ratio linearised. An input whose share is due to its correlation alone is named.

    Raises
    ------
    RefusedError
        A constant output, or one that is constant along each path. Too few paths to tell the
        variance from zero: a ratio to it then has no bounded interval [5]_.

    Notes
    -----
    Along a path, inputs change one by one in random order; those that have changed are drawn given
    those that have not. So the output y at the start of the path and the one after some steps are
    independent given the inputs that have not changed, and half their squared difference
    estimates the variance that is left when these are known without bias: the value of a set of
    inputs in [1]_, by one outer and two inner rows [2]_. Its increase, the mean of
    (y - (before + after)/2) (before - after) over the steps of an input, is the input's Shapley
    effect times the variance. For independent inputs this is the estimator of [3]_. The sum over a
    path is (y - end)^2/2. A polynomial of known effects serves as control variate
    (`uq.indices.shapley`); a path's error is that from the regression on all others, "HC3" of
    [4]_.

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
        # Where every path shows the same, scatter is rounding.
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
    """Return shares of the variance, shape (d,), and the errors of paths, shape (n, d)."""
    mean = parts.mean(axis=0)
    shares, scatter = mean / mean.sum(), (parts - mean) / (1 - leverage)
    return shares, (scatter - shares * scatter.sum(axis=1, keepdims=True)) / mean.sum()


def _refuse_unknown_variance(parts: Floats, leverage: Floats, confidence: float) -> None:
    mean = parts.mean(axis=0)
    variance, errors = float(mean.sum()), ((parts - mean) / (1 - leverage)).sum(axis=1)
    if variance <= 0 or scatter_interval(variance, errors, confidence)[0] <= 0:
        raise RefusedError(
            f"{len(parts)} paths do not tell the variance from zero, and shares of it are not"
            " known: more samples are needed"
        )
