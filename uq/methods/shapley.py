"""Shapley effects: shares of the variance that sum to one, whatever the interactions."""

import numpy as np

from uq.estimate import Estimate
from uq.intervals import UNKNOWN, is_constant, scatter_interval
from uq.methods.indices import ALL_NOISE, SHAPLEY, Indices, RefusedError
from uq.methods.method import NO_VARIANCE
from uq.methods.sample import Sample

MIN_PATHS = 32
"""With fewer paths Student's law does not give the interval of a mean."""


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
        ratio linearised.

    Raises
    ------
    RefusedError
        A constant output, or one that is constant along each path.

    Notes
    -----
    Along a path from one row to an independent one, input by input in random order, step k moves
    the output from before to after. With the output y at the start of the path, the mean of
    (y - (before + after)/2) (before - after) over the steps of an input is its Shapley effect
    times the variance [1]_; their sum over a path is (y - end)^2/2.

    References
    ----------
    .. [1] T. Goda, "A simple algorithm for global sensitivity analysis with Shapley effects",
       Reliab. Eng. Syst. Saf. 213, 107702 (2021).
    """
    whole = sample.whole
    y = sample.grouped[whole]
    if is_constant(y):
        raise RefusedError(NO_VARIANCE)
    before, after = y[:, :-1], y[:, 1:]
    steps = (y[:, :1] - (before + after) / 2) * (before - after)
    parts = np.einsum("ns,nsp->np", steps, sample.direction[whole] != 0)
    total = parts.sum(axis=1)
    if is_constant(y - y[:, :1]):
        raise RefusedError(ALL_NOISE)
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
        found[name] = Estimate(share, *ends)
    return Indices({SHAPLEY: found})
