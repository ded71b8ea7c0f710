"""Dependent inputs drawn by their copula, also conditionally on a subset of the inputs."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Self

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats, Mask
from uq.sampling.copulas import PairCopula
from uq.sampling.input_faults import InputFault
from uq.sampling.unit_cube import Points, hashed, inside, uniform

Matrix = tuple[tuple[float, ...], ...]

Joint = Matrix | PairCopula
"""Rank correlations of inputs with a Gaussian copula, or another copula of two inputs."""

_LEAST_EIGENVALUE = 1e-9
_NEAREST = 2e-9  # distance from -1 or 1; the least eigenvalue of two inputs is then large enough

CellOf = Callable[[Floats], tuple[Floats, Floats]]
"""Points of the unit interval -> P(X < x) and P(X <= x) of the values x of a discrete law."""

_AT_ONCE = 4096  # proposals per batch


def normal_correlations(ranks: Matrix) -> Floats:
    """Return the Pearson correlations of normal variables with the given Spearman correlations.

    Parameters
    ----------
    ranks : tuple of tuple of float
        Spearman's rank correlations; symmetric, with ones on the diagonal.

    Returns
    -------
    ndarray, shape (k, k)
        2 sin(pi rho / 6).

    References
    ----------
    K. Pearson, "On further methods of determining correlation", Drapers' Company Research Memoirs,
    Biometric Series IV (1907).
    """
    correlations = 2 * np.sin(np.pi / 6 * np.array(ranks))
    np.fill_diagonal(correlations, 1.0)
    return correlations


def matrix_problem(names: tuple[str, ...], ranks: Matrix) -> InputFault | None:
    """Return the fault of an invalid rank correlation matrix; None if it is valid.

    Parameters
    ----------
    names : tuple of str
        The parameters, in the order of rows and columns.
    ranks : tuple of tuple of float

    Returns
    -------
    InputFault or None
        Its path is the row and column of the invalid entry, or empty.
    """
    k = len(names)
    if [len(row) for row in ranks] != [k] * k:
        return InputFault((), f"must have {k} rows of {k} numbers, one for each of the parameters")
    for i, j in np.ndindex(k, k):
        value, problem = ranks[i][j], ""
        if i == j and value != 1:
            problem = f"must be 1: the correlation of '{names[i]}' with itself"
        elif i != j and not abs(value) <= 1 - _NEAREST:
            problem = f"must be between -1 and 1, {_NEAREST:g} or more from both; for 1 use equals"
        elif value != ranks[j][i]:
            problem = f"must be the same as [{j}][{i}] = {ranks[j][i]!r}"
        if problem:
            return InputFault((i, j), problem, value)
    if _is_definite(normal_correlations(ranks)):
        return None
    return InputFault(
        (), f"no inputs can have these rank correlations together; {_remedy(names, ranks)}"
    )


def correlated(u: Points, joint: Joint) -> Points:
    """Return points that follow a copula, from independent points (Rosenblatt transformation).

    Parameters
    ----------
    u : ndarray, shape (n, k)
        Independent, in (0, 1); each row is mapped by itself.
    joint : tuple of tuple of float or PairCopula

    Returns
    -------
    ndarray, shape (n, k)
        Each column stays uniform; the first is unchanged.
    """
    from scipy.special import ndtr, ndtri

    if isinstance(joint, PairCopula):
        first, second = map(np.ascontiguousarray, u.T)
        return inside(np.stack([first, joint.conditional_quantile(second, first)], axis=1))
    factor = np.linalg.cholesky(normal_correlations(joint))
    # Sums of contiguous columns: a matrix product may round a row according to its position.
    z = [ndtri(np.ascontiguousarray(column)) for column in u.T]
    points = u.copy()
    for i in range(1, len(z)):
        mixed = factor[i, 0] * z[0]
        for j in range(1, i + 1):
            mixed = mixed + factor[i, j] * z[j]
        points[:, i] = ndtr(mixed)
    return inside(points)


def _is_definite(matrix: Floats) -> bool:
    return bool(np.linalg.eigvalsh(matrix)[0] > _LEAST_EIGENVALUE)


def _remedy(names: tuple[str, ...], ranks: Matrix) -> str:
    """Return the proposed correction of a matrix: one entry if possible, else weaker correlations.

    If all other entries are fixed, an entry may range over the part explained by the other inputs
    plus or minus the unexplained part: a partial correlation from -1 to 1.
    """
    matrix, corrections = normal_correlations(ranks), []
    k = len(matrix)
    for i, j in combinations(range(k), 2):
        rest = np.array([other for other in range(k) if other not in (i, j)], dtype=int)
        pair = np.array([i, j])
        if not all(_is_definite(matrix[np.ix_(s, s)]) for s in (np.append(rest, p) for p in pair)):
            continue
        explained = np.linalg.solve(matrix[np.ix_(rest, rest)], matrix[np.ix_(rest, pair)])
        both = matrix[np.ix_(pair, rest)] @ explained
        half = np.sqrt((1 - both[0, 0]) * (1 - both[1, 1]))
        ends = both[0, 1] + np.array([-half, half])
        thousandths = 6000 / np.pi * np.arcsin(np.clip(ends, -1, 1) / 2)
        low, high = np.clip([np.ceil(thousandths[0]), np.floor(thousandths[1])], -999, 999) / 1000
        if low < high:
            corrections.append((max(low - ranks[i][j], ranks[i][j] - high), i, j, low, high))
    if corrections:
        _, i, j, low, high = min(corrections)
        between = f"between {low:.3f} and {high:.3f}"
        which = f"the correlation of '{names[i]}' with '{names[j]}', {ranks[i][j]!r},"
        return f"given the others, {which} must be {between}"
    return f"multiply all but the diagonal by {_most(ranks):.2f} or less"


def _most(ranks: Matrix) -> float:
    """Return the largest factor, in steps of 0.01, that makes the matrix positive definite."""
    off = np.array(ranks) - np.eye(len(ranks))
    for percent in range(99, 0, -1):
        weaker = normal_correlations(tuple(map(tuple, np.eye(len(off)) + percent / 100 * off)))
        if _is_definite(weaker):
            return percent / 100
    return 0.0


def conditional_paths(u: Points, joint: Joint, cells: Sequence[CellOf | None]) -> Points:
    """Return paths whose rows follow a copula, from independent paths.

    Parameters
    ----------
    u : ndarray, shape (n, rows, k)
        In (0, 1). Along a path, each coordinate changes at most once, from its value in the first
        row to its value in the last row. Each path is mapped by itself.
    joint : tuple of tuple of float or PairCopula
    cells : sequence of callable or None
        For each input; None if its law is continuous.

    Returns
    -------
    ndarray, shape (n, rows, k)
        Every row follows the copula. Inputs that have changed since the first row are drawn from
        their conditional law given the other inputs, independently of their values in the first
        row.

    Notes
    -----
    Inputs are drawn sequentially (Rosenblatt transformation) [1]_: first the unchanged inputs, then
    the changed ones, starting with the last to change. Neighbouring rows thus share their random
    numbers.

    References
    ----------
    .. [1] M. Rosenblatt, "Remarks on a multivariate transformation", Ann. Math. Stat. 23, 470-472
       (1952).
    """
    from scipy.special import ndtr, ndtri

    if isinstance(joint, PairCopula):
        return _paths_of_pair(u, joint, cells)
    first = correlated(u[:, 0], joint)
    low = ndtri(first)
    high = low.copy()
    for i, cell in enumerate(cells):
        if cell is not None:
            low[:, i], high[:, i] = map(ndtri, cell(np.ascontiguousarray(first[:, i])))
    changed = u[:, 1:] != u[:, :1]
    kind = np.where(changed, 2, (low < high)[:, None])  # 0: point, 1: interval, 2: free
    since = changed.sum(axis=1, keepdims=True)
    # Narrow intervals first: this increases the acceptance rate of the others.
    order = np.lexsort((np.where(changed, since, (high - low)[:, None]), kind), axis=-1)

    def ordered(values: Floats) -> Floats:
        taken = np.take_along_axis(np.broadcast_to(values, order.shape), order, axis=-1)
        return taken.reshape(-1, order.shape[-1])

    orders, which = np.unique(order.reshape(-1, order.shape[-1]), axis=0, return_inverse=True)
    matrix = normal_correlations(joint)[orders[:, :, None], orders[:, None, :]]
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


def _paths_of_pair(u: Points, copula: PairCopula, cells: Sequence[CellOf | None]) -> Points:
    """Return paths of two inputs (`conditional_paths`).

    A changed input is drawn given the value of the unchanged one: given its point, or, if its law
    is discrete, given a point drawn uniformly from the subinterval with its value.
    """
    first = correlated(u[:, 0], copula)
    changed = u[:, 1:] != u[:, :1]
    fresh = [np.ascontiguousarray(u[:, -1, i]) for i in range(2)]
    alone = []
    for i, j in ((0, 1), (1, 0)):
        given, cell = np.ascontiguousarray(first[:, j]), cells[j]
        if cell is not None:
            low, high = cell(given)
            given = inside(low + fresh[j] * (high - low))
        alone.append(copula.conditional_quantile(fresh[i], given))
    # Where both have changed, the last to change is drawn first.
    since = changed.sum(axis=1)
    second_later = since[:, 1] < since[:, 0]
    given = np.where(second_later, fresh[1], fresh[0])
    last = copula.conditional_quantile(np.where(second_later, fresh[0], fresh[1]), given)
    both = np.stack([np.where(second_later, last, given), np.where(second_later, given, last)], 1)
    drawn = np.where(changed.all(axis=2, keepdims=True), both[:, None], np.stack(alone, 1)[:, None])
    first = first[:, None]
    return np.concatenate([first, np.where(changed, inside(drawn), first)], axis=1)


@dataclass(frozen=True)
class _Rows:
    """Rows of normal scores, with the order in which the inputs of each row are drawn.

    Attributes
    ----------
    factors : ndarray, shape (m, k, k)
        Cholesky factors of the correlation matrix, one for each order that occurs.
    order : ndarray of int, shape (n,)
        Index of the Cholesky factor of each row.
    low, high : ndarray, shape (n, k)
        Limits of each score.
    u : ndarray, shape (n, k)
        Random numbers in (0, 1) for the draw.
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
        """Mask of the restricted scores except the first of each row."""
        return self.intervals & (np.cumsum(self.intervals, axis=1) > 1)

    def scores(self) -> Floats:
        """Return a draw of the scores."""
        scores, _ = self.drawn()
        several = np.flatnonzero(self.intervals.sum(axis=1) > 1)
        if len(several):
            scores[several] = self.part(several, self.u[several]).accepted()
        return scores

    def drawn(self) -> tuple[Floats, Floats]:
        """Return scores drawn sequentially from truncated normal laws, with their weights.

        Returns
        -------
        scores : ndarray, shape (n, k)
        chance : ndarray, shape (n,)
            Importance weight: the product of the probabilities of the intervals after the first,
            each given the previous scores. The density of the scores given all intervals is the
            density of the draw times this weight, up to a constant factor.
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
        """Return scores of rows with several intervals, drawn by rejection sampling."""
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
        """Return an upper bound of the importance weight of a draw, shape (n,)."""
        bound, inverse = np.ones(len(self.u)), np.linalg.inv(self.factors)
        for i in range(1, self.u.shape[1]):
            rows = np.flatnonzero(self.later[:, i])
            low, high, order = self.low[rows], self.high[rows], self.order[rows]
            sd = self.factors[order, i, i]
            least, most = np.zeros(len(rows)), np.zeros(len(rows))
            for j in range(i):  # the mean is linear in the previous scores
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
    """Return quantiles of the truncated normal law, and the probability of its interval."""
    from scipy.special import ndtr, ndtri

    upper = low > -high  # the lower tail of the mirrored law is more accurate here
    least, most = np.where(upper, -high, low), np.where(upper, -low, high)
    below = ndtr(least)
    share = ndtr(most) - below
    quantile = ndtri(below + np.where(upper, 1 - u, u) * share)
    quantile = np.where(np.isfinite(quantile), quantile, most)  # the probability underflows
    return np.where(upper, -quantile, quantile), share
