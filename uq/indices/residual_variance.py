"""Residual variance given one input, by difference-based estimators along that input."""

from collections.abc import Callable
from functools import cache, lru_cache, partial
from itertools import islice
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.stats.dependent_rows import INDEPENDENT, Dependence
from uq.stats.order_statistics import ascending_order

LEAST_LAGS = 8
"""Minimum number of lags; with fewer, the intercept of a parabola is too noisy."""

_MOST_LAGS = 100
_FEWEST_LAGS = 4
_LEAST_PAIRED = 0.1  # least share of pairs at one lag that are from different replicates
_FEWEST_EQUAL = 5  # fewest rows of one value from which the variance at this value is estimated
_MOST_NEIGHBOURS = 30
_BENT = 3.0  # standard errors by which the estimate from fewer lags may differ
_JUMP = 16.0  # ratio of the squared residuals of both sides that indicates a jump


class Residual(NamedTuple):
    """Estimated residual variance, with the terms required for its standard error.

    Attributes
    ----------
    variance : float
        Mean of Var(y | x), summed over elements.
    squares : ndarray, shape (n,)
        Squared residual of each row, weighted as in the estimate.
    noise : float
        n times the variance that the pairing of rows adds to the mean of these squares.
    excess : float
        n times the variance that smoothing adds to the difference between the squared residual and
        the squared deviation from the mean.
    """

    variance: float
    squares: Floats
    noise: float
    excess: float


def variance(y: Floats, dependence: Dependence = INDEPENDENT) -> float:
    """Return the unbiased variance, summed over elements.

    Parameters
    ----------
    y : ndarray, shape (n, e)
    dependence : Dependence, optional
        Only rows of different replicates are compared, since rows of one replicate may be
        dependent.
    """
    pairs, total = float(len(y)) ** 2, _pair_sum(y)
    if dependence.labels is None:
        return total / (pairs - len(y))
    for number in np.unique(dependence.labels):
        rows = y[dependence.labels == number]
        pairs, total = pairs - float(len(rows)) ** 2, total - _pair_sum(rows)
    return total / pairs if pairs > 0 else np.nan


def _pair_sum(y: Floats) -> float:
    """Return half the sum of squared differences over all ordered pairs of rows."""
    return float(len(y) * np.sum((y - y.mean(axis=0)) ** 2))


def ordered_residual_variance(y: Floats, dependence: Dependence = INDEPENDENT) -> float:
    """Estimate the residual variance without its error terms, from rows sorted by an input.

    The input has no ties.
    """
    return variance(y, dependence) if len(y) <= 2 * LEAST_LAGS else _extrapolated(y, dependence)[2]


def residual_variance(x: Floats, y: Floats, dependence: Dependence = INDEPENDENT) -> Residual:
    """Estimate the residual variance of an output given one input, E[Var(y | x)].

    Parameters
    ----------
    x : ndarray, shape (n,)
    y : ndarray, shape (n, e)
    dependence : Dependence, optional

    Returns
    -------
    Residual
        Values of the input that at least five rows share contribute the variance of these rows,
        which is exact for discrete inputs. For all other rows, the estimate uses half the mean
        squared difference of rows at lag l in the order of the input. It exceeds the residual
        variance by the change of the conditional mean over l rows: in proportion to l at jumps, and
        to l^2 where the mean is smooth. The intercept of a parabola in l removes both errors [1]_,
        [2]_. The first and last l rows, which have one partner instead of two, count twice.

    Notes
    -----
    More lags reduce the noise, but widen the range over which the mean is assumed to be a parabola
    with few jumps. The number of lags increases with n, and with the ratio of residual to explained
    variance. It is halved, down to four lags, as long as fewer lags change the intercept by more
    than the noise; the change of the last halving beyond the noise is added to the error. Waves of
    fewer rows each than about three times the number of lags do not follow a parabola in l, and the
    intercept does not reveal this. For waves of five rows no number of lags works.

    References
    ----------
    .. [1] T. Tong, Y. Wang, "Estimating residual variance in nonparametric regression using least
       squares", Biometrika 92, 821-830 (2005).
    .. [2] P. Hall, J. W. Kay, D. M. Titterington, "Asymptotically optimal difference-based
       estimation of variance in nonparametric regression", Biometrika 77, 521-528 (1990).
    """
    order = ascending_order(x)
    starts = np.flatnonzero(np.append(True, np.diff(x[order]) != 0))
    counts = np.diff(np.append(starts, len(order)))
    shared = counts >= _FEWEST_EQUAL
    alike = [order[i : i + k] for i, k in zip(starts[shared], counts[shared], strict=True)]
    rest = order[np.repeat(~shared, counts)] if alike else order
    if len(rest) <= 2 * LEAST_LAGS:  # too few rows for lags: one group, independent of their values
        alike, rest = [*alike, rest], rest[:0]
    residuals = [(rows, _of_equal(y[rows], dependence[rows])) for rows in alike]
    if len(rest):
        residuals.append((rest, _of_neighbours(y.take(rest, axis=0), dependence[rest])))
    residuals = [(rows, left) for rows, left in residuals if np.isfinite(left.variance)]
    kept = sum(len(rows) for rows, _ in residuals)
    squares = np.zeros(len(y))
    if not residuals:  # no value has rows from two replicates
        return Residual(np.nan, squares, 0.0, 0.0)
    for rows, left in residuals:
        squares[rows] = left.squares
    parts = np.array([(left.variance, left.noise, left.excess) for _, left in residuals])
    shares = np.array([len(rows) / kept for rows, _ in residuals])
    total, noise, excess = (shares @ parts).tolist()
    return Residual(total, squares, noise, excess)


