"""Diagnosis of whether the rows of a result can represent a posterior."""

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


def censoring(posterior: Posterior) -> str:
    """Return that censored lives leave open what inspections saw, or ""."""
    return next(_censored(posterior), "")


def distrust(posterior: Posterior) -> str:
    """Return why the weights of a posterior cannot be trusted, or ""."""
    return next(_reasons(posterior), "")


def _censored(posterior: Posterior) -> Iterator[str]:
    for unit, (label, weighted) in enumerate(posterior.units.items()):
        scale = None if posterior.scale is None else posterior.scale.drawn[weighted.rows]
        before = posterior.likelihoods.bounded(unit, scale)
        after = posterior.likelihoods.bounded(unit, weighted.scale)
        counted = np.exp(posterior.likelihoods.log_before(unit))
        share = max(
            np.average(before, weights=counted), np.average(after, weights=weighted.weights.weights)
        )
        if share > _OPEN:
            yield (
                f"unit {label}: {percent(share)} of the rows were censored before what its"
                f" inspections found{_or_stopped(posterior, label)}"
            )


def _or_stopped(posterior: Posterior, label: str) -> str:
    """Return the remedy where rows are censored before the inspections of a unit."""
    looks = [look for inspection, look in posterior.looks.items() if inspection.unit == label]
    stopped = [look.depths.settled & ~look.censored for look in looks if look.depths is not None]
    if not any(rows.any() for rows in stopped):
        return "; run the study with a longer horizon"
    return (
        ", or their wear stops between two of its depths; run the study with a longer horizon, or"
        " with more depths"
    )


def _reasons(posterior: Posterior) -> Iterator[str]:
    """Yield the reason for each unit, from the fewest effective rows."""
    weighted_by_name = {"what all units share": posterior.any_unit}
    weighted_by_name |= {f"unit {label}": weighted for label, weighted in posterior.units.items()}
    for whose, weighted in sorted(
        weighted_by_name.items(), key=lambda pair: pair[1].weights.effective
    ):
        if why := _why(weighted):
            yield f"{whose}: {why}"


def _why(weighted: Weighted) -> str:
    weights = weighted.weights
    several = "rows" if weights.rows == len(weighted.rows) else "samples"
    if why := refusal(weights.k, weights.rows, HOPELESS):
        more = rows_to_carry_little(weights.most) - weights.rows
        if weights.k < DOUBTFUL or more > _MODERATE * weights.rows:
            return why
        return f"single rows may carry over 1 % of the weight: add {_rounded_up(more)} {several}"
    if weights.effective >= FEW:
        return ""
    more = ceil(weights.rows * (FEW / weights.effective - 1))
    return (
        f"worth {weights.effective:.1f} {several} of equal weight, below {FEW}:"
        f" add {_rounded_up(more)} {several}"
    )


def _rounded_up(count: float) -> int:
    """Return a number of rows with two digits."""
    unit = 10 ** max(len(str(ceil(count))) - 2, 0)
    return ceil(count / unit) * unit
