"""Bounds on how a probability is distributed over worlds, from counts, whatever that law."""

from collections.abc import Callable

import numpy as np
from scipy import special

from uq.contract import Floats
from uq.stats.intervals import Replicates, share_interval
from uq.stats.weighted_means import weighted_share

_BELOW, _ABOVE = 0.15, 0.04
"""Probability of a count up to, and beyond, the thresholds in a world at the point."""

_MOST_COUNTS = 200


def mixing_bounds(
    probability: Floats,
    mean: Floats,
    size: Floats,
    weights: Floats,
    worth: Floats,
    part: Replicates,
    is_counted: bool,
) -> Callable[[float], tuple[float, float]]:
    """Return confidence bounds on the share of worlds in which a unit's probability is larger.

    Parameters
    ----------
    probability : ndarray, shape (k,)
        Points, ascending.
    mean : ndarray, shape (samples, nodes)
        Share of the units of a world that ended.
    size : ndarray, shape (samples, nodes)
        Independent units that scatter as much.
    weights : ndarray, shape (nodes,)
    worth : ndarray, shape (samples,)
        Weights of worlds.
    part : ndarray of int, shape (samples,), or None
    is_counted : bool
        Whether each unit has ended or not, so that counts are binomial; otherwise about so.

    Returns
    -------
    callable
        Probability -> lower and upper bound of the share of worlds whose probability is larger.

    Notes
    -----
    Let G be the law of the probability over worlds, F the share of worlds of which at most a share
    c of the units ended, and K(p) the probability of this in a world of probability p. K falls, so
    that for every G [1]_

        K(p) G(p) <= F <= G(p) + (1 - G(p)) K(p).

    With the ends of the interval of F these bound G(p) on both sides, each from a c chosen by p
    and the number of units alone. They are conservative: they allow for laws of two values, and are
    close only with many units.

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
    ends = np.array([_ends((mean <= c) @ weights, worth, part) for c in threshold])
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


def _ends(share: Floats, worth: Floats, part: Replicates) -> tuple[float, float]:
    """Return the interval of a share of worlds, from 0 to 1 where none can be estimated."""
    if np.ptp(worth) > 0 or not np.isin(share, (0.0, 1.0)).all():
        low, high = weighted_share(share, worth, part).numbers[1:]
    else:
        low, high = share_interval(share > 0, part)
    return (0.0, 1.0) if np.isnan(low) else (low, high)


def _at_most(
    threshold: Floats,
    probability: Floats,
    often: Floats,
    sizes: Floats,
    step: float,
    is_counted: bool,
) -> Floats:
    """Return P(a share of units up to a threshold ended), shape (probabilities, thresholds)."""
    at_most = np.zeros((len(probability), len(threshold)))
    for weight, size in zip(often, sizes, strict=True):
        count = np.floor(threshold * size) if is_counted else threshold * size + step
        count = np.clip(count, -1.0, size)
        inside = (count >= 0) & (count < size)
        k = np.where(inside, count, 0.0)
        below = special.betaincc(k + 1, size - k, probability[:, None])
        at_most += weight * np.where(inside, below, count >= size)
    return at_most
