"""Error of a mean from discontinuities in stratified designs, which replicates do not show.

Every replicate of such a design has one row in each of n strata of an input. If a function jumps
within a stratum, this row lies on one side of the jump. If it lies on the same side in all
replicates, the jump adds nothing to the scatter between replicates, although its error may be
large.
"""

from itertools import combinations
from math import log
from typing import NamedTuple

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import NDArray

from uq.contract import Floats

DEGREE = 6
"""Degree of the polynomials, in the rank of each input, that describe the smooth part."""

ROWS_PER_TERM = 12
"""Rows required per polynomial term."""

MOST_TERMS = 100

MOST_ROWS = 16384
"""Largest number of rows, over all replicates, that are searched for jumps."""

MOST_JUMPS = 16

SURE = 5.0
"""Standard errors above which a step is a jump rather than noise from other inputs."""

NOISE = 2.0
"""Standard errors below which a jump cannot be distinguished from noise."""

WIDEST = 16
"""Divisor of the number of rows: the quotient limits the number of neighbours on each side."""

MOST_STRATA = 4
"""Largest width of a slab in strata: a wider one shows as two steps."""


class Neighbours:
    """Order of the rows along each input, and polynomials that describe the smooth part.

    Attributes
    ----------
    replicates : int
    rows : ndarray of int, shape (m,)
        The first rows of each replicate, at most `MOST_ROWS` together.
    order : ndarray of int, shape (d, m)
        Order of these rows along each input.
    norms : ndarray, shape (m,)
        Norm of the residual of a unit step at each place, after the polynomials of its input are
        removed; infinite if the residual is negligible.

    Parameters
    ----------
    replicate : ndarray of int, shape (n,)
    inputs : ndarray, shape (n, d)
    """

    def __init__(self, replicate: NDArray[np.integer], inputs: Floats):
        _, first, counts = np.unique(np.sort(replicate), return_index=True, return_counts=True)
        place = np.empty(len(replicate), dtype=np.intp)
        place[np.argsort(replicate, kind="stable")] = np.arange(len(replicate)) - np.repeat(
            first, counts
        )
        self.replicates = len(counts)
        self.rows = np.flatnonzero(place < max(MOST_ROWS // self.replicates, 1))
        x = inputs[self.rows]
        x = x[:, np.ptp(x, axis=0) > 0]
        n = len(x)
        self.order = np.argsort(x, axis=0, kind="stable").T
        scores = 2 * (np.argsort(self.order, axis=1) + 0.5).T / max(n, 1) - 1
        terms = np.column_stack([_polynomials(scores), (x - x.mean(axis=0)) / x.std(axis=0)])
        basis, triangle = np.linalg.qr(terms)
        # An input that repeats others leaves only rounding errors.
        self._basis: Floats = basis[:, np.abs(np.diag(triangle)) > 1e-9 * np.sqrt(n)]
        # Residual of each step from the polynomials of its input; the same for all inputs.
        along, _ = np.linalg.qr(_polynomials((2 * np.arange(n)[:, None] + 1) / max(n, 1) - 1))
        behind = np.cumsum(along[::-1], axis=0)[::-1]
        left = np.arange(n, 0, -1) - np.square(behind).sum(axis=1)
        least = 1e-3 * self.replicates
        self.norms: Floats = np.sqrt(np.where(left > least, left, np.inf))

    def without_smooth(self, values: Floats) -> Floats:
        """Return the residuals of the values of rows from the fitted polynomials."""
        return values - self._basis @ (self._basis.T @ values)


def _polynomials(scores: Floats) -> Floats:
    """Return Legendre polynomials of each score, and products of two if there are enough rows."""
    n, d = scores.shape
    most = min(n // ROWS_PER_TERM, MOST_TERMS)
    terms = [np.ones(n)]
    powers = legendre.legvander(scores, DEGREE)
    for degree in range(1, DEGREE + 1):
        if len(terms) + d <= most:
            terms.extend(powers[:, :, degree].T)
    for degree in range(2, DEGREE + 1):
        if len(terms) + (degree - 1) * d * (d - 1) // 2 <= most:
            terms.extend(
                powers[:, i, k] * powers[:, j, degree - k]
                for i, j in combinations(range(d), 2)
                for k in range(1, degree)
            )
    return np.column_stack(terms)


def widened_for_jumps(
    value: float,
    ends: tuple[float, float],
    values: Floats,
    neighbours: Neighbours | None,
    confidence: float,
) -> tuple[float, float]:
    """Return the interval of a mean, widened for the error of jumps.

    Parameters
    ----------
    value : float
        The mean, or an estimate with the same error.
    ends : tuple of float
        Interval from the scatter of replicates.
    values : ndarray, shape (n,)
        Values of the rows, or their influence on the estimate.
    neighbours : Neighbours or None
        Neighbours of these rows; None if no jump can be hidden.
    confidence : float

    Returns
    -------
    low, high : float
        The interval is unchanged without neighbours. Otherwise each half-width is the root of a
        sum of squares: of the half-width from the scatter, and of J times
        -log((1 - confidence) / 2) / n for each jump J. The latter factor is the share of rows
        beyond a jump that n rows miss with the probability of one tail.
    """
    if neighbours is None:
        return ends
    share = -log((1 - confidence) / 2) / len(values)
    error = share * float(np.sqrt(np.square(jumps(values, neighbours)).sum()))
    return (
        float(value - np.hypot(value - ends[0], error)),
        float(value + np.hypot(ends[1] - value, error)),
    )


def jumps(values: Floats, neighbours: Neighbours) -> Floats:
    """Return the detected jumps of a function of the inputs, then the largest undetectable jump.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Values of the function at the rows.
    neighbours : Neighbours
        Neighbours of the same rows.

    Returns
    -------
    ndarray
        Steps and slabs along inputs in the residual after polynomials of the inputs and previous
        ones. The one that explains most comes first (orthogonal matching pursuit [1]_). A step is
        at most the difference between the means of its neighbours on both sides, in the residual or
        in the values, whichever is larger. The difference is the least over the number of
        neighbours. A slab, a few strata wide, has a jump on each side, which together count as one
        that is larger by the root of two. The last entry is the largest jump that noise may hide.

    References
    ----------
    .. [1] Y. C. Pati, R. Rezaiifar, P. S. Krishnaprasad, "Orthogonal matching pursuit: recursive
       function approximation with applications to wavelet decomposition", 27th Asilomar Conf. on
       Signals, Systems and Computers, 40-44 (1993).
    """
    values = values[neighbours.rows]
    residual = neighbours.without_smooth(values)
    n = len(residual)
    sizes: list[float] = []
    parts: list[Floats] = []
    rounding = 1e-12 * float(np.abs(values).max(initial=0.0))
    while len(neighbours.order) and (noise := float(residual.std())) > rounding:
        step, slab = _largest_step(residual, neighbours), _largest_slab(residual, neighbours)
        first = max(step, slab, key=lambda part: part.explained)
        if first.explained < SURE * noise or len(sizes) == MOST_JUMPS:
            sizes.append(NOISE * noise / float(neighbours.norms[step.start]))
            break
        ordered = neighbours.order[first.which]
        if first is slab:
            sizes.append(2**0.5 * _height(residual[ordered], slab))
        else:
            # Near an end polynomials follow a step, so that little of it remains in the residual.
            heights = (
                _step(response[ordered], step.start, neighbours, noise)
                for response in (residual, values)
            )
            size = step.explained / float(neighbours.norms[step.start])
            sizes.append(min(size, max(heights)))
        inside = np.zeros(n)
        inside[ordered[first.start : first.stop]] = 1.0
        part = neighbours.without_smooth(inside)
        for other in parts:
            part -= other * (other @ part)
        if part @ part < 1e-9 * n:
            break
        parts.append(part / np.sqrt(part @ part))
        residual = residual - parts[-1] * (parts[-1] @ residual)
    return np.array(sizes)


class _Part(NamedTuple):
    """Rows along an input, from `start` to `stop`, and how much of the residual they explain."""

    explained: float
    which: int
    start: int
    stop: int


def _largest_step(residual: Floats, neighbours: Neighbours) -> _Part:
    """Return the step that explains most: from a place to the end of an input."""
    sums = np.cumsum(residual[neighbours.order][:, ::-1], axis=1)[:, ::-1]
    explained = np.abs(sums) / neighbours.norms
    which, place = divmod(int(explained.argmax()), len(residual))
    return _Part(float(explained[which, place]), which, place, len(residual))


def _largest_slab(residual: Floats, neighbours: Neighbours) -> _Part:
    """Return the slab that explains most: a few strata that stand out from both sides."""
    n, best = len(residual), _Part(0.0, 0, 0, 0)
    sums = np.cumsum(residual[neighbours.order], axis=1)
    sums = np.hstack([np.zeros((len(sums), 1)), sums])
    width = max(neighbours.replicates, 2)
    while width <= min(n // WIDEST, MOST_STRATA * neighbours.replicates):
        inside = sums[:, width:] - sums[:, :-width]
        before, at, after = inside[:, : -2 * width], inside[:, width:-width], inside[:, 2 * width :]
        outside = np.where(at > 0, np.maximum(before, after), np.minimum(before, after))
        stands_out = np.where((at > 0) == (at > outside), np.abs(at - outside), 0.0)
        which, place = divmod(int(stands_out.argmax()), stands_out.shape[1])
        explained = float(stands_out[which, place]) / (2 * width) ** 0.5  # of a difference
        if explained > best.explained:
            best = _Part(explained, which, place + width, place + 2 * width)
        width *= 2
    return best


def _height(ordered: Floats, slab: _Part) -> float:
    """Return the difference between the mean in a slab and the nearer mean beside it."""
    width = slab.stop - slab.start
    inside = ordered[slab.start : slab.stop].mean()
    beside = (ordered[slab.start - width : slab.start], ordered[slab.stop : slab.stop + width])
    return float(min(abs(inside - side.mean()) for side in beside))


def _step(ordered: Floats, place: int, neighbours: Neighbours, noise: float) -> float:
    """Return the step between the neighbours of a place, least over the number of neighbours."""
    least, width = np.inf, max(neighbours.replicates, 2)
    while width <= max(len(ordered) // WIDEST, 2) and width <= min(place, len(ordered) - place):
        step = ordered[place : place + width].mean() - ordered[place - width : place].mean()
        least = min(least, max(abs(float(step)), NOISE * noise * (2 / width) ** 0.5))
        width *= 2
    return least
