"""Many small linear systems, solved independently: a singular one affects no other.

Compiled here, results have the same bits everywhere, which no LAPACK guarantees.
"""

import numpy as np
from numpy.typing import NDArray

from models.numerics.blocks import copy
from models.numerics.fma import fma
from models.numerics.jit import kernel

Array = NDArray[np.float64]

_VECTOR = 8  # rows are padded to a multiple of it, so that loops over them leave no remainder


def solve(matrix: Array, right: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Solve n linear systems, whose equations may be in any units.

    Parameters
    ----------
    matrix : ndarray, shape (n, k, k)
    right : ndarray, shape (n, k, m)
        m right-hand sides for each.

    Returns
    -------
    solution : ndarray, shape (n, k, m)
        0 where there is none.
    regular : ndarray of bool, shape (n,)
        False where the matrix is singular.
    """
    scale = np.abs(matrix).max(axis=2, keepdims=True)
    scale[scale == 0] = 1.0
    solution = np.ascontiguousarray(right / scale)
    _eliminate(np.ascontiguousarray(matrix / scale), solution)
    regular: NDArray[np.bool_] = np.isfinite(solution).all(axis=(1, 2))
    solution[~regular] = 0.0
    return solution, regular


def inverse(matrix: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Invert n matrices, for systems that are solved repeatedly.

    Parameters
    ----------
    matrix : ndarray, shape (n, k, k)

    Returns
    -------
    inverse : ndarray, shape (n, k, k)
        0 where there is none.
    regular : ndarray of bool, shape (n,)
        False where the matrix is singular.
    """
    n, k, _ = matrix.shape
    out = np.empty((n, k, k))
    invert(
        np.ascontiguousarray(matrix),
        out,
        np.zeros((k, -(-k // _VECTOR) * _VECTOR)),
        np.empty(k, np.int64),
    )
    regular = np.asarray(np.isfinite(out).all(axis=(1, 2)), bool)
    out[~regular] = 0.0
    return out, regular


def product(matrix: Array, right: Array) -> Array:
    """Multiply n matrices by n others.

    Parameters
    ----------
    matrix : ndarray, shape (n, k, l)
    right : ndarray, shape (n, l, m)

    Returns
    -------
    ndarray, shape (n, k, m)
    """
    out = np.zeros((*matrix.shape[:2], right.shape[2]))
    _multiply(np.ascontiguousarray(matrix), np.ascontiguousarray(right), out)
    return out


@kernel
def _multiply(matrix, right, out):
    n, k, inner = matrix.shape
    for system in range(n):
        for i in range(k):
            for r in range(inner):
                factor = matrix[system, i, r]
                for j in range(out.shape[2]):
                    out[system, i, j] = fma(factor, right[system, r, j], out[system, i, j])


@kernel
def _eliminate(matrix, right):
    """Solve in place by Gaussian elimination with partial pivoting."""
    n, k, width = right.shape
    for system in range(n):
        a, b = matrix[system], right[system]
        for c in range(k):
            pivot = c
            for i in range(c + 1, k):
                if abs(a[i, c]) > abs(a[pivot, c]):
                    pivot = i
            if pivot != c:
                for j in range(c, k):
                    a[c, j], a[pivot, j] = a[pivot, j], a[c, j]
                for j in range(width):
                    b[c, j], b[pivot, j] = b[pivot, j], b[c, j]
            scale = 1 / a[c, c]
            for i in range(c + 1, k):
                factor = -a[i, c] * scale
                for j in range(c + 1, k):
                    a[i, j] = fma(factor, a[c, j], a[i, j])
                for j in range(width):
                    b[i, j] = fma(factor, b[c, j], b[i, j])
        for c in range(k - 1, -1, -1):
            scale = 1 / a[c, c]
            for j in range(width):
                b[c, j] *= scale
            for i in range(c):
                for j in range(width):
                    b[i, j] = fma(-a[i, c], b[c, j], b[i, j])


@kernel
def invert(matrix, out, rows, pivots):
    """Set `out` to the inverses of n matrices, for `inverse` and for other kernels.

    By Gauss-Jordan elimination with partial pivoting; not finite where a matrix is singular.

    Parameters
    ----------
    matrix, out : ndarray, shape (n, k, k)
    rows : ndarray, shape (k, m)
        Room, of zeros at first, with m a multiple of 8 and not less than k.
    pivots : ndarray of int, shape (k,)
        Room.
    """
    n, k, _ = matrix.shape
    for system in range(n):
        for i in range(k):
            copy(matrix[system, i], rows[i])
        for c in range(k):
            pivot = c
            for i in range(c + 1, k):
                if abs(rows[i, c]) > abs(rows[pivot, c]):
                    pivot = i
            pivots[c] = pivot
            scale = 1 / rows[pivot, c]
            for j in range(rows.shape[1]):
                kept = rows[c, j]
                rows[c, j] = rows[pivot, j] * scale
                if pivot != c:
                    rows[pivot, j] = kept
            rows[c, c] = scale
            for i in range(k):
                if i != c:
                    factor = rows[i, c]
                    rows[i, c] = 0.0
                    for j in range(rows.shape[1]):
                        rows[i, j] = fma(-factor, rows[c, j], rows[i, j])
        for i in range(k):
            copy(rows[i, :k], out[system, i])
        for c in range(k - 1, -1, -1):  # row exchanges become column exchanges of the inverse
            for i in range(k if pivots[c] != c else 0):
                out[system, i, c], out[system, i, pivots[c]] = (
                    out[system, i, pivots[c]],
                    out[system, i, c],
                )
