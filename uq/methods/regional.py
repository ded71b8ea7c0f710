"""Regional sensitivity: which values of each input the rows have in which something happens."""

import numpy as np
from numpy.typing import NDArray
from scipy import stats

from uq.methods.indices import RefusedError
from uq.methods.sample import Floats
from uq.methods.slices import MOST_CATEGORIES

MIN_SIDE = 10
"""Fewer rows than this with the event, or without it, have no distribution to speak of."""


def ks_distances(x: Floats, event: Floats) -> Floats:
    """Measure how differently each input is distributed with an event and without it.

    Parameters
    ----------
    x : ndarray, shape (n, d)
    event : ndarray, shape (n,)
        0 or 1.

    Returns
    -------
    ndarray, shape (d,)
        The distance of Kolmogorov and Smirnov [1]_; of an input with few values the largest over
        all orders of them, which is the distance in total variation and does not depend on what
        the values are called. An input that plays no part has one too.

    Raises
    ------
    RefusedError
        Not an event, or too few rows on a side.

    References
    ----------
    .. [1] R. C. Spear, G. M. Hornberger, "Eutrophication in Peel Inlet II", Water Res. 14, 43-49
       (1980).
    """
    happens = event == 1
    if not (happens | (event == 0)).all():
        raise RefusedError(
            "not an event: 'regional' compares the rows in which something happens with the rest;"
            " ask for a category, or for P(T < t) by a threshold in [analysis]"
        )
    least = int(min(happens.sum(), (~happens).sum()))
    if least < MIN_SIDE:
        raise RefusedError(f"only {least} rows on one side of the event; {MIN_SIDE} are needed")
    return np.array([_distance(column, happens) for column in x.T])


def _distance(column: Floats, happens: NDArray[np.bool_]) -> float:
    values, place = np.unique(column, return_inverse=True)
    if len(values) > MOST_CATEGORIES:
        found = stats.ks_2samp(column[happens], column[~happens], method="asymp")
        return float(found.statistic)
    inside, outside = (
        np.bincount(place[side], minlength=len(values)) / side.sum() for side in (happens, ~happens)
    )
    return float(np.abs(inside - outside).sum() / 2)
