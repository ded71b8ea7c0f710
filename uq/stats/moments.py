"""Mean and standard deviation with their intervals, where they exist."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.stats.clusters import Clusters
from uq.stats.estimate import Estimate
from uq.stats.intervals import (
    CONFIDENCE,
    ONE_ROW,
    UNKNOWN,
    Ends,
    Replicates,
    beyond_outliers,
    by_replicate,
    is_constant,
    mean_interval,
    parts_are_independent,
    scatter_interval,
    sized,
    upper_probability,
)
from uq.stats.jumps import beyond_jumps
from uq.stats.quantile_functions import student
from uq.stats.tails import Tail, heavier_tail


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


SUSPECT = 0.4
"""A k above which the intervals carry a caution. Samples of 200 rows of Pareto's law with index 1.5
seldom show less, those of an exponential law hardly ever more."""

ENOUGH_ROWS = 200
"""Independent rows from which the standard deviation has an interval. Of fewer, too many hold no
value far out, and scatter too little: of a lognormal law with sigma 1, the intervals of 50 rows
cover 87 %, of 100 rows 90 %, of 200 rows 93 %. Whether they are given must not depend on the
values."""

OUTLYING_SQUARES = 3
"""More rows as far from the mean as the farthest for which the interval of a standard deviation
allows. Squares are more skewed than values: of 200 lognormal rows with sigma 1 it covers 90 % with
two, as means have, and 93 % with three."""

_FEWEST = 8  # rows that show how squares scatter


class Moments(NamedTuple):
    """Mean and standard deviation of an output.

    Attributes
    ----------
    mean, sd : Estimate
        With the reason where the tail rules out the number, or only its interval.
    tail : Tail or None
        The heavier one.
    caution : str or None
        Why the intervals may be too narrow.
    """

    mean: Estimate
    sd: Estimate
    tail: Tail | None
    caution: str | None


def moments(
    values: Floats, replicate: Replicates = None, confidence: float = CONFIDENCE
) -> Moments:
    """Estimate mean and standard deviation.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite; at least one.
    replicate : ndarray of int, shape (n,), optional
    confidence : float, optional

    Returns
    -------
    Moments
    """
    tail = heavier_tail(values)
    has_mean, has_sd = tail is None or not tail.no_mean, tail is None or not tail.no_variance
    no_mean = no_sd = "" if tail is None or has_sd else _no_variance(tail)
    if tail is not None and not has_mean:
        no_mean = f"heavy tail: {_seen(tail)}; with k above 1 there is no mean{_REMEDY}"
    if not no_sd and replicate is None and 1 < len(values) < ENOUGH_ROWS:
        if not is_constant(values):
            no_sd = f"needs {ENOUGH_ROWS} rows: fewer seldom show how far the tails reach"
    if len(values) == 1:
        no_mean = no_sd = ONE_ROW
    mean = float(values[0] if np.ptp(values) == 0 else values.mean())  # else it may be rounded
    return Moments(
        Estimate(
            mean if has_mean else np.nan,
            *(UNKNOWN if no_mean else mean_interval(values, replicate, confidence)),
            no_mean,
        ),
        Estimate(
            standard_deviation(values, replicate) if has_sd else np.nan,
            *(UNKNOWN if no_sd else sd_interval(values, replicate, confidence)),
            no_sd,
        ),
        tail,
        None if no_mean else _caution(tail),
    )


def _caution(tail: Tail | None) -> str | None:
    if tail is None or tail.k <= SUSPECT:
        return None
    return (
        f"intervals of mean and sd may be too narrow: {_seen(tail)} does not decide whether"
        " there is a variance (k below 0.5)"
    )


def _seen(tail: Tail) -> str:
    which = "largest" if tail.side == "upper" else "smallest"
    interval = f"({tail.low:.2f} to {tail.high:.2f})"
    return f"k = {tail.k:.2f} {interval} from the {tail.values} {which} values"


_REMEDY = "; use quantiles, or the logarithm or rank of the output"


def _no_variance(tail: Tail) -> str:
    """Return why there is no standard deviation and no interval of the mean, printed once."""
    no_variance = f"heavy tail: {_seen(tail)}; with k above 0.5 there is no variance"
    return f"{no_variance}, hence no interval of the mean{_REMEDY}"


def sd_interval(
    values: Floats, replicate: Replicates = None, confidence: float = CONFIDENCE
) -> Ends:
    """Return the interval of the standard deviation.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite.
    replicate : ndarray of int, shape (n,), optional
    confidence : float, optional

    Returns
    -------
    low, high : float
        Of independent rows, or samples of several rows: Student's t of their squares [1]_ about
        the mean, as the relative error of the variance, with that of the mean, both for the
        logarithm; it allows for more outliers (`uq.stats.intervals.beyond_outliers`), since
        samples without them scatter too little. Replicates: Student's t of the logarithms of
        their variances, with the error of jumps that they do not show (`uq.stats.jumps`); the
        upper end is raised by what one more row as extreme as the farthest would add.

    References
    ----------
    .. [1] A. W. van der Vaart, "Asymptotic statistics", Cambridge (1998), example 3.2.
    """
    n = len(values)
    if n < _FEWEST or is_constant(values):
        return UNKNOWN
    values, size = sized(values)
    squares = (values - values.mean()) ** 2
    variance = standard_deviation(values, replicate) ** 2
    mean_squares = squares if replicate is None else by_replicate(squares, replicate)
    if parts_are_independent(replicate):
        low, high = _relative_ends(mean_squares / variance, confidence)
        return size * float(np.sqrt(variance * low)), size * float(np.sqrt(variance * high))
    logarithm = float(np.log(variance))
    if isinstance(replicate, Clusters):  # a few rows each: their logarithms scatter too much
        low, high = np.exp(scatter_interval(logarithm, mean_squares / variance, confidence))
        high += mean_squares.max() / max(len(mean_squares), replicate.samples)
    elif (mean_squares > 0).all():
        low, high = np.exp(scatter_interval(logarithm, np.log(mean_squares), confidence))
        low, high = beyond_jumps(variance, (low, high), squares, replicate, confidence)
        low, high = max(low, 0.0), high + squares.max() / n
    else:
        return UNKNOWN
    return size * float(np.sqrt(low)), size * float(np.sqrt(high))


def _relative_ends(squares: Floats, confidence: float) -> Ends:
    """Return the ends of the interval of a variance over its estimate, from relative squares."""
    n = len(squares)
    if n < 2:
        return UNKNOWN
    wide = student(upper_probability(confidence), n - 1)
    # The mean is off by t s / sqrt(n), which counts only where nearly all squares are equal.
    half = np.hypot(wide * squares.std(ddof=1) / n**0.5, wide**2 / n)
    ends = beyond_outliers(0.0, (-half, half), squares - squares.mean(), OUTLYING_SQUARES)
    return float(np.exp(ends[0])), float(np.exp(ends[1]))


def standard_deviation(values: Floats, replicate: Replicates = None) -> float:
    """Return the root of the unbiased variance, NaN for a single row.

    Parameters
    ----------
    values : ndarray, shape (n,)
    replicate : ndarray of int, shape (n,), optional

    Returns
    -------
    float
        The mean square about the mean is too small by the variance of that mean: an n-th of the
        variance for independent rows, much less for designs that spread evenly, where it is
        estimated from the means of the replicates.
    """
    if len(values) < 2:
        return np.nan
    if np.ptp(values) == 0:
        return 0.0  # that of their mean, which is rounded, would be another
    values, size = sized(values)
    means = values[:1] if replicate is None else by_replicate(values, replicate)
    if len(means) > 1:
        return size * float(np.sqrt(values.var() + np.var(means, ddof=1) / len(means)))
    return size * float(values.std(ddof=1))
