"""How much each inspection taught: its information gain beside all others."""

from collections.abc import Iterator
from functools import partial
from typing import NamedTuple

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.learning.evidence import weigh_on, wide
from uq.learning.inspections import Inspection
from uq.learning.posterior import Posterior


class Taught(NamedTuple):
    """What an inspection taught beyond all others.

    Attributes
    ----------
    inspection : Inspection
    bits : float
        Relative entropy of what is known with it to what is known without it.
    """

    inspection: Inspection
    bits: float


def taught(found: Posterior) -> Iterator[Taught]:
    """Yield what each inspection taught, in their order.

    The information gain about everything unknown, worlds and units, from the knowledge that all
    other inspections leave [1]_.

    References
    ----------
    .. [1] D. V. Lindley, "On a measure of the information provided by an experiment", Ann. Math.
       Stat. 27, 986-1005 (1956).
    """
    scale, of = found.scale, found.likelihoods
    grids = [wide(grid, scale.quantiles if scale else None) for grid in found.evidence.grids]
    worlds = [found.world[block] for block in of.blocks]
    count = int(found.world.max()) + 1
    each = [partial(of.of, unit) for unit in range(len(grids))]
    _, all_told = weigh_on(grids, each, worlds, count, bool(scale and scale.is_own))
    for unit, (grid, world) in enumerate(zip(grids, worlds, strict=True)):
        size = np.bincount(world, minlength=count)[world]
        rest = all_told.rest[unit][world] + (of.log_before(unit) - np.log(size))[:, None]
        single = {one: of.of_one(one, unit, grid.values) for one in of.of_unit[unit]}
        for one in single:
            others = [log for other, log in single.items() if other != one]
            yield Taught(one, _gain(rest + sum(others, np.zeros(rest.shape)), single[one]))


def _gain(before: Floats, log_likelihood: Floats) -> float:
    """Return the relative entropy that a likelihood adds to unnormalised logarithms [bit]."""
    after = before + log_likelihood
    total = special.logsumexp(after)
    share = np.exp(after - total)
    mean = share[share > 0] @ log_likelihood[share > 0]
    return float(max(mean - (total - special.logsumexp(before)), 0.0) / np.log(2))
