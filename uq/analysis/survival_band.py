"""A simultaneous confidence band of a survival curve."""

import numpy as np
import scipy  # which imports scipy.stats when it is first used

from uq.intervals import CONFIDENCE, Ends, Floats

DRAWS = 4000
"""Curves drawn from the limiting law; its quantile is then known to 1 %."""

POINTS = 500
"""Times at which they are drawn, spread evenly over the ends."""

FEW_ENDS = 0.35
"""The limiting law is too narrow by about this over the root of the number of ends (measured)."""

AT_RISK = 10
"""The band ends where fewer rows are at risk: the limiting law does not hold for so few."""


def simultaneous_band(
    *,
    ending: float,
    among: Floats,
    deviation: Floats,
    at_risk: Floats,
    rows: int,
    ended: int,
    complete: bool,
) -> Ends:
    """Return the 95 % band of the share that outlives each time.

    Parameters
    ----------
    ending : float
        Share p of rows that end.
    among : ndarray, shape (k,)
        Kaplan and Meier's estimate S among these, at times that ascend.
    deviation : ndarray, shape (k,)
        Standard deviation of S over S, by Greenwood.
    at_risk : ndarray, shape (k,)
        Rows seen at each time or later, of those that end.
    rows : int
        All of them, independent.
    ended : int
        Rows whose end is known.
    complete : bool
        Whether no row is censored.

    Returns
    -------
    low, high : ndarray, shape (k,)
        NaN where there is none.

    Notes
    -----
    Without censored rows the share is an empirical one, and the band has the half-width of
    Kolmogorov's exact law [1]_, conservative for laws with steps. With them it is that of Hall and
    Wellner [2]_: c G (1 + tau) with tau the squared relative error of the share G, a half-width
    that is the same at all times where nothing is censored. c is the 95 % quantile of the largest
    |Z| / (G (1 + tau)), drawn from the limiting law of the errors of 1 - p + p S:
    Z = (1 - S) (p (1 - p) / n)^(1/2) N + p S W(deviation^2), N normal and W a Brownian motion
    independent of it.

    References
    ----------
    .. [1] A. N. Kolmogorov, "Sulla determinazione empirica di una legge di distribuzione", G. Ist.
       Ital. Attuari 4, 83-91 (1933).
    .. [2] W. J. Hall, J. A. Wellner, "Confidence bands for a survival curve from censored data",
       Biometrika 67, 133-143 (1980).
    """
    share = 1 - ending + ending * among
    if complete:
        half = np.full(len(share), scipy.stats.kstwo.ppf(CONFIDENCE, rows))
        return _within(share, half, np.ones(len(share), dtype=bool))
    known = np.isfinite(deviation) & (among > 0) & (at_risk >= AT_RISK)
    if not (known & (deviation > 0)).any():
        return np.full(len(share), np.nan), np.full(len(share), np.nan)
    of_share = np.sqrt(ending * (1 - ending) / rows) * (1 - among)
    of_among = ending * among
    relative = rows * (of_share**2 + (of_among * deviation) ** 2) / share**2
    weight = share * (1 + relative)
    largest = _largest(of_share, of_among, deviation, weight, known)
    half = (1 + FEW_ENDS / np.sqrt(ended)) * largest * weight
    return _within(share, half, known)


def _largest(
    of_share: Floats, of_among: Floats, deviation: Floats, weight: Floats, known: np.ndarray
) -> float:
    """Return the quantile of the largest error over its weight."""
    clock = deviation[known] ** 2
    _, steps = np.unique(clock, return_index=True)
    chosen = steps[np.linspace(0, len(steps) - 1, min(POINTS, len(steps))).round().astype(int)]
    rng = np.random.default_rng(0)
    increments = np.sqrt(np.diff(clock[chosen], prepend=0.0))
    motion = np.cumsum(rng.standard_normal((DRAWS, len(chosen))) * increments, axis=1)
    motion *= of_among[known][chosen]
    motion += rng.standard_normal((DRAWS, 1)) * of_share[known][chosen]
    largest = np.abs(motion / weight[known][chosen]).max(axis=1)
    return float(np.quantile(largest, CONFIDENCE))


def _within(share: Floats, half: Floats, known: np.ndarray) -> Ends:
    low, high = np.maximum(share - half, 0.0), np.minimum(share + half, 1.0)
    return np.where(known, low, np.nan), np.where(known, high, np.nan)
