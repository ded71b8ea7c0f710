"""Information gain of each inspection, given all others."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.learning.evidence import on_wide_grids
from uq.learning.inspections import Inspection
from uq.learning.posterior import Posterior


class Taught(NamedTuple):
    """Information gain of an inspection, given all others.

    Attributes
    ----------
    inspection : Inspection
    bits : float
        Relative entropy of what is known with it to what is known without it.
    units : str
        CF unit of what was inspected.
    time_unit : str
        Of the time of the inspection.
    """

    inspection: Inspection
    bits: float
    units: str
    time_unit: str


def taught(posterior: Posterior) -> Iterator[Taught]:
    """Yield the information gain of each inspection, in their order.

    The information gain about everything unknown, worlds and units, from the knowledge that all
    other inspections leave [1]_.

    References
    ----------
    .. [1] D. V. Lindley, "On a measure of the information provided by an experiment", Ann. Math.
       Stat. 27, 986-1005 (1956).
    """
    likelihoods = posterior.likelihoods
    evidence = on_wide_grids(posterior.evidence, likelihoods)
    for unit, grid in enumerate(evidence.grids):
        world = likelihoods.world[likelihoods.blocks[unit]]
        size = np.bincount(world)[world]
        rest = evidence.rest[unit][world] + (likelihoods.log_before(unit) - np.log(size))[:, None]
        single = {
            inspection: likelihoods.of_inspection(inspection, unit, grid.values)
            for inspection in likelihoods.inspections[unit]
        }
        for inspection in single:
            others = [log for other, log in single.items() if other != inspection]
            bits = _gain(rest + sum(others, np.zeros(rest.shape)), single[inspection])
            observable = likelihoods.observables[inspection]
            yield Taught(inspection, bits, observable.unit, observable.time_unit)


def _gain(before: Floats, log_likelihood: Floats) -> float:
    """Return the relative entropy that a likelihood adds to unnormalised logarithms [bit]."""
    after = before + log_likelihood
    total = special.logsumexp(after)
    share = np.exp(after - total)
    mean = share[share > 0] @ log_likelihood[share > 0]
    return float(max(mean - (total - special.logsumexp(before)), 0.0) / np.log(2))
