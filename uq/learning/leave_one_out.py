"""Rows as units that were not inspected: their own inputs must not have been learnt.

A row that makes its world probable, since it agrees with an inspection, would count as if it had
been inspected itself. It counts by what the other units of its world say instead: then its weight
is independent of its own inputs, given what the world shares, and unbiased.
"""

import numpy as np
from numpy.typing import NDArray
from scipy import special

from uq.contract import Floats
from uq.learning.evidence import Evidence
from uq.learning.unit_likelihood import UnitLikelihoods
from uq.result.nesting import Nesting

Places = NDArray[np.integer]


def log_worth(evidence: Evidence, likelihoods: UnitLikelihoods, place: Nesting) -> Floats:
    """Return leave-one-out log weights: of each row, given the inspections of other units.

    Parameters
    ----------
    evidence : Evidence
        Of the samples, each a world.
    likelihoods : UnitLikelihoods
        Of the inspected units.
    place : Nesting
        Of all rows.

    Returns
    -------
    ndarray, shape (n, g)
        Logarithm of the probability of the world of each row, and of each value of an integrated
        input that its units share (else g is 1), with the mean likelihood of the inspected unit for
        which the row stands taken over the other units of the world that do; -inf where there is
        none.
    """
    values = [grid.values for grid in evidence.grids]
    shared = likelihoods.shares_scale
    worth = np.full((len(place.sample), len(values[0]) if shared else 1), -np.inf)
    for unit, rows in enumerate(likelihoods.blocks):
        sample = place.sample[rows]
        of_unit = sample * place.units + place.unit[rows]
        log_rows = likelihoods.log_likelihood(unit, values[unit])
        joint = evidence.rest[unit][sample] + _mean_of_others(log_rows, of_unit, sample)
        worth[rows] = joint if shared else special.logsumexp(joint, axis=1, keepdims=True)
    return worth


def _mean_of_others(logs: Floats, of_unit: Places, sample: Places) -> Floats:
    """Return the logarithm of the mean over the rows of other units of the sample, shape (m, g)."""
    _, unit = np.unique(of_unit, return_inverse=True)
    top = np.full((sample.max() + 1, logs.shape[1]), -np.inf)
    np.maximum.at(top, sample, logs)
    level = np.where(np.isfinite(top), top, 0.0)[sample]

    def others(numbers: Floats) -> Floats:
        sums = [np.zeros((index.max() + 1, numbers.shape[1])) for index in (sample, unit)]
        for total, index in zip(sums, (sample, unit), strict=True):
            np.add.at(total, index, numbers)
        return np.asarray(sums[0][sample] - sums[1][unit])

    count = others(np.ones((len(logs), 1)))
    total = np.maximum(others(np.exp(logs - level)), 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        return np.where(count > 0, np.log(total / count) + level, -np.inf)
