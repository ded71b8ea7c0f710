"""What each row says of the law of the integrated input, where all units share it.

Its density given the inspections is the product of what the units say, each a mean over rows: an
error of that mean is an error of all that is read from the posterior. The delta method follows it:
`uq.clusters.LearntTogether`.
"""

from typing import NamedTuple

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.learning.evidence import Evidence
from uq.learning.scale_quantiles import prior_places
from uq.learning.unit_likelihood import UnitLikelihoods
from uq.population.shared_terms import SCORES, terms


class SharedLaw(NamedTuple):
    """What the rows say of the input that all units share.

    Attributes
    ----------
    pulls : ndarray, shape (n, terms)
        By how much each row moves the terms of the density: errors are their means.
    terms : ndarray, shape (g, terms)
        At the values of the grid.
    scores : ndarray, shape (q,)
        Normal scores, by the law before the inspections, of its quantiles at `SCORES` given them.
    """

    pulls: Floats
    terms: Floats
    scores: Floats


def shared_law(found: Evidence, likelihoods: UnitLikelihoods) -> SharedLaw:
    """Return what the rows say, each of which stands for every inspected unit."""
    grid, log_share = found.grids[0], found.log_worlds[0]
    share = np.exp(log_share)
    of_values = terms(np.cumsum(share) - share / 2)
    pulls = 0.0
    for unit, rest in enumerate(found.rest):
        with np.errstate(invalid="ignore"):
            log_mean = log_share + found.log_evidence - rest[0]
        log_rows = likelihoods.of(unit, grid.values) - np.where(share > 0, log_mean, np.inf)
        pulls = pulls + np.exp(log_rows) @ (share[:, None] * of_values)
    places = prior_places(grid.edges[None], share[None], special.ndtr(SCORES)[None])[0]
    return SharedLaw(pulls - np.mean(pulls, axis=0), of_values, special.ndtri(places))
