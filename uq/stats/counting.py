"""Counts of failed units: their distribution in a fleet, and bounds on the mixing distribution."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from scipy import special

from uq.contract import Floats
from uq.stats.dependent_rows import Dependence
from uq.stats.intervals import share_interval
from uq.stats.weighted_means import weighted_share

_MOST_NUMBERS = 10_000_000

_BELOW, _ABOVE = 0.15, 0.04
"""Largest probability of a count up to the lower threshold, and above the upper, at a point."""

_MOST_COUNTS = 200


def more_than(ended: Floats, size: int, allow: int, are_alike: bool) -> Floats:
    """Return the probability that more than `allow` units of a fleet have ended, by sample.

    Parameters
    ----------
    ended : ndarray, shape (samples, units, nodes)
        As in `at_most`; a single unit per sample if the units are alike.
    size, allow : int
    are_alike : bool
        Whether all units of a sample have the same known probability.

    Returns
    -------
    ndarray, shape (samples, nodes)
    """
    if allow >= size:
        return np.zeros(ended[:, 0].shape)
    if are_alike:
        return np.asarray(special.bdtrc(allow, size, ended[:, 0]))
    return 1 - at_most(ended, size, allow)


def fleet_failure_probabilities(lives: Floats, size: int, allow: int, are_alike: bool) -> Floats:
    """Return the probability that each failure is the (allow + 1)-th of a random fleet.

    The life of a fleet ends when more than `allow` of its units have ended. This is at the life of
    one unit. If all lives of a sample are multiplied by a common factor, their order does not
    change, and neither do these probabilities.

    Parameters
    ----------
    lives : ndarray, shape (samples, units, repeats)
        NaN for missing lives.
    size, allow : int
    are_alike : bool
        Whether all units of a sample share one distribution of lives.

    Returns
    -------
    ndarray, shape (samples, units, repeats)
        Zero in samples with too few units.
    """
    samples, units, repeats = lives.shape
    blocks = -(-lives.size * units * repeats // _MOST_NUMBERS)
    probabilities = []
    for block in np.array_split(lives, max(blocks, 1)):
        table = block.reshape(len(block), 1, -1) if are_alike else block
        order, ended = _one_by_one(table)
        turn = np.zeros(order.shape)
        steps = np.diff(more_than(ended, size, allow, are_alike), axis=1, prepend=0.0)
        np.put_along_axis(turn, order, steps, axis=1)
        probabilities.append(turn)
    whole = np.nan_to_num(np.concatenate(probabilities)).reshape(lives.shape)
    return np.where(np.isnan(lives), 0.0, whole)


def _one_by_one(lives: Floats) -> tuple[NDArray[np.intp], Floats]:
    """Return the order of the lives of each sample, and the ended share of each unit at each life.

    Shapes (samples, lives) and (samples, units, lives).
    """
    samples, units, repeats = lives.shape
    present = np.isfinite(lives) | np.isposinf(lives)
    count = present.sum(axis=2)
    order = np.argsort(lives.reshape(samples, -1), axis=1)
    sample, place = np.indices(order.shape)
    parts = present / np.maximum(count, 1)[..., None]
    ended = np.zeros((samples, units, units * repeats))
    ended[sample, order // repeats, place] = np.take_along_axis(
        parts.reshape(samples, -1), order, axis=1
    )
    ended = np.minimum(np.cumsum(ended, axis=2), 1.0)
    ended[count == 0] = np.nan
    return order, ended


def at_most(ended: Floats, size: int, allow: int) -> Floats:
    """Return the probability that at most `allow` units of a fleet have ended, by sample.

    Parameters
    ----------
    ended : ndarray, shape (samples, units, nodes)
        Probability that each unit has ended, independent between units; NaN for excluded units.
    size, allow : int

    Returns
    -------
    ndarray, shape (samples, nodes)
        Mean over all fleets of `size` different units of the sample. It is unbiased for newly drawn
        units; a power of the mean probability is not. NaN if a sample has fewer units.
    """
    samples, units, nodes = ended.shape
    rows = np.sort(np.moveaxis(ended, 1, 2).reshape(samples * nodes, units), axis=1)
    counts = np.isfinite(rows).sum(axis=1)
    probability = np.full(len(rows), np.nan)
    for count in np.unique(counts[counts >= size]):
        group = rows[counts == count, :count]
        certain = bool(np.isin(group, (0.0, 1.0)).all())
        probability[counts == count] = (_of_certain if certain else _of_any)(
            group, size, min(allow, size)
        )
    return probability.reshape(samples, nodes)


def _of_certain(ended: Floats, size: int, allow: int) -> Floats:
    """Return `at_most` by the hypergeometric law, for probabilities that are all 0 or 1."""
    units = ended.shape[1]
    count = np.arange(units + 1.0)
    in_fleet = np.arange(allow + 1.0)[:, None]
    log_ways = _log_choose(count, in_fleet) + _log_choose(units - count, size - in_fleet)
    table = np.exp(log_ways - _log_choose(units, size)).sum(axis=0)
    return np.asarray(np.minimum(table, 1.0)[ended.sum(axis=1).astype(int)])


def _log_choose(n: Floats | float, k: Floats | float) -> Floats:
    n, k = np.asarray(n, float), np.asarray(k, float)
    logarithm: Floats = special.gammaln(n + 1) - special.gammaln(k + 1) - special.gammaln(n - k + 1)
    return logarithm


def _of_any(ended: Floats, size: int, allow: int) -> Floats:
    """Return `at_most` for arbitrary probabilities of the units.

    A recursion over m gives the mean over all fleets of r units out of the first m. Unit m belongs
    to a share r / m of these fleets. The recursion takes weighted means, so that no digits cancel.
    """
    rows, units = ended.shape
    most = max(1, _MOST_NUMBERS // ((size + 1) * (allow + 1)))
    if rows > most:
        blocks = np.array_split(ended, -(-rows // most))
        return np.concatenate([_of_any(block, size, allow) for block in blocks])
    chance = np.zeros((size + 1, allow + 1, rows))
    chance[0, 0] = 1.0
    for m in range(1, units + 1):
        p = ended[:, m - 1]
        low, high = max(1, size - (units - m)), min(m, size)
        share = (np.arange(low, high + 1) / m)[:, None, None]
        before = chance[low - 1 : high]
        added = before * (1 - p)
        added[:, 1:] += before[:, :-1] * p
        chance[low : high + 1] = (1 - share) * chance[low : high + 1] + share * added
    return np.asarray(chance[size].sum(axis=0))


def mixing_bounds(
    probability: Floats,
    mean: Floats,
    size: Floats,
    weights: Floats,
    worth: Floats,
    dependence: Dependence,
    is_counted: bool,
) -> Callable[[float], tuple[float, float]]:
    """Return confidence bounds on the mixing distribution of the failure probability.

    Parameters
    ----------
    probability : ndarray, shape (k,)
        Points, ascending.
    mean : ndarray, shape (samples, nodes)
        Share of ended units in each sample.
    size : ndarray, shape (samples, nodes)
        Effective number of independent units.
    weights : ndarray, shape (nodes,)
    worth : ndarray, shape (samples,)
        Weights of the samples.
    dependence : Dependence
        Of the samples.
    is_counted : bool
        Whether each unit has either ended or not: counts are then binomial, otherwise
        approximately binomial.

    Returns
    -------
    callable
        Probability -> lower and upper bound of the share of samples whose probability is larger.

    Notes
    -----
    Let G(p) be the share of samples with a probability of at most p. Let F be the share of samples
    in which at most a share c of the units ended, and K(p) the probability of this event given p.
    K decreases in p, so that for every G [1]_

        K(p) G(p) <= F <= G(p) + (1 - G(p)) K(p).

    With the ends of the confidence interval of F, this bounds G(p) on both sides. The threshold c
    of each bound is chosen from p and the number of units alone. The bounds are conservative: they
    hold for two-point laws too, and are tight only with many units.

    References
    ----------
    .. [1] N. Ignatiadis, S. Wager, "Confidence intervals for nonparametric empirical Bayes
       analysis", J. Am. Stat. Assoc. 117, 1149-1166 (2022), which uses all F at once.
    """
    count = int(np.clip(round(float(np.median(size))), 1, _MOST_COUNTS))
    threshold = (np.arange(count) + 0.5) / count
    sizes, places = np.unique(size, return_inverse=True)
    often = np.bincount(places.ravel(), np.outer(worth, weights).ravel())
    shares = (often / often.sum(), sizes)
    few = _at_most(threshold, probability, *shares, 0.0 if is_counted else -1.0, is_counted)
    many = _at_most(threshold, probability, *shares, 0.0, is_counted)
    ends = np.array([_ends((mean <= c) @ weights, worth, dependence) for c in threshold])
    low, high = np.zeros(len(probability)), np.ones(len(probability))
    for i in range(len(probability)):
        below = int(np.searchsorted(many[i], _BELOW, side="right")) - 1
        above = int(np.searchsorted(few[i], 1 - _ABOVE))
        if below >= 0:
            low[i] = max(0.0, (ends[below, 0] - many[i, below]) / (1 - many[i, below]))
        if above < count:
            high[i] = min(1.0, ends[above, 1] / few[i, above])
    most = np.append(1.0, 1 - np.minimum.accumulate(low[::-1])[::-1])
    least = np.append(1 - np.maximum.accumulate(high), 0.0)

    def exceeding(level: float) -> tuple[float, float]:
        place = int(np.searchsorted(probability, level, side="right"))
        return float(least[place]), float(most[place])

    return exceeding


def _ends(share: Floats, worth: Floats, dependence: Dependence) -> tuple[float, float]:
    """Return the confidence interval of a share of samples; 0 to 1 if it cannot be estimated."""
    if np.ptp(worth) > 0 or not np.isin(share, (0.0, 1.0)).all():
        low, high = weighted_share(share, worth, dependence).numbers[1:]
    else:
        low, high = share_interval(share > 0, dependence)
    return (0.0, 1.0) if np.isnan(low) else (low, high)


def _at_most(
    threshold: Floats,
    probability: Floats,
    often: Floats,
    sizes: Floats,
    step: float,
    is_counted: bool,
) -> Floats:
    """Return P(ended share <= threshold | probability), shape (probabilities, thresholds)."""
    at_most = np.zeros((len(probability), len(threshold)))
    for weight, size in zip(often, sizes, strict=True):
        count = np.floor(threshold * size) if is_counted else threshold * size + step
        count = np.clip(count, -1.0, size)
        inside = (count >= 0) & (count < size)
        k = np.where(inside, count, 0.0)
        below = special.betaincc(k + 1, size - k, probability[:, None])
        at_most += weight * np.where(inside, below, count >= size)
    return at_most
