"""The largest multiplier of many linear maps at once, without computing the others.

Repeated squaring leaves only the fastest-growing directions of a map: the range of a high power is
nearly of low dimension, and the largest eigenvalue on it is that power of the largest multiplier. A
conjugate pair, or several multipliers of equal modulus, need no special treatment.
"""

import math

import numpy as np
from numpy.typing import NDArray

from models.numerics.blocks import aligned, copy
from models.numerics.elementary import exp
from models.numerics.fma import fma
from models.numerics.jit import kernel, lean

Array = NDArray[np.float64]

_SQUARINGS = 50  # |A^n| may differ from radius^n by a factor c: an error of log(c)/2^50 is left
_DOUBLINGS = 8  # the 256th power: a multiplier 8 % below the largest fades to 1e-9 of it
_DIRECTIONS = 8  # kept at most
_FADED = 1e-9  # relative to the largest direction
_VECTOR = 8  # rows are padded to a multiple of it, so that loops over them leave no remainder


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
    room = aligned((2 * k + 1 + _DIRECTIONS) * width).reshape(-1, width)
    _raise_to_power(np.ascontiguousarray(flow), small, scale, room)
    largest = (log_radius(small) + scale) / 2**_DOUBLINGS
    rest = np.flatnonzero(np.isnan(scale) & np.isfinite(flow).all(axis=(1, 2)))
    largest[rest] = log_radius(flow[rest])
    return np.asarray(exp(largest))


def log_radius(matrix: Array) -> Array:
    """Return the logarithm of the largest modulus of the eigenvalues of n matrices.

    By Gelfand's formula it is the limit of log |A^n| / n. Squaring doubles n, and an error in the
    k-th squaring is weighted by 2^-k.

    Parameters
    ----------
    matrix : ndarray, shape (n, k, k)

    Returns
    -------
    ndarray, shape (n,)
        -inf where all eigenvalues are zero, NaN where a matrix is not finite.
    """
    n, k, _ = matrix.shape
    out = np.empty(n)
    _take_logarithms(np.ascontiguousarray(matrix), out, np.empty((k, k)), np.empty((k, k)))
    out[~np.isfinite(matrix).all(axis=(1, 2))] = np.nan
    return out


@kernel
def _take_logarithms(matrix, out, power, square):
    for row in range(len(out)):
        _copy_rows(matrix[row], power)
        total, weight, largest = 0.0, 1.0, 0.0
        for _ in range(_SQUARINGS):
            total += weight * _square(power, square)
            weight *= 0.5
            _copy_rows(square, power)
        for i in range(len(power)):
            for j in range(len(power)):
                largest = max(largest, abs(power[i, j]))
        out[row] = total if largest > 0 else -np.inf


@kernel
def _raise_to_power(flow, small, scale, rows):
    """Set each small matrix, times exp(scale), to the power of the map on the directions it keeps.

    The scale is NaN if these are too many.
    """
    n, k, _ = flow.shape
    power, square, part, basis = rows[:k], rows[k : 2 * k], rows[2 * k], rows[2 * k + 1 :]
    for row in range(n):
        for j in range(k):
            power[j] = 0.0
            copy(flow[row, j], power[j])
        log_scale = 0.0
        for _ in range(_DOUBLINGS):
            log_scale = 2 * (log_scale + _square(power, square))
            _copy_rows(square, power)
        rank = _span(power, basis, part)
        for s in range(max(rank, 0)):
            for j in range(k):
                image = 0.0
                for i in range(k):
                    image += square[j, i] * basis[s, i]
                for r in range(rank):
                    small[row, r, s] += basis[r, j] * image
        scale[row] = log_scale if rank >= 0 else np.nan


@lean
def _copy_rows(source, into):
    for row in range(len(source)):
        copy(source[row], into[row])


@lean
def _square(power, square):
    """Square a matrix divided by its largest entry; return the logarithm of that entry."""
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
        for r in range(0, k - k % 4, 4):
            a, b, c, d = power[i, r], power[i, r + 1], power[i, r + 2], power[i, r + 3]
            for j in range(width):
                total = fma(b, power[r + 1, j], fma(a, power[r, j], square[i, j]))
                square[i, j] = fma(d, power[r + 3, j], fma(c, power[r + 2, j], total))
        for r in range(k - k % 4, k):
            a = power[i, r]
            for j in range(width):
                square[i, j] = fma(a, power[r, j], square[i, j])
    return -math.log(inverse)


@lean
def _span(columns, basis, part):
    """Set `basis` to orthonormal rows that span the columns; return their number, or -1."""
    k, width = columns.shape
    first = np.inf
    for r in range(_DIRECTIONS + 1):
        part[:] = 0.0
        for j in range(k):
            for i in range(width):
                part[i] = fma(columns[j, i], columns[j, i], part[i])
        at = 0  # numba's argmax would import more than most rows need
        for i in range(1, width):
            if part[i] > part[at] or math.isnan(part[i]):
                at = i
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
                part[i] = fma(basis[r, j], columns[j, i], part[i])
        for j in range(k):
            for i in range(width):
                columns[j, i] = fma(-basis[r, j], part[i], columns[j, i])
    return -1
