"""Given-data sensitivity measures: random balance, correlation ratio, delta, PAWN, KS distance."""

from collections.abc import Callable, Sequence

import numpy as np
import scipy  # which imports scipy.stats when it is first used
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.indices.index import RefusedError
from uq.stats.quantile_functions import normal
from uq.text.numbers import counted

LEAST_ROWS = 10
"""Fewest rows of a value of an input that forms its own slice."""

MOST_CATEGORIES = 10
"""Largest number of values of an input that is sliced by value."""

MANY_EQUAL = 0.05
"""Share of the rows with one value above which an input has many equal values."""

MIN_SIDE = 10
"""Fewest rows with the event, and without it, for a comparison of distributions."""

_HARMONICS = 10
_VALUE_SLICES = 20
_GRID = 100
_PAWN_SLICES = 10
_TIED_OUTPUT = 0.01  # share of the rows with one value


def has_many_equal(column: Floats) -> bool:
    """Return whether one value of an input occurs in a large share of the rows."""
    return is_repeated(np.sort(column))


def is_repeated(ascending: Floats) -> bool:
    """Return whether one value occurs in a large share of these ascending values."""
    most = int(max(MANY_EQUAL * len(ascending), 1))
    return bool((ascending[most:] == ascending[:-most]).any())  # a value more than `most` times


def slice_of(column: Floats, cuts: NDArray[np.intp], least: int = LEAST_ROWS) -> NDArray[np.intp]:
    """Return the slice of each row along an input; rows of the same value share a slice.

    Parameters
    ----------
    column : ndarray, shape (n,)
    cuts : ndarray of int, shape (k - 1,)
        Positions among the sorted rows at which k slices begin if all values differ.
    least : int, optional
        Fewest rows of a slice by value.

    Returns
    -------
    ndarray of int, shape (n,)
        Number of each row's slice. If there are few values, each value has a slice, independent of
        its label, and rare values share a slice. If there are many values, the cuts move to the
        ends of ties.
    """
    return slices_along(column, [(cuts, least)])[0]


def slices_along(
    column: Floats, cases: Sequence[tuple[NDArray[np.intp], int]]
) -> list[NDArray[np.intp]]:
    """Return what `slice_of` does in several cases of `cuts` and `least`.

    The rows are sorted once. Cases with equal slices share an array.
    """
    column = np.ascontiguousarray(column)
    ascending = np.sort(column)
    starts = np.flatnonzero(np.append(True, ascending[1:] != ascending[:-1]))
    values, ends = ascending[starts], np.append(starts[1:], len(column))
    numbers: dict[tuple[int, ...], NDArray[np.intp]] = {}
    slices = []
    for cuts, least in cases:
        is_category = len(values) <= max(MOST_CATEGORIES, len(cuts) + 1)
        places = _categories(ends - starts, least) if is_category else _cuts_at_ends(ends, cuts)
        key = is_category, *places.tolist()
        if key not in numbers:
            if is_category:
                numbers[key] = places[np.searchsorted(values, column)]
            else:
                firsts = values[np.searchsorted(starts, places)]
                numbers[key] = np.searchsorted(firsts, column, side="right")
        slices.append(numbers[key])
    return slices


