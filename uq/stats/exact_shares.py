"""The interval of a share estimated from few hits, where Wilson's covers too little."""

import numpy as np
from scipy import special

from uq.contract import Floats, Mask

FEW = 20
"""Below so many hits, or misses, an interval is exact.

Wilson's lower end lies above the true share in up to 16 % of samples where one hit is seen, in up
to 4 % from twenty hits on.
"""


def are_few(share: Floats | float, rows: Floats | float) -> Mask:
    """Whether there are few hits or few misses; false where the share is unknown."""
    rarer = np.minimum(share, 1 - np.asarray(share)) * rows
    return np.asarray(np.round(rarer, 6) < FEW)


def exact_interval(
    share: Floats | float, rows: Floats | float, confidence: float
) -> tuple[Floats, Floats]:
    """Return the interval of Clopper and Pearson [1]_ of a share, or of several.

    Parameters
    ----------
    share : float or ndarray, shape (k,)
    rows : float or ndarray, shape (k,)
        Effective number of independent rows; need not be an integer [2]_.
    confidence : float

    Returns
    -------
    low, high : ndarray
        Each misses in at most ``(1 - confidence) / 2`` of samples, less often where hits are few.

    References
    ----------
    .. [1] C. J. Clopper, E. S. Pearson, "The use of confidence or fiducial limits illustrated in
       the case of the binomial", Biometrika 26, 404-413 (1934).
    .. [2] E. L. Korn, B. I. Graubard, "Confidence intervals for proportions with small expected
       number of positive counts estimated from survey data", Surv. Methodol. 24, 193-201 (1998).
    """
    tail = (1 - confidence) / 2
    hits = np.asarray(share * rows, dtype=float)
    # Rounding must not leave a fraction of a hit where there was none.
    whole = np.round(hits)
    hits = np.where(np.abs(hits - whole) <= 1e-9, whole, hits)
    misses = np.maximum(rows - hits, 0.0)
    low = np.where(hits > 0, special.betaincinv(np.maximum(hits, 1e-9), misses + 1, tail), 0.0)
    high = np.where(misses > 0, special.betainccinv(hits + 1, np.maximum(misses, 1e-9), tail), 1.0)
    return low, high
