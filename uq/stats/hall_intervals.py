"""Skewness-corrected confidence intervals of a mean (Hall 1992)."""

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.stats.intervals import CONFIDENCE, Ends, by_replicate, sized, upper_probability
from uq.stats.jumps import beyond_jumps
from uq.stats.quantile_functions import student


def corrected_mean_interval(
    values: Floats, replicate: NDArray[np.integer], confidence: float = CONFIDENCE
) -> Ends:
    """Return the interval of the mean, corrected for the skewness of its error.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite.
    replicate : ndarray of int, shape (n,)
        Whose means are not all equal.
    confidence : float, optional

    Returns
    -------
    low, high : float
        `hall_interval` of the means of the replicates, which allows for jumps that they do not
        show (`uq.stats.jumps`), and for one more row as far out as the farthest.
    """
    values, size = sized(values)  # squares neither overflow nor vanish
    means = by_replicate(values, replicate)
    ends = hall_interval(means, confidence)
    low, high = beyond_jumps(float(means.mean()), ends, values, replicate, confidence)
    away = values - values.mean()
    moved = float(away[np.abs(away).argmax()]) / len(values)
    return size * (low + min(moved, 0.0)), size * (high + max(moved, 0.0))


def hall_interval(estimates: Floats, confidence: float = CONFIDENCE) -> Ends:
    """Return the interval of the mean of independent estimates, corrected for their skewness.

    Parameters
    ----------
    estimates : ndarray, shape (n,)
        Finite, not all equal.
    confidence : float, optional

    Returns
    -------
    low, high : float
        By the cubic transformation of Student's t whose skewness vanishes [1]_; without skewness
        it is Student's interval.

    References
    ----------
    .. [1] P. Hall, "On the removal of skewness by transformation", J. R. Stat. Soc. B 54, 221-228
       (1992), g1 of section 2.

    Examples
    --------
    >>> import numpy as np
    >>> values = np.random.default_rng(1).lognormal(size=200)
    >>> low, high = hall_interval(values)
    >>> bool(high - values.mean() > 1.2 * (values.mean() - low))
    True
    """
    estimates, size = sized(estimates)
    n, mean = len(estimates), float(estimates.mean())
    away = estimates - mean
    skewness = float((away**3).mean() / (away**2).mean() ** 1.5)
    error = float(estimates.std(ddof=1)) / n**0.5
    t = student(upper_probability(confidence), n - 1)
    low, high = (mean - error * _untransformed(end, skewness / n**0.5) for end in (t, -t))
    return size * low, size * high


def _untransformed(x: float, skewness: float) -> float:
    """Return t whose transform t + s t^2 / 3 + s^2 t^3 / 27 + s / 6 is x."""
    if abs(skewness) < 1e-6:  # where the inverse loses digits and hardly changes x
        return x
    return float(np.cbrt(1 + skewness * (x - skewness / 6)) - 1) * 3 / skewness
