"""A simultaneous confidence band of a survival curve."""

from functools import lru_cache

import numpy as np

from uq.contract import Floats, Mask
from uq.stats.beta_products import BetaProducts
from uq.stats.intervals import CONFIDENCE, Ends

DRAWS = 4000
"""Curves drawn; the coverage is then set to 0.3 %."""

POINTS = 300
"""Ends at which they are drawn: all, or as many that are spread over the odds of having ended."""

_HALVINGS = 9  # of the logarithm of the level at each end


def simultaneous_band(values: Floats, censored: Mask, time: Floats, *, known_at_once: bool) -> Ends:
    """Return the 95 % band of the share that outlives each time.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Of independent rows; +inf for those that never end.
    censored : ndarray of bool, shape (n,)
    time : ndarray, shape (k,)
        Ascending [s]
    known_at_once : bool
        Whether every censored row is one that ends.

    Returns
    -------
    low, high : ndarray, shape (k,)
        Valid from each time until before the next; NaN if no row ends.

    Notes
    -----
    Its ends are the quantiles of `BetaProducts`, with the same tail probability at all times, so
    that all together miss in 5 % of curves drawn [1]_. Between two ends the number of expected
    ends is exponential however rows are censored, hence the draws: exact without censored rows,
    conservative for laws with steps.

    References
    ----------
    .. [1] S. Aldor-Noiman, L. D. Brown, A. Buja, W. Rolke, R. A. Stine, "The power to see: a new
       graphical test of normality", Am. Stat. 67, 249-260 (2013).
    """
    law = BetaProducts(values, censored, known_at_once=known_at_once)
    if not len(law.ends):
        return np.full(len(time), np.nan), np.full(len(time), np.nan)
    order = np.lexsort((censored, values))
    ranks = np.unique(values, return_inverse=True)[1].astype(float)
    ranks[np.isposinf(values)] = np.inf
    tail = _tail(ranks[order].tobytes(), censored[order].tobytes(), known_at_once)
    return 1 - law.ended_after(time).quantile(1 - tail), 1 - law.ended_by(time).quantile(tail)


@lru_cache(maxsize=8)
def _tail(ranks: bytes, censored: bytes, known_at_once: bool) -> float:
    """Return the tail probability at each time for which 5 % of curves leave the band.

    It depends on the order of the rows alone: elements without censored rows share one.
    """
    rows = np.frombuffer(ranks), np.frombuffer(censored, dtype=bool)
    law = BetaProducts(*rows, known_at_once=known_at_once)
    last = law.ends[-1:]
    ended = law.ended_by(law.ends)
    with np.errstate(divide="ignore"):
        odds = np.log(ended.mean) - np.log1p(-ended.mean)
    wanted = np.linspace(odds[0], odds[-1], min(POINTS, len(odds)))
    chosen = np.unique(np.searchsorted(odds, wanted).clip(0, len(odds) - 1))
    if len(odds) <= POINTS:
        chosen = np.arange(len(odds))
    ended, after = law.ended_by(law.ends[chosen]), law.ended_after(last)

    rng = np.random.default_rng(0)
    mean, variance = np.diff(law.cumulative[chosen], axis=0, prepend=[[0.0, 0.0]]).T
    steps = rng.standard_gamma(mean**2 / variance, (DRAWS, len(chosen))) * (variance / mean)
    a, b = law.ending
    ever = rng.beta(a, b, (DRAWS, 1)) if b else np.ones((DRAWS, 1))
    logs = np.cumsum(steps, axis=1)
    curves = ever * -np.expm1(-logs)
    left = float(law.at_risk_after(last)[0])
    further = logs[:, -1] + rng.standard_exponential(DRAWS) / left if left else np.inf
    beyond = ever[:, 0] * -np.expm1(-further)

    def leaving(tail: float) -> float:
        outside = (curves < ended.quantile(tail)) | (curves > ended.quantile(1 - tail))
        past = beyond > after.quantile(1 - tail)
        return float((outside.any(axis=1) | past).mean())

    most = (1 - CONFIDENCE) / 2
    low, high = np.log(most / (len(chosen) + 1)), np.log(most)
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        if leaving(np.exp(middle)) <= 1 - CONFIDENCE:
            low = middle
        else:
            high = middle
    return float(np.exp(low))
