"""Whether the rows of a result can represent what inspections leave of it."""

from collections.abc import Iterator
from math import ceil

import numpy as np

from uq.learning.posterior import Posterior, Weighted
from uq.population.means import FEW
from uq.population.smoothing import refusal

HOPELESS = (
    "the rows hardly visit what the inspections leave, and no moderate number of rows helps; the"
    " laws, the model (--model-error) or an inspection may be wrong"
)

_OPEN = 0.01
"""Share of rows in which a censored life may leave open what an inspection saw."""


def censoring(found: Posterior) -> str:
    """Return that censored lives leave open what inspections saw, or ""."""
    return next(_censored(found), "")


def distrust(found: Posterior) -> str:
    """Return why the weights of a posterior cannot be trusted, or ""."""
    return next(_reasons(found), "")


def _censored(found: Posterior) -> Iterator[str]:
    for unit, (label, one) in enumerate(found.units.items()):
        scale = None if found.scale is None else found.scale.drawn[one.rows]
        before = found.likelihoods.bounded(unit, scale)
        after = found.likelihoods.bounded(unit, one.scale)
        counted = np.exp(found.likelihoods.log_before(unit))
        share = max(
            np.average(before, weights=counted), np.average(after, weights=one.weights.weights)
        )
        if share > _OPEN:
            yield (
                f"unit {label}: {100 * share:.2g} % of the rows were censored before what its"
                " inspections saw; run the study with a longer horizon"
            )


def _reasons(found: Posterior) -> Iterator[str]:
    if why := _why(found.any_unit):
        yield f"what all units share: {why}"
    for label, one in found.units.items():
        if why := _why(one):
            yield f"unit {label}: {why}"


def _why(one: Weighted) -> str:
    found = one.weights
    if why := refusal(found.k, found.rows, HOPELESS):
        return why
    if found.effective >= FEW:
        return ""
    more = ceil(found.rows * (FEW / found.effective - 1))
    return f"worth {found.effective:.1f} samples of equal weight, below {FEW}: add {more} samples"
