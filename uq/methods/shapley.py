"""Shapley effects: shares of the variance that sum to one, whatever the interactions."""

import numpy as np

from uq.contract import Floats
from uq.errors import choices
from uq.estimate import Estimate
from uq.intervals import ROUNDING, UNKNOWN, is_constant, scatter_interval
from uq.methods.indices import ALL_NOISE, SHAPLEY, Indices, RefusedError
from uq.methods.method import NO_VARIANCE
from uq.methods.sample import Sample

MIN_PATHS = 32
"""With fewer paths Student's law does not give the interval of a mean."""

MIN_SEEN = 10
"""With fewer paths it is not known whether an input has an effect of its own."""


def shapley_indices(sample: Sample) -> Indices:
    """Estimate the Shapley effect of each input.

    Parameters
    ----------
    sample : Sample
        Of paths.

    Returns
    -------
    Indices
        ``shapley``, shares of the variance. Paths are independent: intervals are Student's, for the
        ratio linearised. An input whose share is due to its correlation alone is named.

    Raises
    ------
    RefusedError
        A constant output, or one that is constant along each path.

    Notes
    -----
    Along a path, inputs change one by one in random order; those that have changed are drawn given
    those that have not. So the output y at the start of the path and the one after some steps are
    independent given the inputs that have not changed, and half their squared difference
    estimates the variance that is left when these are known without bias: the value of a set of
    inputs in [1]_, by one outer and two inner rows [2]_. Its increase, the mean of
    (y - (before + after)/2) (before - after) over the steps of an input, is the input's Shapley
    effect times the variance. For independent inputs this is the estimator of [3]_. The sum over a
    path is (y - end)^2/2.

    References
    ----------
    .. [1] A. B. Owen, C. Prieur, "On Shapley value for measuring importance of dependent inputs",
       SIAM/ASA J. Uncertain. Quantif. 5, 986-1002 (2017).
    .. [2] E. Song, B. L. Nelson, J. Staum, "Shapley effects for global sensitivity analysis: theory
       and computation", SIAM/ASA J. Uncertain. Quantif. 4, 1060-1083 (2016).
    .. [3] T. Goda, "A simple algorithm for global sensitivity analysis with Shapley effects",
       Reliab. Eng. Syst. Saf. 213, 107702 (2021).
    """
    y = sample.grouped[sample.whole]
    return indices_from(sample, parts_of(sample, y))


def parts_of(sample: Sample, y: Floats) -> Floats:
    """Return what the steps of each input add to half the square of the change along each path.

    Parameters
    ----------
    sample : Sample
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


def indices_from(sample: Sample, parts: Floats, rounding: float = 0.0) -> Indices:
    """Return Shapley effects from independent estimates of their parts of the variance.

    Parameters
    ----------
    sample : Sample
    parts : ndarray, shape (n, d)
        Of each whole path.
    rounding : float, optional
        What rounding may change in an effect: the least half-width of its interval.

    Raises
    ------
    RefusedError
    """
    y = sample.grouped[sample.whole]
    if sample.is_constant(y):
        raise RefusedError(NO_VARIANCE)
    if is_constant(y - y[:, :1]):
        raise RefusedError(ALL_NOISE)
    total = parts.sum(axis=1)
    shares = parts.mean(axis=0) / total.mean()
    errors = (parts - shares * total[:, None]) / total.mean()
    found = {}
    names = list(sample.inputs)
    terms = list(zip(names, shares.tolist(), errors.T, strict=True))
    if sample.difference:
        one, other = (terms[names.index(name)] for name in sample.difference)
        terms.append((" - ".join(sample.difference), one[1] - other[1], one[2] - other[2]))
    for name, share, error in terms:
        # Errors of rounding alone give no interval.
        constant = is_constant(share + error)
        ends = UNKNOWN if constant else scatter_interval(share, error, sample.confidence)
        if rounding:
            ends = np.fmin(ends[0], share - rounding), np.fmax(ends[1], share + rounding)
        found[name] = Estimate(share, *ends)
    idle = {name: paths for name in found if (paths := _paths_without_effect(sample, name))}
    notes = tuple(
        f"{name} does not change the output by itself in any of {paths} paths: its share is due to"
        f" its correlation with {choices(sample.correlated[name])}"
        for name, paths in idle.items()
    )
    return Indices({SHAPLEY: found}, notes, by_correlation=tuple(idle))


def _paths_without_effect(sample: Sample, name: str) -> int:
    """Return how many paths show that a correlated input has no effect of its own; else 0.

    An input shows its own effect where it is the first to change. Only paths along which the output
    changes say something.
    """
    if not sample.correlated.get(name):
        return 0
    whole = sample.whole
    y, x = sample.grouped[whole], sample.inputs[name][sample.groups[whole]]
    first = sample.direction[whole][:, 0, list(sample.inputs).index(name)] != 0
    alone = first & (x[:, 1] != x[:, 0])
    if (np.abs(y[:, 1] - y[:, 0])[alone] > ROUNDING * np.abs(y).max()).any():
        return 0
    moves = (y[:, -1] != y[:, 0]).reshape(len(y), -1).any(axis=1)  # some element of a whole output
    seen = int((alone & moves).sum())
    return seen if seen >= MIN_SEEN else 0
