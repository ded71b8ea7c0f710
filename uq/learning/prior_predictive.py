"""Prior-predictive p-value of the inspections."""

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.learning.inspections import Inspection, InspectionKind
from uq.learning.likelihood import drawn_measurement
from uq.learning.posterior import Posterior
from uq.learning.unit_likelihood import UnitLikelihoods

CAMPAIGNS = 2000
"""Campaigns drawn from the rows."""

STRANGE = 0.01
"""Probability below which a warning is due."""


def strangeness(posterior: Posterior, seed: int, model_cv: float) -> float:
    """Return the probability, before the inspections, of inspections at least as improbable.

    Campaigns with the same inspections are drawn from the rows and the laws of errors. How strange
    a campaign is: the product over inspections of the two-sided probabilities of each value, and
    of the probabilities of each outcome, among all campaigns [1]_.

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
    score = np.zeros(CAMPAIGNS + 1)  # the last is that of the real inspections
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
    """Return a row of a block at random in each of some worlds."""
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
    """Return the log probability of the inspection in each campaign; the real one is last."""
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
