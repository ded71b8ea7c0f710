"""Checks of a posterior: prior-predictive p-value, and whether rows can represent it."""

from math import ceil

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.learning.inspections import Inspection, InspectionKind
from uq.learning.likelihood import drawn_measurement
from uq.learning.posterior import Posterior
from uq.learning.rows_as_units import WeightedRows
from uq.learning.unit_likelihood import UnitLikelihoods
from uq.stats.importance_weights import DOUBTFUL, refusal, rows_to_be_negligible
from uq.stats.weighted_means import FEW
from uq.text.numbers import percent

CAMPAIGNS = 2000
"""Number of inspection campaigns simulated from the rows."""

STRANGE = 0.01
"""Prior-predictive p-value below which a warning is issued."""

HOPELESS = (
    "few rows agree with the inspections: many times the rows are required; if they do not help,"
    " a law, the model (--model-error) or an inspection may be wrong"
)

_MODERATE = 100.0
"""Factor by which rows can still reasonably be added."""

_OPEN = 0.01
"""Largest acceptable share of rows in which censoring hides the observable."""


def prior_predictive_p_value(posterior: Posterior, seed: int, model_cv: float) -> float:
    """Return the prior-predictive p-value of the inspections [1]_.

    Campaigns with the same inspections are simulated from the rows and the error laws. The test
    statistic is the product over inspections of the two-sided tail probability of each value, and
    of the probability of each outcome, among all campaigns.

    Parameters
    ----------
    posterior : Posterior
    seed : int
    model_cv : float

    References
    ----------
    .. [1] G. E. P. Box, "Sampling and Bayes' inference in scientific modelling and robustness", J.
       R. Stat. Soc. A 143, 383-430 (1980).
    """
    likelihoods, rng = posterior.likelihoods, np.random.default_rng((seed, 22))
    study_rows = np.flatnonzero(likelihoods.from_study)
    world = likelihoods.world[study_rows[rng.integers(len(study_rows), size=CAMPAIGNS)]]
    common = rng.random(CAMPAIGNS)
    score = np.zeros(CAMPAIGNS + 1)  # the last belongs to the real inspections
    for block, inspections in zip(likelihoods.blocks, likelihoods.inspections, strict=True):
        rows = _rows(block[likelihoods.from_study[block]], likelihoods.world, world, rng)
        individual = rng.random(CAMPAIGNS)
        values = np.ones(CAMPAIGNS)
        if likelihoods.scale is not None:
            values = likelihoods.scale.quantiles(common if likelihoods.shares_scale else individual)
        for inspection in inspections:
            truth = likelihoods.truth(inspection, rows, values[:, None])
            score += _log_probability(likelihoods, inspection, truth, rng, model_cv)
    return float((score[:-1] <= score[-1] + 1e-9).mean())


def _rows(
    block: NDArray[np.intp],
    world_of: NDArray[np.intp],
    world: NDArray[np.intp],
    rng: np.random.Generator,
) -> NDArray[np.intp]:
    """Draw one random row of a block in each given world."""
    order = block[np.argsort(world_of[block], kind="stable")]
    first, after = (np.searchsorted(world_of[order], world, side=s) for s in ("left", "right"))
    return np.asarray(order[first + np.floor(rng.random(len(world)) * (after - first)).astype(int)])


def _log_probability(
    likelihoods: UnitLikelihoods,
    inspection: Inspection,
    truth: Floats,
    rng: np.random.Generator,
    model_cv: float,
) -> Floats:
    """Return the log tail probability of an inspection in each campaign, the real one last."""
    n = len(truth)
    if inspection.kind is not InspectionKind.MEASURED:
        observable = likelihoods.observables[inspection]
        chance = np.exp(observable.log_likelihood(inspection, truth, model_cv)[:, 0])
        so = rng.random(n) < chance
        share = (chance.sum() + 0.5) / (n + 1)
        return np.append(np.where(so, np.log(share), np.log1p(-share)), np.log(share))
    assert inspection.value is not None
    values = np.append(drawn_measurement(inspection, truth[:, 0], rng, model_cv), inspection.value)
    ordered = np.sort(values[~np.isnan(values)])
    below = np.searchsorted(ordered, values, side="right") / (len(ordered) + 1)
    return np.where(np.isnan(values), 0.0, np.log(2 * np.minimum(below, 1 - below)))


def censoring(posterior: Posterior) -> str:
    """Return a warning if censoring hides the observable in too many rows, or ""."""
    for unit, (label, weighted) in enumerate(posterior.units.items()):
        likelihoods = posterior.likelihoods
        before, after = likelihoods.bounded(unit), likelihoods.bounded(unit, weighted.scale)
        counted = np.exp(likelihoods.log_before(unit))
        share = max(
            np.average(before, weights=counted), np.average(after, weights=weighted.weights.weights)
        )
        if share > _OPEN:
            return (
                f"unit {label}: {percent(share)} of the rows were censored before its"
                f" inspections{_or_stopped(posterior, label)}"
            )
    return ""


def distrust(posterior: Posterior) -> str:
    """Return the reason why the weights of a posterior are unreliable, or ""."""
    weighted_by_name = {"shared inputs": posterior.any_unit}
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
        more = rows_to_be_negligible(weights.most) - weights.rows
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
    """Return a number of rows rounded up to two digits."""
    unit = 10 ** max(len(str(ceil(count))) - 2, 0)
    return ceil(count / unit) * unit
