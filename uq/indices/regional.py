"""Regional sensitivity: where in each input's range the rows lie in which something happens."""

import numpy as np
from scipy import stats

from uq.indices.targets import RefusedError
from uq.rows.elements import Floats

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
        The distance of Kolmogorov and Smirnov [1]_. An input that plays no part has one too; it
        depends on the numbers of rows alone.

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
    inside, outside = x[happens], x[~happens]
    return np.array(
        [
            stats.ks_2samp(one, other, method="asymp").statistic
            for one, other in zip(inside.T, outside.T, strict=True)
        ]
    )
