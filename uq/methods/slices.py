"""How much the law of an output changes from one slice of an input to the next: delta and PAWN."""

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm, rankdata

from uq.methods.indices import RefusedError
from uq.methods.sample import Floats

LEAST_ROWS = 10
"""A value of an input that fewer rows have makes no slice of its own."""

MOST_CATEGORIES = 10
"""An input with no more values than this is sliced by value."""

_GRID = 100
_PAWN_SLICES = 10
_TIED = 0.01


def slice_of(column: Floats, cuts: NDArray[np.intp], least: int = LEAST_ROWS) -> NDArray[np.intp]:
    """Divide the rows into slices of an input; rows of the same value are never parted.

    Parameters
    ----------
    column : ndarray, shape (n,)
    cuts : ndarray of int, shape (k - 1,)
        Where k slices would begin among the sorted rows, if no values were the same.
    least : int, optional
        Rows of a slice by value.

    Returns
    -------
    ndarray of int, shape (n,)
        Number of each row's slice. Few values make a slice each, whatever they are called; the
        rare ones share one. Among many, the cuts move to where a value ends.
    """
    values, place, counts = np.unique(column, return_inverse=True, return_counts=True)
    if len(values) <= max(MOST_CATEGORIES, len(cuts) + 1):
        return np.asarray(_categories(counts, least)[place])
    ends = np.cumsum(counts)
    above = np.minimum(np.searchsorted(ends, cuts), len(ends) - 2)
    below = np.maximum(above - 1, 0)
    nearest = np.where(cuts - ends[below] < ends[above] - cuts, ends[below], ends[above])
    return np.asarray(np.searchsorted(np.unique(nearest), ends - counts, side="right")[place])


def _categories(counts: NDArray[np.intp], least: int) -> NDArray[np.intp]:
    """Return the number of each value's slice: one each, and one of all rare values."""
    order = np.argsort(counts, kind="stable")
    rare = int((counts < least).sum())
    if rare:  # enough of them, with the next more frequent ones, to make a slice
        rare = max(rare, int(np.searchsorted(np.cumsum(counts[order]), least)) + 1)
    number = np.empty(len(counts), np.intp)
    number[order] = np.maximum(np.arange(len(counts)) - max(rare - 1, 0), 0)
    return number


def tells_nothing(column: Floats, number: NDArray[np.intp]) -> bool:
    """Whether rows of an input that varies are all in one slice."""
    return not number.any() and bool(np.ptp(column))


def even_cuts(rows: int, slices: int) -> NDArray[np.intp]:
    """Return where slices of equally many rows begin, but the first."""
    return np.linspace(0, rows, slices + 1)[1:-1].astype(np.intp)


def delta(x: Floats, y: Floats) -> Floats:
    """Estimate Borgonovo's delta: the mean area between the density in a slice and anywhere.

    Parameters
    ----------
    x : ndarray, shape (n, d)
    y : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (d,)
        The estimate of eq. 26 in [1]_, of normal scores of `y`: delta is the same for any
        increasing function of `y`, but its estimate is useless where one grid must serve a long
        tail, and normal scores have none. NaN where an input varies within one slice only.

    Raises
    ------
    RefusedError
        When many rows share one value, which has no density.

    References
    ----------
    .. [1] E. Plischke, E. Borgonovo, C. L. Smith, "Global sensitivity measures from given data",
       Eur. J. Oper. Res. 226, 536-550 (2013).
    """
    n = len(y)
    _, counts = np.unique(y, return_counts=True)
    if counts.max() > max(_TIED * n, 1):
        raise RefusedError(
            f"{counts.max()} rows share one value, and delta compares densities; use rbd-fast or"
            " pawn"
        )
    scores = norm.ppf((rankdata(y) - 0.5) / n)
    grid = np.linspace(scores.min(), scores.max(), _GRID)
    anywhere = _density(scores, grid)
    # As many as SALib's: section 5 of the paper.
    slices = min(int(np.ceil(n ** (2 / (7 + np.tanh((1500 - n) / 500))))), 48)
    found = []
    for column in x.T:
        number = slice_of(column, even_cuts(n, slices))
        if tells_nothing(column, number):
            found.append(np.nan)
            continue
        parts = [scores[number == k] for k in range(number.max() + 1)]
        areas = [np.trapezoid(np.abs(_density(one, grid) - anywhere), grid) for one in parts]
        found.append(np.dot([len(one) for one in parts], areas) / (2 * n))
    return np.array(found)


def _density(values: Floats, grid: Floats) -> Floats:
    """Return scipy's ``gaussian_kde`` of Silverman's width, which takes three times as long."""
    width = values.std(ddof=1) * (0.75 * len(values)) ** -0.2
    kernels = np.exp(-0.5 * ((grid[:, None] - values) / width) ** 2)
    return np.asarray(kernels.mean(axis=1) / (width * np.sqrt(2 * np.pi)))


def pawn(x: Floats, y: Floats) -> Floats:
    """Estimate PAWN's index: the median distance between the law in a slice and anywhere.

    Parameters
    ----------
    x : ndarray, shape (n, d)
    y : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (d,)
        The distance is that of Kolmogorov, the slices are ten between quantiles of the input [1]_,
        or one for each of its values where they are few. NaN where an input varies within one
        slice only.

    References
    ----------
    .. [1] F. Pianosi, T. Wagener, "Distribution-based sensitivity analysis from a generic
       input-output sample", Environ. Model. Softw. 108, 197-207 (2018).
    """
    order = np.argsort(y, kind="stable")
    last = np.append(np.diff(y[order]) > 0, True)  # where y grows: there alone its law has a value
    anywhere = np.flatnonzero(last)[:, None] / len(y) + 1 / len(y)
    # The rows from one quantile up to the next.
    cuts = -(-np.arange(1, _PAWN_SLICES) * (len(y) - 1) // _PAWN_SLICES)
    found = []
    for column in x.T:
        number = slice_of(column, cuts)[order]
        if tells_nothing(column, number):
            found.append(np.nan)
            continue
        count = np.cumsum(number[:, None] == np.arange(number.max() + 1), axis=0)
        found.append(np.median(np.abs(count[last] / count[-1] - anywhere).max(axis=0)))
    return np.array(found)
