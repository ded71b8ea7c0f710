"""Shapley effects with the additive part of the output taken out of the paths, as a control."""

from itertools import combinations
from math import factorial

import numpy as np
from numpy.typing import NDArray

from uq.contract import Floats
from uq.intervals import ROUNDING
from uq.methods.indices import Indices
from uq.methods.sample import Sample
from uq.methods.shapley import indices_from, parts_of

DEGREES = 3
"""Of the polynomials in each normal score."""

PATHS_EACH = 10
"""Paths for each coefficient that is fitted to them."""

MOST_TOGETHER = 12
"""With more inputs correlated with each other, the sets of them are too many."""

_EXACT = 1e-9
"""What rounding may leave of an effect that is known exactly."""


def additive_shapley(sample: Sample) -> Indices:
    """Estimate the Shapley effect of each input, by formula for the additive part of the output.

    Parameters
    ----------
    sample : Sample
        Of paths.

    Returns
    -------
    Indices
        As of `uq.methods.shapley.shapley_indices`.

    Raises
    ------
    RefusedError
        A constant output, or one that is constant along each path.

    Notes
    -----
    A sum of polynomials, one in each input's normal score, is fitted to the rows of every second
    path and evaluated on the others, and vice versa. Its Shapley effects on the paths are replaced
    by their exact values: so the estimate is unbiased, whatever the polynomials, and paths show
    the effects of what these leave. Hermite polynomials of different degree are uncorrelated, also
    given some scores, and those of degree n of scores with correlation r have correlation r^n [1]_.

    References
    ----------
    .. [1] F. G. Mehler, "Ueber die Entwicklung einer Function von beliebig vielen Variablen nach
       Laplaceschen Functionen hoeherer Ordnung", J. reine angew. Math. 66, 161-176 (1866).
    """
    y, used = sample.grouped[sample.whole], _used(sample)
    parts = parts_of(sample, y)
    degrees = min(DEGREES, len(y) // 2 // (PATHS_EACH * max(len(used), 1)))
    if not degrees or not len(used):
        return indices_from(sample, parts)
    terms = _hermite(sample.scores[sample.whole][..., used], degrees)
    y = y.reshape(*y.shape[:2], -1)  # with the elements of a whole output
    control, exact = np.empty_like(y), np.empty_like(parts)
    half = np.arange(len(y)) % 2 == 0
    for on in (half, ~half):
        weights = np.zeros((degrees, parts.shape[1], y.shape[2]))
        weights[:, used] = _fit(terms[:, ~on], y[~on])
        control[on] = np.einsum("tnkp,tpe->nke", terms[:, on], weights[:, used])
        exact[on] = _exact(weights, sample.matrix)
    return indices_from(sample, parts - parts_of(sample, control) + exact, _EXACT)


def _used(sample: Sample) -> NDArray[np.intp]:
    """Return the places of the inputs that the polynomials are about.

    Not of those that never change the output as the first of a path: they may have no effect, which
    the paths show exactly.
    """
    y = sample.grouped[sample.whole]
    moved = np.abs(y[:, 1] - y[:, 0]) > ROUNDING * np.abs(y).max()
    moved = moved.reshape(len(y), -1).any(axis=1)
    first = sample.direction[sample.whole][:, 0] != 0
    known = np.isfinite(sample.scores[0, 0, 0])
    sizes = np.array([len(_together(sample.matrix, i)) for i in range(len(known))])
    return np.flatnonzero(known & (sizes <= MOST_TOGETHER) & (first & moved[:, None]).any(axis=0))


def _hermite(z: Floats, degrees: int) -> Floats:
    """Return Hermite polynomials of unit variance, their degrees from 1 along a first axis."""
    found = [np.ones_like(z), z]
    for n in range(1, degrees):
        found.append((z * found[n] - np.sqrt(n) * found[n - 1]) / np.sqrt(n + 1))
    return np.stack(found[1:])


def _fit(terms: Floats, y: Floats) -> Floats:
    """Return the coefficients of least squares, shape (degrees, inputs, e), but for that of 1."""
    values = y.reshape(-1, y.shape[-1])
    columns = terms.transpose(1, 2, 0, 3).reshape(len(values), -1)
    columns = np.column_stack([np.ones(len(values)), columns])
    found = np.linalg.lstsq(columns, values, rcond=None)[0]
    return np.asarray(found[1:].reshape(terms.shape[0], terms.shape[3], -1))


def _together(matrix: Floats, place: int) -> tuple[int, ...]:
    """Return the inputs that an input is correlated with, directly or through others."""
    found = {place}
    while more := set(np.flatnonzero((matrix[list(found)] != 0).any(axis=0)).tolist()) - found:
        found |= more
    return tuple(sorted(found))


def _exact(weights: Floats, matrix: Floats) -> Floats:
    """Return the Shapley values of the variance of sums of Hermite polynomials, shape (d,)."""
    found = np.zeros(len(matrix))
    for block in {_together(matrix, i) for i in range(len(matrix))}:
        own, places = matrix[np.ix_(block, block)], list(block)
        if weights[:, places].any():
            found[places] = _of_block(weights[:, places], own)
    return found


def _of_block(weights: Floats, matrix: Floats) -> Floats:
    k = len(matrix)
    explained = {
        some: _explained(weights, matrix, list(some))
        for size in range(k + 1)
        for some in combinations(range(k), size)
    }
    found = np.zeros(k)
    for some, value in explained.items():
        for i in set(range(k)) - set(some):
            share = factorial(len(some)) * factorial(k - len(some) - 1) / factorial(k)
            found[i] += share * (explained[tuple(sorted((*some, i)))] - value)
    return found


def _explained(weights: Floats, matrix: Floats, some: list[int]) -> float:
    """Return the variance of the mean given some scores, summed over elements."""
    if not some:
        return 0.0
    shared = matrix[:, some] @ np.linalg.solve(matrix[np.ix_(some, some)], matrix[some])
    return float(sum((one * (shared ** (n + 1) @ one)).sum() for n, one in enumerate(weights)))
