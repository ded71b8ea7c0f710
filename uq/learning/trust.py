"""Whether the rows of a result can represent what inspections leave of it."""

from collections.abc import Iterator
from math import ceil

import numpy as np

from uq.learning.posterior import Posterior, Weighted
from uq.stats.importance_weights import DOUBTFUL, refusal, rows_to_carry_little
from uq.stats.weighted_means import FEW
from uq.text.numbers import percent

HOPELESS = (
    "few rows agree with the inspections, and this takes many times the rows; where"
    " these do not help either, the laws, the model (--model-error) or an inspection may be wrong"
)

_MODERATE = 100.0
"""Times the rows that can still be added."""

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
                f"unit {label}: {percent(share)} of the rows were censored before what its"
                f" inspections found{_or_stopped(found, label)}"
            )


def _or_stopped(found: Posterior, label: str) -> str:
    """Return what remedies rows that leave open what inspections of a unit saw."""
    looks = [look for one, look in found.looks.items() if one.unit == label]
    stopped = [one.depths.settled & ~one.censored for one in looks if one.depths is not None]
    if not any(rows.any() for rows in stopped):
        return "; run the study with a longer horizon"
    return (
        ", or their wear stops between two of its depths; run the study with a longer horizon, or"
        " with more depths"
    )


def _reasons(found: Posterior) -> Iterator[str]:
    """Yield what is wrong, that of the fewest effective rows first."""
    each = {"what all units share": found.any_unit}
    each |= {f"unit {label}": one for label, one in found.units.items()}
    for whose, one in sorted(each.items(), key=lambda pair: pair[1].weights.effective):
        if why := _why(one):
            yield f"{whose}: {why}"


def _why(one: Weighted) -> str:
    found = one.weights
    several = "rows" if found.rows == len(one.rows) else "samples"
    if why := refusal(found.k, found.rows, HOPELESS):
        more = rows_to_carry_little(found.most) - found.rows
        if found.k < DOUBTFUL or more > _MODERATE * found.rows:
            return why
        return f"single rows may carry over 1 % of the weight: add {_rounded_up(more)} {several}"
    if found.effective >= FEW:
        return ""
    more = ceil(found.rows * (FEW / found.effective - 1))
    return (
        f"worth {found.effective:.1f} {several} of equal weight, below {FEW}:"
        f" add {_rounded_up(more)} {several}"
    )


def _rounded_up(count: float) -> int:
    """Return a number of rows with two digits."""
    unit = 10 ** max(len(str(ceil(count))) - 2, 0)
    return ceil(count / unit) * unit
