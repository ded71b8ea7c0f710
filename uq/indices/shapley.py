"""Shapley effects: shares of the variance that sum to one, whatever the interactions."""

import numpy as np

from uq.contract import Floats
from uq.errors import choices
from uq.indices.index import ALL_NOISE, SHAPLEY, Indices, RefusedError
from uq.indices.method import NO_VARIANCE, UNSEEN
from uq.indices.paths import controlled, parts_of, paths_without_effect
from uq.indices.sample import DesignSample
from uq.stats.estimate import Estimate
from uq.stats.intervals import UNKNOWN, is_constant, scatter_interval

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
    (`uq.indices.paths`); a path's error is that from the regression on all others, "HC3" of
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