def _cuts_at_ends(ends: NDArray[np.intp], cuts: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return the cuts moved to the nearest ends of ties."""
    above = np.minimum(np.searchsorted(ends, cuts), len(ends) - 2)
    below = np.maximum(above - 1, 0)
    nearest = np.where(cuts - ends[below] < ends[above] - cuts, ends[below], ends[above])
    return np.unique(nearest)


def _categories(counts: NDArray[np.intp], least: int) -> NDArray[np.intp]:
    """Return the slice of each value: one slice per value, and one for all rare values."""
    order = np.argsort(counts, kind="stable")
    rare = int((counts < least).sum())
    if rare:  # enough of them, with the next more frequent ones, to make a slice
        rare = max(rare, int(np.searchsorted(np.cumsum(counts[order]), least)) + 1)
    number = np.empty(len(counts), np.intp)
    number[order] = np.maximum(np.arange(len(counts)) - max(rare - 1, 0), 0)
    return number


def by_slices(
    x: Floats,
    cuts: NDArray[np.intp],
    measure: Callable[[NDArray[np.intp]], float],
    least: int = LEAST_ROWS,
) -> Floats:
    """Return ``measure(number of each row's slice)`` of each input, shape (d,).

    NaN if an input varies only within one slice; see `slice_of`.
    """

    def index(column: Floats) -> float:
        number = slice_of(column, cuts, least)
        return np.nan if is_undivided(column, number) else measure(number)

    return np.array([index(column) for column in x.T])


def is_undivided(column: Floats, number: NDArray[np.intp]) -> bool:
    """Return whether an input varies, but only within one slice."""
    return not number.any() and bool(np.ptp(column))


def even_cuts(rows: int, slices: int) -> NDArray[np.intp]:
    """Return the start positions of slices with equal numbers of rows, except the first."""
    return np.linspace(0, rows, slices + 1)[1:-1].astype(np.intp)


def first_order(x: Floats, y: Floats) -> Floats:
    """Return unbiased first-order indices: the share of the variance that each input explains.

    Parameters
    ----------
    x : ndarray, shape (n, d)
    y : ndarray, shape (n,) or (n, e)
        The variances of several elements are summed.

    Returns
    -------
    ndarray, shape (d,)
        Random balance estimates. For an input with many equal values, whose rows have no order,
        the correlation ratio from the means at each value. NaN if such an input varies only within
        one slice.
    """
    total = y.var(axis=0).sum()

    def share(column: Floats) -> float:
        order = np.argsort(column)
        if is_repeated(column[order]):
            return _correlation_ratio(column, y, total)
        return _random_balance(order, y, total)

    return np.array([share(column) for column in x.T])


def _random_balance(order: NDArray[np.intp], y: Floats, total: float) -> float:
    """Return the bias-corrected first-order index by random balance.

    It is the share of the first harmonics in the spectrum of y along the input and back. `order` is
    the order of the rows along the input.

    References
    ----------
    E. Plischke, "An effective algorithm for computing global sensitivity indices (EASI)", Reliab.
    Eng. Syst. Saf. 95, 354-360 (2010). Bias correction for noise in these harmonics: J.-Y.
    Tissot, C. Prieur, "Bias correction for the estimation of sensitivity indices based on random
    balance designs", Reliab. Eng. Syst. Saf. 107, 205-213 (2012).
    """
    n = len(y)
    spectrum = np.fft.rfft(y[np.r_[order[::2], order[1::2][::-1]]], axis=0)
    share = np.sum(np.abs(spectrum[1 : _HARMONICS + 1]) ** 2) * 2 / (n**2 * total)
    noise = 2 * _HARMONICS / n
    return float(share - noise / (1 - noise) * (1 - share))


def _correlation_ratio(column: Floats, y: Floats, total: float) -> float:
    """Return the bias-corrected correlation ratio: 1 - variance within slices / total variance.

    References
    ----------
    T. L. Kelley, "An unbiased correlation ratio measure", Proc. Natl. Acad. Sci. 21, 554-559
    (1935).
    """
    n, elements = len(y), np.atleast_2d(y.T)

    def ratio(number: NDArray[np.intp]) -> float:
        counts = np.bincount(number)
        means = [np.bincount(number, element) / counts for element in elements]
        pairs = zip(elements, means, strict=True)
        within = sum(float(((element - mean[number]) ** 2).sum()) for element, mean in pairs)
        return 1 - within / (n - len(counts)) / (n * total / (n - 1))

    return float(by_slices(column[:, None], even_cuts(n, _VALUE_SLICES), ratio)[0])


def delta(x: Floats, y: Floats) -> Floats:
    """Estimate Borgonovo's delta: half the mean area between conditional and marginal density.

    Parameters
    ----------
    x : ndarray, shape (n, d)
    y : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (d,)
        Estimate of eq. 26 in [1]_, from normal scores of `y`. Delta is invariant under increasing
        functions of `y`, but its estimate fails for long tails, which a single grid cannot resolve;
        normal scores have no long tails. NaN if an input varies only within one slice.

    Raises
    ------
    RefusedError
        Many rows share one value, which has no density.

    References
    ----------
    .. [1] E. Plischke, E. Borgonovo, C. L. Smith, "Global sensitivity measures from given data",
       Eur. J. Oper. Res. 226, 536-550 (2013).
    """
    n = len(y)
    _, counts = np.unique(y, return_counts=True)
    if counts.max() > max(_TIED_OUTPUT * n, 1):
        raise RefusedError(
            f"{counts.max()} rows share one value, and delta compares densities; use pawn"
        )
    scores = normal((scipy.stats.rankdata(y) - 0.5) / n)
    grid = np.linspace(scores.min(), scores.max(), _GRID)
    anywhere = _density(scores, grid)
    # The same number of slices as in SALib: section 5 of the paper.
    slices = min(int(np.ceil(n ** (2 / (7 + np.tanh((1500 - n) / 500))))), 48)

    def area(number: NDArray[np.intp]) -> float:
        parts = [scores[number == k] for k in range(number.max() + 1)]
        areas = [np.trapezoid(np.abs(_density(part, grid) - anywhere), grid) for part in parts]
        return float(np.dot([len(part) for part in parts], areas) / (2 * n))

    return by_slices(x, even_cuts(n, slices), area)


def _density(values: Floats, grid: Floats) -> Floats:
    """Return a Gaussian kernel density with Silverman's width, three times as fast as scipy's."""
    width = values.std(ddof=1) * (0.75 * len(values)) ** -0.2
    kernels = np.exp(-0.5 * ((grid[:, None] - values) / width) ** 2)
    return np.asarray(kernels.mean(axis=1) / (width * np.sqrt(2 * np.pi)))


def pawn(x: Floats, y: Floats) -> Floats:
    """Estimate the PAWN index: the median KS distance of conditional and marginal distribution.

    Parameters
    ----------
    x : ndarray, shape (n, d)
    y : ndarray, shape (n,)

    Returns
    -------
    ndarray, shape (d,)
        Median Kolmogorov-Smirnov distance over ten slices between quantiles of the input [1]_, or
        over one slice per value if there are few values. NaN if an input varies only within one
        slice.

    References
    ----------
    .. [1] F. Pianosi, T. Wagener, "Distribution-based sensitivity analysis from a generic
       input-output sample", Environ. Model. Softw. 108, 197-207 (2018).
    """
    order = np.argsort(y, kind="stable")
    last = np.append(np.diff(y[order]) > 0, True)  # F is defined at the last of equal y
    anywhere = np.flatnonzero(last)[:, None] / len(y) + 1 / len(y)
    # Slices: rows from one quantile up to the next.
    cuts = -(-np.arange(1, _PAWN_SLICES) * (len(y) - 1) // _PAWN_SLICES)

    def distance(number: NDArray[np.intp]) -> float:
        count = np.cumsum(number[order, None] == np.arange(number.max() + 1), axis=0)
        return float(np.median(np.abs(count[last] / count[-1] - anywhere).max(axis=0)))

    return by_slices(x, cuts, distance)


def ks_distances(x: Floats, event: Floats) -> Floats:
    """Return the Kolmogorov-Smirnov distance of each input between rows with and without an event.

    Parameters
    ----------
    x : ndarray, shape (n, d)
    event : ndarray, shape (n,)
        0 or 1.

    Returns
    -------
    ndarray, shape (d,)
        Kolmogorov-Smirnov distance (regional sensitivity analysis) [1]_. For an input with few
        values it is the maximum over all orders of the values: the total variation distance, which
        does not depend on their labels. Inputs without effect also have a positive distance.

    Raises
    ------
    RefusedError
        The output is not an event, or too few rows are on one side.

    References
    ----------
    .. [1] R. C. Spear, G. M. Hornberger, "Eutrophication in Peel Inlet II", Water Res. 14, 43-49
       (1980).
    """
    happens = as_event(event)
    return np.array([_distance(column, happens) for column in x.T])


def as_event(values: Floats) -> Mask:
    """Return the mask of an event from 0 and 1; reject other numbers, and few rows on one side."""
    happens = values == 1
    if not (happens | (values == 0)).all():
        raise RefusedError(
            "not an event: the rows in which something happens are compared with the rest; ask for"
            " a category, or for P(T < t) by a threshold in [analysis]"
        )
    least = int(min(happens.sum(), (~happens).sum()))
    if least < MIN_SIDE:
        seen = counted(least, "row")
        raise RefusedError(f"only {seen} on one side of the event; {MIN_SIDE} are needed")
    return np.asarray(happens)


def _distance(column: Floats, happens: Mask) -> float:
    values, place = np.unique(column, return_inverse=True)
    if len(values) > MOST_CATEGORIES:
        test = scipy.stats.ks_2samp(column[happens], column[~happens], method="asymp")
        return float(test.statistic)
    inside, outside = (
        np.bincount(place[side], minlength=len(values)) / side.sum() for side in (happens, ~happens)
    )
    return float(np.abs(inside - outside).sum() / 2)
