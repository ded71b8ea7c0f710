"""Diagnosis of whether the rows of a result can represent a posterior."""

from math import ceil

import numpy as np

from uq.learning.posterior import Posterior
from uq.learning.rows_as_units import WeightedRows
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
    for unit, (label, weighted) in enumerate(posterior.units.items()):
        likelihoods = posterior.likelihoods
        before, after = likelihoods.bounded(unit), likelihoods.bounded(unit, weighted.scale)
        counted = np.exp(likelihoods.log_before(unit))
        share = max(
            np.average(before, weights=counted), np.average(after, weights=weighted.weights.weights)
        )
        if share > _OPEN:
            return (
                f"unit {label}: {percent(share)} of the rows were censored before what its"
                f" inspections found{_or_stopped(posterior, label)}"
            )
    return ""


def distrust(posterior: Posterior) -> str:
    """Return why the weights of a posterior cannot be trusted, or ""."""
    weighted_by_name = {"what all units share": posterior.any_unit}
    weighted_by_name |= {f"unit {label}": weighted for label, weighted in posterior.units.items()}
    fewest_first = sorted(weighted_by_name.items(), key=lambda pair: pair[1].weights.effective)
    return next(
        (f"{name}: {why}" for name, weighted in fewest_first if (why := _why(weighted))), ""
    )


def _or_stopped(posterior: Posterior, label: str) -> str:
    """Return the remedy where rows are censored before the inspections of a unit."""
    stopped = (
        observable.depths.settled & ~observable.censored
        for inspection, observable in posterior.likelihoods.observables.items()
        if inspection.unit == label and observable.depths is not None
    )
    if not any(rows.any() for rows in stopped):
        return "; run the study with a longer horizon"
    return (
        ", or their wear stops between two of its depths; run the study with a longer horizon, or"
        " with more depths"
    )


def _why(weighted: WeightedRows) -> str:
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
