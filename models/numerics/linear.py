"""Many small systems of linear equations, each on its own: a singular one harms no other."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.numerics.jit import kernel

Array = NDArray[np.float64]

_VECTOR = 8  # rows are padded to a multiple of it: loops over them then leave no remainder


def solve(matrix: Array, right: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Solve n systems whose equations may be in any units.

    Parameters
    ----------
    matrix : ndarray, shape (n, k, k)
    right : ndarray, shape (n, k, m)
        m right-hand sides of each.

    Returns
    -------
    solution : ndarray, shape (n, k, m)
        0 where there is none.
    regular : ndarray of bool, shape (n,)
        False where the matrix is singular.
    """
    scale = np.abs(matrix).max(axis=2, keepdims=True)
    scale[scale == 0] = 1.0
    matrix, right = matrix / scale, right / scale
    solution: Any
    try:
        solution = np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:  # one of them is singular: only then is it worth asking which
        with np.errstate(invalid="ignore"):
            singular: Any = np.linalg.det(matrix) == 0
        matrix[singular] = np.eye(matrix.shape[1])
        solution = np.linalg.solve(matrix, right)
        solution[singular] = np.nan
    regular: NDArray[np.bool_] = np.isfinite(solution).all(axis=(1, 2))
    solution[~regular] = 0.0
    return solution, regular


def inverse(matrix: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Invert n matrices, for equations that are solved again and again.

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
    _invert(matrix, out, np.zeros((k, -(-k // _VECTOR) * _VECTOR)), np.empty(k, np.int64))
    regular = np.asarray(np.isfinite(out).all(axis=(1, 2)), bool)
    out[~regular] = 0.0
    return out, regular


@kernel
def _invert(matrix, out, rows, pivots):
    """Gauss-Jordan elimination in place, with the largest pivot of each column."""
    n, k, _ = matrix.shape
    for system in range(n):
        rows[:, :k] = matrix[system]
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
                        rows[i, j] -= factor * rows[c, j]
        out[system] = rows[:, :k]
        for c in range(k - 1, -1, -1):  # rows exchanged before are columns of the inverse
            for i in range(k if pivots[c] != c else 0):
                out[system, i, c], out[system, i, pivots[c]] = (
                    out[system, i, pivots[c]],
                    out[system, i, c],
                )
