"""The error that jumps leave in the mean of designs that spread evenly, which no scatter shows.

Every replicate of such a design has one row in each of n strata of an input. Where a function jumps
within a stratum, this row lies before or behind the jump; if on the same side in all replicates,
the jump adds nothing to their scatter, however large its error.
"""

from functools import cached_property
from itertools import combinations
from math import log
from typing import Any, Self

import numpy as np
from numpy.polynomial import legendre
from numpy.typing import ArrayLike, NDArray

from uq.contract import Floats

DEGREE = 6
"""Of the polynomials in the rank of each input that describe what is smooth."""

ROWS_PER_TERM = 12
"""Rows that each of their terms needs."""

MOST_TERMS = 100

MOST_ROWS = 16384
"""Of all replicates together, that show the jumps."""

MOST_JUMPS = 16

SURE = 5.0
"""Standard errors from which a step is a jump, not the noise of other inputs."""

NOISE = 2.0
"""Standard errors up to which a step may be noise: a jump may be as large."""

WIDEST = 16
"""Neighbours on one side of a place are no more than the rows over this."""


class EvenReplicates(np.ndarray[Any, np.dtype[np.int64]]):
    """The replicate of each row of a design that spreads evenly, with the inputs of the rows.

    Attributes
    ----------
    inputs : ndarray, shape (n, d)
    """

    inputs: Floats

    def __new__(cls, replicate: ArrayLike, inputs: Floats) -> Self:
        """Mark the replicate of each row, shape (n,)."""
        marked = np.asarray(replicate, dtype=np.int64).view(cls)
        marked.inputs = inputs
        return marked

    def __array_finalize__(self, other: Any) -> None:
        """Drop the inputs, which may belong to other rows."""
        self.inputs = np.empty((0, 0))

    def __getitem__(self, rows: Any) -> Any:
        """Return the replicates of a subset; of all rows the array itself, with its neighbours."""
        if isinstance(rows, np.ndarray) and rows.dtype == bool and rows.all():
            return self
        chosen = super().__getitem__(rows)
        if isinstance(chosen, EvenReplicates) and len(self.inputs):
            chosen.inputs = self.inputs[rows]
        return chosen

    @cached_property
    def neighbours(self) -> "Neighbours":
        """The order of the rows along each input, and the polynomials of smooth functions."""
        return Neighbours(np.asarray(self), self.inputs)


class Neighbours:
    """The order of rows along each input, and the polynomials that describe what is smooth.

    Attributes
    ----------
    replicates : int
    rows : ndarray of int, shape (m,)
        The first rows of each replicate, at most `MOST_ROWS` together.
    order : ndarray of int, shape (d, m)
        These rows along each input.
    norms : ndarray, shape (m,)
        Of a step from each place on, less the polynomials of its input; infinite where hardly
        anything is left.

    Parameters
    ----------
    replicate : ndarray of int, shape (n,)
    inputs : ndarray, shape (n, d)
    """

    def __init__(self, replicate: NDArray[np.int64], inputs: Floats):
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
        # An input that repeats others leaves but rounding.
        self._basis: Floats = basis[:, np.abs(np.diag(triangle)) > 1e-9 * np.sqrt(n)]
        # Of each step, what no polynomial of its input describes; alike for all inputs.
        along, _ = np.linalg.qr(_polynomials((2 * np.arange(n)[:, None] + 1) / max(n, 1) - 1))
        behind = np.cumsum(along[::-1], axis=0)[::-1]
        left = np.arange(n, 0, -1) - np.square(behind).sum(axis=1)
        least = 1e-3 * self.replicates
        self.norms: Floats = np.sqrt(np.where(left > least, left, np.inf))

    def without_smooth(self, values: Floats) -> Floats:
        """Return the residuals of values that rows have."""
        return values - self._basis @ (self._basis.T @ values)


def _polynomials(scores: Floats) -> Floats:
    """Return Legendre polynomials of each score, and products of two, as the rows allow."""
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


def beyond_jumps(
    value: float, ends: tuple[float, float], values: Floats, replicate: Any, confidence: float
) -> tuple[float, float]:
    """Return the interval of a mean with the error of jumps that scatter does not show.

    Parameters
    ----------
    value : float
        The mean, or a number that differs from it as its error does.
    ends : tuple of float
        From the scatter of replicates.
    values : ndarray, shape (n,)
        Of rows, whose mean it is.
    replicate : ndarray of int, shape (n,), optional
    confidence : float

    Returns
    -------
    low, high : float
        As it is, unless `replicate` has the inputs of the rows. Half-widths are the root of the sum
        of squares of those of the scatter, and of each jump J times -log((1 - confidence) / 2) / n:
        the share of rows beyond a jump that n rows miss with the probability of one tail.
    """
    if not isinstance(replicate, EvenReplicates) or not replicate.inputs.size:
        return ends
    share = -log((1 - confidence) / 2) / len(values)
    error = share * float(np.sqrt(np.square(jumps(values, replicate.neighbours)).sum()))
    return (
        float(value - np.hypot(value - ends[0], error)),
        float(value + np.hypot(ends[1] - value, error)),
    )


def jumps(values: Floats, neighbours: Neighbours) -> Floats:
    """Return the jumps of a function of inputs, and last the largest that noise may hide.

    Parameters
    ----------
    values : ndarray, shape (n,)
        Of rows.
    neighbours : Neighbours
        Of the same rows.

    Returns
    -------
    ndarray
        Steps along inputs, the one that explains most first, of what polynomials of the inputs and
        the steps before leave (orthogonal matching pursuit [1]_). None is larger than the
        difference between the means of its neighbours on both sides, of as many as show it best, in
        the residual or in the values, whichever is larger.

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
    steps: list[Floats] = []
    rounding = 1e-12 * float(np.abs(values).max(initial=0.0))
    while len(neighbours.order) and (noise := float(residual.std())) > rounding:
        sums = np.cumsum(residual[neighbours.order][:, ::-1], axis=1)[:, ::-1]
        explained = np.abs(sums) / neighbours.norms
        which, place = divmod(int(explained.argmax()), n)
        error = noise / float(neighbours.norms[place])
        if explained[which, place] < SURE * noise or len(sizes) == MOST_JUMPS:
            sizes.append(NOISE * error)
            break
        size = float(explained[which, place] / neighbours.norms[place])
        # Near an end polynomials follow a step, and hardly anything of it is left in the residual.
        heights = (
            _step(response[neighbours.order[which]], place, neighbours, noise)
            for response in (residual, values)
        )
        sizes.append(min(size, max(heights)))
        behind = np.zeros(n)
        behind[neighbours.order[which, place:]] = 1.0
        step = neighbours.without_smooth(behind)
        for other in steps:
            step -= other * (other @ step)
        if step @ step < 1e-9 * n:
            break
        steps.append(step / np.sqrt(step @ step))
        residual = residual - steps[-1] * (steps[-1] @ residual)
    return np.array(sizes)


def _step(ordered: Floats, place: int, neighbours: Neighbours, noise: float) -> float:
    """Return the step between the neighbours of a place, of the number of them that shows least."""
    least, width = np.inf, max(neighbours.replicates, 2)
    while width <= max(len(ordered) // WIDEST, 2) and width <= min(place, len(ordered) - place):
        step = ordered[place : place + width].mean() - ordered[place - width : place].mean()
        least = min(least, max(abs(float(step)), NOISE * noise * (2 / width) ** 0.5))
        width *= 2
    return least
