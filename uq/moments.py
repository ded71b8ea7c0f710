"""Mean and standard deviation with their intervals, as far as they exist."""

from typing import NamedTuple

import numpy as np
from scipy import stats

from uq.intervals import (
    CONFIDENCE,
    UNKNOWN,
    Floats,
    Interval,
    Replicates,
    by_replicate,
    is_constant,
    mean_interval,
    scatter_interval,
)
from uq.tails import FEWEST_ROWS, Tail, heavier_tail

LIGHT_ENOUGH = 0.15
"""The interval of a standard deviation needs a fourth moment, which exists for k < 1/4. Measured,
it covers 93 % or more of laws whose samples of some hundred rows show at most this k."""

SUSPECT = 0.4
"""A k above which the interval of a mean carries a caution. Samples of 200 rows of Pareto's law
with index 1.5 seldom show less, those of an exponential law hardly ever more."""

_FEWEST = 8  # rows that show a kurtosis


class Moments(NamedTuple):
    """Mean and standard deviation of an output.

    Attributes
    ----------
    mean, sd : float
        NaN where they do not exist.
    mean_interval, sd_interval : Interval
    tail : Tail or None
        The heavier one.
    reasons : dict of str to str
        For each of the four above that the tail forbids, a sentence.
    caution : str or None
        Why the interval of the mean, although given, may be too narrow.
    """

    mean: float
    mean_interval: Interval
    sd: float
    sd_interval: Interval
    tail: Tail | None
    reasons: dict[str, str]
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
    reasons = {} if tail is None else _refused(tail)
    unknown = replicate is None and "sd_interval" not in reasons and len(values) < FEWEST_ROWS
    if unknown and len(values) > 1 and not is_constant(values):
        reasons["sd_interval"] = f"needs {FEWEST_ROWS} rows that show how heavy the tails are"
    return Moments(
        np.nan if "mean" in reasons else float(values.mean()),
        UNKNOWN if "mean_interval" in reasons else mean_interval(values, replicate, confidence),
        np.nan if "sd" in reasons else standard_deviation(values, replicate),
        UNKNOWN if "sd_interval" in reasons else sd_interval(values, replicate, confidence),
        tail,
        reasons,
        None if tail is None or "mean_interval" in reasons else _caution(tail),
    )


def _caution(tail: Tail) -> str | None:
    if tail.k <= SUSPECT:
        return None
    return (
        f"the interval of the mean may be too narrow: {_seen(tail)} values leaves open whether"
        " there is a variance (k below 0.5)"
    )


def _seen(tail: Tail) -> str:
    which = "largest" if tail.side == "upper" else "smallest"
    return f"k = {tail.k:.2f} ({tail.low:.2f} to {tail.high:.2f}) from the {tail.values} {which}"


def _refused(tail: Tail) -> dict[str, str]:
    seen = _seen(tail)
    remedy = "; use quantiles, or the logarithm or rank of the output"
    reasons = {}
    if tail.k > LIGHT_ENOUGH:
        reasons["sd_interval"] = f"tail too heavy for an interval of sd: {seen} values"
    if tail.no_variance:
        no_variance = f"heavy tail: {seen} values; with k above 0.5 there is no variance"
        reasons["mean_interval"] = f"{no_variance}, hence no interval of the mean{remedy}"
        reasons["sd"] = reasons["sd_interval"] = f"{no_variance}{remedy}"
    if tail.no_mean:
        no_mean = f"heavy tail: {seen} values; with k above 1 there is no mean{remedy}"
        reasons["mean"] = reasons["mean_interval"] = no_mean
    return reasons


def sd_interval(
    values: Floats, replicate: Replicates = None, confidence: float = CONFIDENCE
) -> Interval:
    """Return the interval of the standard deviation.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Finite, of any law with a fourth moment.
    replicate : ndarray of int, shape (n,), optional
    confidence : float, optional

    Returns
    -------
    Interval
        Independent rows: after [1]_, which takes the kurtosis from the rows. Replicates: Student's
        t of the logarithms of their variances. Both with the high end raised by what one more row,
        as far out as the farthest, would add: samples that lack such rows also scatter too little.

    References
    ----------
    .. [1] D. G. Bonett, "Approximate confidence interval for standard deviation of nonnormal
       distributions", Comput. Stat. Data Anal. 50, 775-782 (2006).
    """
    n = len(values)
    if n < _FEWEST or is_constant(values):
        return UNKNOWN
    squares = (values - values.mean()) ** 2
    variance = standard_deviation(values, replicate) ** 2
    if replicate is None:
        low, high = variance * _bonett(values, squares, confidence)
    else:
        found = by_replicate(squares, replicate)
        if not (found > 0).all():
            return UNKNOWN
        logarithm = float(np.log(variance))
        low, high = np.exp(scatter_interval(logarithm, np.log(found), confidence))
    return Interval(float(np.sqrt(low)), float(np.sqrt(high + squares.max() / n)))


def _bonett(values: Floats, squares: Floats, confidence: float) -> Floats:
    """Return the ends of the interval of the variance, over its estimate."""
    n = len(values)
    z = stats.norm.ppf(0.5 + confidence / 2)
    middle = stats.trim_mean(values, 1 / (2 * np.sqrt(n - 4)))
    kurtosis = n * np.sum((values - middle) ** 4) / squares.sum() ** 2
    c = n / (n - z)
    error = c * np.sqrt(max(kurtosis - (n - 3) / n, 0.0) / (n - 1))
    return np.exp(np.log(c) + z * error * np.array([-1, 1]))


def standard_deviation(values: Floats, replicate: Replicates = None) -> float:
    """Return the root of the unbiased variance, NaN of a single row.

    Parameters
    ----------
    values : ndarray, shape (n,)
    replicate : ndarray of int, shape (n,), optional

    Returns
    -------
    float
        The mean square about the mean is too small by the variance of that mean: an n-th of the
        variance for independent rows, much less for designs that spread evenly, where the means of
        the replicates tell it.
    """
    means = values[:1] if replicate is None else by_replicate(values, replicate)
    if len(means) > 1:
        return float(np.sqrt(values.var() + np.var(means, ddof=1) / len(means)))
    return float(values.std(ddof=1)) if len(values) > 1 else np.nan
