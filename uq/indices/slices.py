"""How much the law of an output changes from one slice of an input to the next: delta and PAWN."""

import numpy as np
from scipy.stats import norm, rankdata

from uq.indices.targets import RefusedError
from uq.rows.elements import Floats

_GRID = 100
_PAWN_SLICES = 10
_TIED = 0.01


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
        tail, and normal scores have none.

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
    ends = np.linspace(0, n, slices + 1)[1:-1].astype(np.intp)
    found = []
    for order in np.argsort(x, axis=0, kind="stable").T:
        parts = np.split(scores[order], ends)
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
        The distance is that of Kolmogorov, the slices are ten between quantiles of the input [1]_.

    References
    ----------
    .. [1] F. Pianosi, T. Wagener, "Distribution-based sensitivity analysis from a generic
       input-output sample", Environ. Model. Softw. 108, 197-207 (2018).
    """
    order = np.argsort(y, kind="stable")
    last = np.append(np.diff(y[order]) > 0, True)  # where y grows: there alone its law has a value
    anywhere = np.flatnonzero(last)[:, None] / len(y) + 1 / len(y)
    edges = np.quantile(x, np.arange(_PAWN_SLICES + 1) / _PAWN_SLICES, axis=0)
    found = []
    for column, cuts in zip(x.T, edges.T, strict=True):
        # The row with the largest value lies in no slice.
        slice_of = np.searchsorted(cuts, column[order], side="right") - 1
        count = np.cumsum(slice_of[:, None] == np.arange(_PAWN_SLICES), axis=0)
        count = count[:, count[-1] > 0]
        distances = np.abs(count[last] / count[-1] - anywhere).max(axis=0)
        found.append(np.median(distances) if len(distances) else np.nan)
    return np.array(found)
