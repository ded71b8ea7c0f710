"""Many small systems of linear equations, each on its own: a singular one harms no other."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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
