"""How much each inspection taught: its information gain beside all others."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.learning.inspections import Inspection
from uq.learning.posterior import Posterior, on_wide_grids


class Taught(NamedTuple):
    """What an inspection taught beyond all others.

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


def taught(found: Posterior) -> Iterator[Taught]:
    """Yield what each inspection taught, in their order.

    The information gain about everything unknown, worlds and units, from the knowledge that all
    other inspections leave [1]_.

    References
    ----------
    .. [1] D. V. Lindley, "On a measure of the information provided by an experiment", Ann. Math.
       Stat. 27, 986-1005 (1956).
    """
    of, count = found.likelihoods, int(found.world.max()) + 1
    grids, all_told = on_wide_grids(found)
    for unit, grid in enumerate(grids):
        world = found.world[of.blocks[unit]]
        size = np.bincount(world, minlength=count)[world]
        rest = all_told.rest[unit][world] + (of.log_before(unit) - np.log(size))[:, None]
        single = {one: of.of_one(one, unit, grid.values) for one in of.of_unit[unit]}
        for one in single:
            others = [log for other, log in single.items() if other != one]
            bits = _gain(rest + sum(others, np.zeros(rest.shape)), single[one])
            yield Taught(one, bits, found.looks[one].unit, found.looks[one].time_unit)


def _gain(before: Floats, log_likelihood: Floats) -> float:
    """Return the relative entropy that a likelihood adds to unnormalised logarithms [bit]."""
    after = before + log_likelihood
    total = special.logsumexp(after)
    share = np.exp(after - total)
    mean = share[share > 0] @ log_likelihood[share > 0]
    return float(max(mean - (total - special.logsumexp(before)), 0.0) / np.log(2))
