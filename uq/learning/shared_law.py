"""Influence of each row on the law of the integrated input, where all units share it.

Its density given the inspections is the product of what the units say, each a mean over rows: an
error of that mean is an error of all that is read from the posterior. The delta method follows it:
`uq.stats.clusters.SharedInfluence`.
"""

from typing import NamedTuple

import numpy as np
from scipy import special

from uq.assess.posterior_scale import SCORES, terms
from uq.contract import Floats
from uq.learning.cell_masses import masses
from uq.learning.evidence import Evidence
from uq.learning.scale_quantiles import prior_places


class SharedLaw(NamedTuple):
    """The law, given the inspections, of an input that all units share.

    Attributes
    ----------
    share : ndarray, shape (g,)
        Probabilities of the values of the grid.
    terms : ndarray, shape (g, terms)
        At these values.
    scores : ndarray, shape (q,)
        Normal scores, by the law before the inspections, of its quantiles at `SCORES` given them.
    """

    share: Floats
    terms: Floats
    scores: Floats


def shared_law(evidence: Evidence) -> SharedLaw:
    """Return the posterior law, where each row stands for every inspected unit."""
    share, edges = np.exp(evidence.log_worlds), evidence.grids[0].edges[None]
    of_cells = masses(evidence.grids[0], edges, share)
    places = prior_places(edges, of_cells, special.ndtr(SCORES)[None])[0]
    middle = np.cumsum(share[0]) - share[0] / 2
    return SharedLaw(share[0], terms(middle), special.ndtri(places))


def pulls_of(unit: int, log_likelihood: Floats, evidence: Evidence, law: SharedLaw) -> Floats:
    """Return by how much each row moves the terms of the law, as one unit, shape (n, terms).

    Errors of the law are the means over rows of the sum over units.
    """
    with np.errstate(invalid="ignore"):
        log_mean = evidence.log_worlds[0] + evidence.log_evidence - evidence.rest[unit][0]
    log_rows = log_likelihood - np.where(law.share > 0, log_mean, np.inf)
    return np.asarray(np.exp(log_rows) @ (law.share[:, None] * law.terms))
