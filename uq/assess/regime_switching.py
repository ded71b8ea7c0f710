"""Probability that a repeat of the same unit ends in another regime."""

from collections.abc import Collection

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.result.nesting import Nesting
from uq.result.result import Result
from uq.sampling.designs import several
from uq.sampling.levels import CHANCE, OWN
from uq.stats.clusters import Clusters
from uq.stats.estimate import Estimate
from uq.stats.intervals import by_replicate, scattered_share_interval
from uq.stats.weighted_means import weighted_share

ONE_REPEAT = "a single repeat does not show whether another ends in another regime; {}"


def switching(
    rows: Result, place: Nesting, varying: Collection[str], weights: Floats | None = None
) -> tuple[Estimate, Floats]:
    """Estimate the probability that a repeat ends in another regime.

    Parameters
    ----------
    rows : Result
        Rows of a result with regimes.
    place : Nesting
        Nesting of these rows.
    varying : collection of str
        The levels on which something varies.
    weights : ndarray, shape (samples,), optional
        Of samples.

    Returns
    -------
    mean : Estimate
        Over all rows; its interval rests on samples. Zero where nothing is random.
    each : ndarray, shape (n,)
        Of each row: the share of the other repeats of its unit that end in another regime. NaN
        without a regime, or another repeat. Where nothing is own to a unit, units are repeats.
    """
    codes = rows.dataset["regime"].values
    if CHANCE not in varying:
        return Estimate(0.0, 0.0, 0.0), np.where(codes >= 0, 0.0, np.nan)
    unit = place.sample * place.units + place.unit if OWN in varying else place.sample
    elsewhere = _elsewhere(unit, codes)
    defined = np.isfinite(elsewhere)
    if not defined.any():
        return Estimate(reason=ONE_REPEAT.format(several("repeats", rows.design_name))), elsewhere
    value, clusters = float(elsewhere[defined].mean()), rows.replicates
    if not isinstance(clusters, Clusters):
        clusters = Clusters(place.sample, place.samples)
    if weights is not None:
        return weighted_share(
            elsewhere[defined], weights[place.sample[defined]], clusters[defined]
        ), elsewhere
    means = by_replicate(elsewhere[defined], clusters[defined])
    low, high = scattered_share_interval(
        value, means, rows=int(defined.sum()), samples=clusters.samples
    )
    return Estimate(value, float(low), float(high)), elsewhere


def _elsewhere(unit: NDArray[np.integer], codes: NDArray[np.integer]) -> Floats:
    """Return for each row the share of the other rows of its unit with another code."""
    probabilities = np.full(len(codes), np.nan)
    kept = codes >= 0
    _, place = np.unique(unit[kept], return_inverse=True)
    pairs = place * (int(codes.max(initial=0)) + 1) + codes[kept]
    _, same = np.unique(pairs, return_inverse=True)
    others = np.bincount(place)[place] - 1
    alike = np.bincount(same)[same] - 1
    share = np.divide(others - alike, others, out=np.full(len(place), np.nan), where=others > 0)
    probabilities[kept] = share
    return probabilities