def _of_equal(y: Floats, dependence: Dependence) -> Residual:
    """Return the residual variance of rows with the same value of the input."""
    n = len(y)
    if n < 2:
        return Residual(np.nan, np.zeros(n), 0.0, 0.0)
    squares = _summed((y - y.mean(axis=0)) ** 2) * (n / (n - 1))
    level = float(squares.mean())
    return Residual(variance(y, dependence), squares, 2 * level**2 / (n - 1), 4 * level**2 / n)


def _of_neighbours(y: Floats, dependence: Dependence) -> Residual:
    """Return the residual variance of rows sorted by the input."""
    number, lags, left, bend = _extrapolated(y, dependence)
    squares, local, smoothed = _squared_residuals(y, number, left)
    noise = len(y) * bend
    for lag, weight in zip(lags, _weights(lags), strict=True):
        products = float(squares[lag:] @ squares[:-lag]) / (len(y) - lag)
        noise += weight**2 * products / _used(dependence, lag)
    excess = 4 * float(np.mean(squares * local / (smoothed + 1)))
    return Residual(left, squares * _times_used(lags, len(y)), noise, excess)


def _extrapolated(y: Floats, dependence: Dependence) -> tuple[int, tuple[int, ...], float, float]:
    """Return the residual variance extrapolated to lag zero.

    Returns
    -------
    number : int
        Number of lags.
    lags : tuple of int
        Lags used.
    left : float
        Residual variance.
    bend : float
        Squared change of the estimate by fewer lags, beyond the noise.
    """
    half_square = cache(partial(_half_square, y, dependence))
    number = _number_of_lags(y, dependence, half_square)
    lags = _lags(number, len(y), dependence)
    if len(lags) < _FEWEST_LAGS:
        return number, lags, np.nan, 0.0
    halves = np.array([half_square(lag) for lag in lags])
    lags, bend = _unbent(y, dependence, lags, halves)
    left = float(np.array(_weights(lags)) @ halves[: len(lags)])
    return min(number, len(lags)), lags, left, bend


def _times_used(lags: tuple[int, ...], rows: int) -> Floats:
    """Return the weight of each row, relative to a row with two partners at each lag.

    Rows near the ends of the order count a quarter less, and their partners a quarter more.
    """
    lag, quarter = np.array(lags, int), np.array(_weights(lags)) / 4
    changes = np.zeros(rows)
    changes[0] = 1 - quarter.sum()
    changes[lag] += 2 * quarter
    changes[2 * lag] -= quarter
    changes[rows - 2 * lag] += quarter
    changes[rows - lag] -= 2 * quarter
    return np.cumsum(changes)


