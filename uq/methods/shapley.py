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
    if sample.is_constant(y):
        raise RefusedError(NO_VARIANCE)
    before, after = y[:, :-1], y[:, 1:]
    steps = (y[:, :1] - (before + after) / 2) * (before - after)
    steps = steps.reshape(*steps.shape[:2], -1).sum(axis=2)  # over the elements of a whole output
    parts = np.einsum("ns,nsp->np", steps, sample.direction[whole] != 0)
    total = parts.sum(axis=1)
    if is_constant(y - y[:, :1]):
        raise RefusedError(ALL_NOISE)
    shares = parts.mean(axis=0) / total.mean()
    errors = (parts - shares * total[:, None]) / total.mean()
    found = {}
    for name, share, error in zip(sample.inputs, shares.tolist(), errors.T, strict=True):
        # Errors of rounding alone give no interval.
        ends = UNKNOWN if is_constant(share + error) else scatter_interval(share, error)
        found[name] = Estimate(share, *ends)
    return Indices({SHAPLEY: found})
