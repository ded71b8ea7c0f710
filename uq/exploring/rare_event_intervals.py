"""The interval of a rare event that its rows support, however the replicates ended."""

import numpy as np

from uq.exploring.subset_simulation import Floats, Found
from uq.intervals import Ends, binomial_interval, scatter_interval


def log_scatter_interval(estimates: Floats) -> Ends:
    """Return the interval of a small probability from independent estimates of it.

    Parameters
    ----------
    estimates : ndarray, shape (R,)
        Not negative.

    Returns
    -------
    low, high : float
        Student's interval of the logarithms about the mean; if some estimates are zero, that of
        the estimates themselves, not below zero.
    """
    mean = float(estimates.mean())
    if (estimates > 0).all():
        low, high = np.exp(scatter_interval(np.log(mean), np.log(estimates)))
        return low, high
    low, high = scatter_interval(mean, estimates)
    return np.maximum(low, 0.0), high


def subset_interval(found: list[Found], samples: int) -> Ends:
    """Return the interval that replicates of subset simulation support.

    Parameters
    ----------
    found : list of Found
    samples : int
        Rows of each level.

    Returns
    -------
    low, high : float
        If every replicate reached the event: from their scatter or, if all ended at the first
        level, whose rows are independent, that of a share of these rows. Otherwise from zero, or a
        higher end that the scatter supports, to the lesser of two upper bounds. One is that of the
        share of the first level's rows. The other gives each replicate that never reached the event
        the probability of its last level, of which the event is a part.
    """
    estimates = np.array([one.probability for one in found])
    rows = samples * len(found)
    first = binomial_interval(sum(one.first_hits for one in found) / rows, rows)
    if all(one.levels == 1 for one in found):
        return first
    scatter = log_scatter_interval(estimates)
    if (estimates > 0).all():
        return scatter
    at_most = np.array([one.probability or one.reached for one in found])
    high = np.fmin(first[1], log_scatter_interval(at_most)[1])
    return float(np.fmax(scatter[0], 0.0)), float(high)