def _lags(number: int, rows: int, dependence: Dependence) -> tuple[int, ...]:
    """Return the first lags at which enough pairs are from different replicates."""
    if dependence.is_none:
        return tuple(range(1, number + 1))
    lags = range(1, min(3 * number, rows // 3) + 1)
    usable = (lag for lag in lags if _used(dependence, lag) >= _LEAST_PAIRED)
    return tuple(islice(usable, number))


@lru_cache(256)
def _weights(lags: tuple[int, ...]) -> tuple[float, ...]:
    """Return the weight of each lag in the intercept of a parabola fitted by least squares."""
    lag = np.array(lags, float)
    fitted = np.linalg.pinv(np.column_stack([np.ones(len(lags)), lag, lag**2]))
    return tuple(fitted[0].tolist())


def _intercept(half_square: Callable[[int], float], lags: tuple[int, ...]) -> float:
    if len(lags) < _FEWEST_LAGS:
        return np.nan
    weights = zip(lags, _weights(lags), strict=True)
    return float(sum(weight * half_square(lag) for lag, weight in weights))


def _used(dependence: Dependence, lag: int) -> float:
    """Return the share of pairs of rows at this lag that are from different replicates."""
    labels = dependence.labels
    return 1.0 if labels is None else float(np.mean(labels[lag:] != labels[:-lag]))


def _unbent(
    y: Floats, dependence: Dependence, lags: tuple[int, ...], halves: Floats
) -> tuple[tuple[int, ...], float]:
    """Return the lags, halved until they follow a parabola (Lepskii's method), and the change.

    Halving is repeated [1]_ for two cases. Beyond a jump near an end of the order there may be
    fewer rows than lags, so that the number of pairs across it no longer increases with the lag. A
    wave may be shorter than the lags. The second value is the squared change of the estimate by the
    last halving, minus its noise variance.

    References
    ----------
    .. [1] O. V. Lepskii, "On a problem of adaptive estimation in Gaussian white noise", Theory
       Probab. Appl. 35, 454-466 (1991).
    """
    used = np.array([_used(dependence, lag) for lag in lags])
    steps = _summed((y[1:] - y[:-1]) ** 2) / 2
    product = float(np.mean(steps[2:] * steps[:-2]))  # product of neighbouring variances
    bend = 0.0
    while (half := len(lags) // 2) >= _FEWEST_LAGS:
        change = np.array(_weights(lags))
        change[:half] -= _weights(lags[:half])
        noise = float(np.sum(change**2 / used[: len(lags)]) * product / len(y))
        square = float(change @ halves[: len(lags)]) ** 2
        bend = max(square - noise, 0.0)
        if square <= _BENT**2 * noise:
            break
        lags = lags[:half]
    return lags, bend


def _half_square(y: Floats, dependence: Dependence, lag: int) -> float:
    """Return half the mean squared difference of rows at this lag (empirical semivariogram)."""
    steps, labels = y[lag:] - y[:-lag], dependence.labels
    if labels is None:  # the rows at both ends count twice, in place of missing pairs
        first, last = steps[:lag].ravel(), steps[-lag:].ravel()
        ends = (first @ first + last @ last) / 2
        return float((steps.ravel() @ steps.ravel() + ends) / (2 * len(y)))
    counts = np.ones(len(steps))
    counts[:lag] += 0.5
    counts[-lag:] += 0.5
    counts *= labels[lag:] != labels[:-lag]
    return float(counts @ _summed(steps**2) / (2 * counts.sum()))


def _summed(squares: Floats) -> Floats:
    """Return the sum over the elements of each row, without a pass over a single one."""
    return squares[:, 0] if squares.shape[1] == 1 else np.asarray(np.sum(squares, axis=1))


def _number_of_lags(y: Floats, dependence: Dependence, half_square: Callable[[int], float]) -> int:
    n = len(y)
    most = int(max(min(n // 8, 1.2 * n**0.55, _MOST_LAGS), LEAST_LAGS))
    every = variance(y, dependence)
    if not every > 0:
        return LEAST_LAGS
    pilot = min(12, most)
    left = max(_intercept(half_square, _lags(pilot, n, dependence)) / every, 1e-6)
    if np.isnan(left):
        return LEAST_LAGS
    explained = max(1 - left, 3 * max(left, 1e-3) / np.sqrt(n * pilot))
    return int(np.clip(0.4 * n**0.6 * (left / explained) ** 0.4, LEAST_LAGS, most))


def _squared_residuals(y: Floats, lags: int, left: float) -> tuple[Floats, Floats, Floats]:
    """Return squared residuals from the mean of neighbours, their local mean, and the counts.

    At a jump the mean of both sides is biased. There only the side that fits is used, and the
    variance of the differences across the jump is the geometric mean of both sides.
    """
    n, reach = len(y), int(np.clip(lags // 4, 2, _MOST_NEIGHBOURS))
    row = np.arange(n)
    low, high = np.maximum(row - reach, 0), np.minimum(row + reach + 1, n)

    def mean_square(sums: Floats, count: NDArray[np.intp]) -> Floats:
        means = sums / np.maximum(count, 1)[:, None]
        return np.asarray(_summed((y - means) ** 2) * count / (count + 1))

    until = np.vstack([np.zeros(y.shape[1]), np.cumsum(y.T, axis=1).T])
    before, after = until[:-1] - until.take(low, axis=0), until.take(high, axis=0) - until[1:]
    both = mean_square(before + after, high - low - 1)
    sides = np.array([mean_square(before, row - low), mean_square(after, high - row - 1)])
    least = np.maximum(sides.min(axis=0), max(left, 0.0))
    inner: Mask = (row > low) & (high > row + 1)
    jumps = inner & (sides.max(axis=0) > _JUMP * least)
    squares = np.where(jumps, np.minimum(both, 2 * np.sqrt(both * least)), both)
    total = np.append(0.0, np.cumsum(squares))
    count = high - low - 1
    return squares, (total.take(high) - total.take(low) - squares) / count, count
