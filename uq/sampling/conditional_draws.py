"""Conditional draws of dependent inputs, exact under a Gaussian copula.

On the scale of normal scores, a known value of a continuous law is a point, a known value of a
discrete law an interval, and an unknown value lies anywhere. A row is drawn within these, one input
after the other.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Self

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.sampling.dependence import Matrix, correlated, normal_correlations
from uq.sampling.unit_cube import Points, hashed, inside, uniform

CellOf = Callable[[Floats], tuple[Floats, Floats]]
"""Probabilities that a discrete law maps to values -> P(less) and P(not more) of each value."""

_AT_ONCE = 4096  # proposals


def conditional_paths(u: Points, ranks: Matrix, cells: Sequence[CellOf | None]) -> Points:
    """Give paths through independent points the rank correlations of a Gaussian copula.

    Parameters
    ----------
    u : ndarray, shape (n, rows, k)
        In (0, 1). Along a path, each coordinate changes at most once, from that of the first row
        to that of the last; each path is mapped by itself.
    ranks : tuple of tuple of float
    cells : sequence of callable or None
        For each input; None if its law is continuous.

    Returns
    -------
    ndarray, shape (n, rows, k)
        Every row follows the copula. The inputs that have changed since the first row are drawn
        given the values of the others, and independently of their own values in the first row.

    Notes
    -----
    Inputs are drawn one after the other [1]_: those known, then those changed, the last to change
    first, so that neighbouring rows share their random numbers.

    References
    ----------
    .. [1] M. Rosenblatt, "Remarks on a multivariate transformation", Ann. Math. Stat. 23, 470-472
       (1952).
    """
    from scipy.special import ndtr, ndtri

    first = correlated(u[:, 0], ranks)
    low = ndtri(first)
    high = low.copy()
    for i, cell in enumerate(cells):
        if cell is not None:
            low[:, i], high[:, i] = map(ndtri, cell(np.ascontiguousarray(first[:, i])))
    changed = u[:, 1:] != u[:, :1]
    kind = np.where(changed, 2, (low < high)[:, None])  # a point, an interval, anywhere
    since = changed.sum(axis=1, keepdims=True)
    # Narrow intervals first: what is drawn in the others then is more often kept.
    order = np.lexsort((np.where(changed, since, (high - low)[:, None]), kind), axis=-1)

    def ordered(values: Floats) -> Floats:
        taken = np.take_along_axis(np.broadcast_to(values, order.shape), order, axis=-1)
        return taken.reshape(-1, order.shape[-1])

    orders, which = np.unique(order.reshape(-1, order.shape[-1]), axis=0, return_inverse=True)
    matrix = normal_correlations(ranks)[orders[:, :, None], orders[:, None, :]]
    rows = _Rows(
        np.asarray(np.linalg.cholesky(matrix)),
        which.ravel(),
        ordered(np.where(changed, -np.inf, low[:, None])),
        ordered(np.where(changed, np.inf, high[:, None])),
        ordered(u[:, -1:]),
    )
    scores = np.empty(order.shape)
    np.put_along_axis(scores, order, rows.scores().reshape(order.shape), axis=-1)
    first = first[:, None]
    return np.concatenate([first, np.where(changed, inside(ndtr(scores)), first)], axis=1)


@dataclass(frozen=True)
class _Rows:
    """Rows of normal scores, each with its inputs in the order in which they are drawn.

    Attributes
    ----------
    factors : ndarray, shape (m, k, k)
        Cholesky's, of the correlations in each order that occurs.
    order : ndarray of int, shape (n,)
        The factor of each row.
    low, high : ndarray, shape (n, k)
        Between which a score lies.
    u : ndarray, shape (n, k)
        In (0, 1), for the draw.
    """

    factors: Floats
    order: NDArray[np.intp]
    low: Floats
    high: Floats
    u: Floats

    def part(self, rows: NDArray[np.intp], u: Floats) -> Self:
        """Return a subset of these rows, for another draw."""
        return type(self)(self.factors, self.order[rows], self.low[rows], self.high[rows], u)

    @property
    def intervals(self) -> Mask:
        """Mask of the scores that are restricted to an interval, shape (n, k)."""
        return (self.low < self.high) & ~(np.isneginf(self.low) & np.isposinf(self.high))

    @property
    def later(self) -> Mask:
        """The same but for the first of each row."""
        return self.intervals & (np.cumsum(self.intervals, axis=1) > 1)

    def scores(self) -> Floats:
        """Draw the scores."""
        scores, _ = self.drawn()
        several = np.flatnonzero(self.intervals.sum(axis=1) > 1)
        if len(several):
            scores[several] = self.part(several, self.u[several]).accepted()
        return scores

    def drawn(self) -> tuple[Floats, Floats]:
        """Draw each score between its ends, given those before it.

        Returns
        -------
        scores : ndarray, shape (n, k)
        chance : ndarray, shape (n,)
            The product of the probabilities of the intervals after the first, each given the
            scores before it: the density of the scores, given all intervals, is that of the draw
            times this, but for a constant.
        """
        scores, errors = np.empty_like(self.u), list[Floats]()
        chance, later = np.ones(len(self.u)), self.later
        for i in range(self.u.shape[1]):
            mean = np.zeros(len(self.u))
            for j, error in enumerate(errors):
                mean = mean + self.factors[self.order, i, j] * error
            sd = self.factors[self.order, i, i]
            ends = (self.low[:, i] - mean) / sd, (self.high[:, i] - mean) / sd
            error, share = _between(*ends, self.u[:, i])
            chance = np.where(later[:, i], chance * share, chance)
            scores[:, i] = mean + sd * error
            errors.append(error)
        return scores, chance

    def accepted(self) -> Floats:
        """Draw rows with several intervals, by rejection."""
        k = self.u.shape[1]
        scores, seed, largest = np.empty_like(self.u), hashed(self.u), self.largest_chance()
        pending, tried = np.arange(len(scores)), 0
        while len(pending):
            times = max(1, _AT_ONCE // len(pending))
            rows = np.repeat(pending, times)
            number = np.tile(np.arange(tried, tried + times), len(pending))
            draws = [uniform(seed[rows], (k + 1) * number + i) for i in range(k + 1)]
            u = np.where(self.intervals[rows], np.stack(draws[:k], axis=1), self.u[rows])
            proposed, chance = self.part(rows, u).drawn()
            good = (draws[k] * largest[rows] < chance).reshape(-1, times)
            done = good.any(axis=1)
            best = good.argmax(axis=1)[done]
            scores[pending[done]] = proposed.reshape(-1, times, k)[done, best]
            pending, tried = pending[~done], tried + times
        return scores

    def largest_chance(self) -> Floats:
        """Return an upper bound of the chance of a draw, shape (n,)."""
        bound, inverse = np.ones(len(self.u)), np.linalg.inv(self.factors)
        for i in range(1, self.u.shape[1]):
            rows = np.flatnonzero(self.later[:, i])
            low, high, order = self.low[rows], self.high[rows], self.order[rows]
            sd = self.factors[order, i, i]
            least, most = np.zeros(len(rows)), np.zeros(len(rows))
            for j in range(i):  # the mean is linear in the scores before
                slope = -sd * inverse[order, i, j]
                ends = np.stack([low[:, j], high[:, j]])
                ends = np.where(slope == 0, 0.0, ends) * slope
                least, most = least + ends.min(axis=0), most + ends.max(axis=0)
            # The probability of an interval is largest where the mean is nearest to its middle.
            mean = np.clip((low[:, i] + high[:, i]) / 2, least, most)
            near = np.where(np.isfinite(mean), mean, 0.0)
            _, share = _between((low[:, i] - near) / sd, (high[:, i] - near) / sd, 0.5)
            bound[rows] *= np.where(near == mean, share, 1.0)
        return bound


def _between(low: Floats, high: Floats, u: Floats | float) -> tuple[Floats, Floats]:
    """Return quantiles of the normal law between two ends, and the probability of lying there."""
    from scipy.special import ndtr, ndtri

    upper = low > -high  # where the lower tail of the mirrored law has more digits
    least, most = np.where(upper, -high, low), np.where(upper, -low, high)
    below = ndtr(least)
    share = ndtr(most) - below
    quantile = ndtri(below + np.where(upper, 1 - u, u) * share)
    quantile = np.where(np.isfinite(quantile), quantile, most)  # too far out to have a probability
    return np.where(upper, -quantile, quantile), share
