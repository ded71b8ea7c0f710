"""The largest multiplier of many linear maps at once, without all the others.

Repeated squaring leaves of a map what grows most: a high power of it has few directions, and the
largest eigenvalue on the space they span is that power of the largest multiplier. A conjugate pair,
or several multipliers of one modulus, are no different.
"""

import numpy as np
from numpy.typing import NDArray

from models.numerics.blocks import aligned
from models.numerics.jit import kernel

Array = NDArray[np.float64]

_DOUBLINGS = 8  # the 256th power: of what is 8 % smaller than the largest multiplier, 1e-9 is left
_DIRECTIONS = 8  # kept at most
_FADED = 1e-9  # of the largest direction
_VECTOR = 8  # rows are padded to a multiple of it: loops over them then leave no remainder


def largest_multiplier(flow: Array) -> Array:
    """Return the largest modulus of the eigenvalues of n matrices.

    Parameters
    ----------
    flow : ndarray, shape (n, k, k)

    Returns
    -------
    ndarray, shape (n,)
        NaN where a matrix is not finite.
    """
    n, k, _ = flow.shape
    width = -(-k // _VECTOR) * _VECTOR
    small, scale = np.zeros((n, _DIRECTIONS, _DIRECTIONS)), np.zeros(n)
    _raise_to_power(flow, small, scale, aligned((2 * k + 1 + _DIRECTIONS) * width))
    with np.errstate(divide="ignore"):
        largest = np.log(np.abs(np.linalg.eigvals(small)).max(axis=1, initial=0.0))
    largest = np.exp((largest + scale) / 2**_DOUBLINGS)
    for row in np.flatnonzero(np.isnan(scale)):
        finite = np.isfinite(flow[row]).all()
        largest[row] = np.abs(np.linalg.eigvals(flow[row])).max() if finite else np.nan
    return largest


@kernel
def _raise_to_power(flow, small, scale, room):
    """Set each small matrix, times exp(scale), to the power of the map on what it does not fade.

    The scale is NaN where that has too many directions.
    """
    n, k, _ = flow.shape
    width = room.size // (2 * k + 1 + _DIRECTIONS)
    rows = room.reshape(-1, width)
    power, square, part, basis = rows[:k], rows[k : 2 * k], rows[2 * k], rows[2 * k + 1 :]
    for row in range(n):
        power[:] = 0.0
        power[:, :k] = flow[row]
        log_scale = 0.0
        for _ in range(_DOUBLINGS):
            log_scale = 2 * (log_scale + _square(power, square))
            power[:] = square
        rank = _span(power, basis, part)
        for s in range(max(rank, 0)):
            for j in range(k):
                image = 0.0
                for i in range(k):
                    image += square[j, i] * basis[s, i]
                for r in range(rank):
                    small[row, r, s] += basis[r, j] * image
        scale[row] = log_scale if rank >= 0 else np.nan


@kernel
def _square(power, square):
    """Square a matrix over its largest entry; return the logarithm of that."""
    k, width = power.shape
    largest = 0.0
    for i in range(k):
        for j in range(k):
            largest = max(largest, abs(power[i, j]))
    inverse = 1 / largest if largest > 0 else 1.0
    for i in range(k):
        for j in range(width):
            power[i, j] *= inverse
    for i in range(k):
        for j in range(width):
            square[i, j] = 0.0
        for r in range(k):
            factor = power[i, r]
            for j in range(width):
                square[i, j] += factor * power[r, j]
    return -np.log(inverse)


@kernel
def _span(columns, basis, part):
    """Set basis to orthonormal rows that span the columns; return how many, -1 if too many."""
    k, width = columns.shape
    first = np.inf
    for r in range(_DIRECTIONS + 1):
        part[:] = 0.0
        for j in range(k):
            for i in range(width):
                part[i] += columns[j, i] * columns[j, i]
        at = part.argmax()
        length = np.sqrt(part[at])
        if r == 0:
            first = length
        if length <= _FADED * first:
            return r
        if not length < np.inf or r == _DIRECTIONS:
            break
        for j in range(k):
            basis[r, j] = columns[j, at] / length
        part[:] = 0.0
        for j in range(k):
            for i in range(width):
                part[i] += basis[r, j] * columns[j, i]
        for j in range(k):
            for i in range(width):
                columns[j, i] -= basis[r, j] * part[i]
    return -1
