"""Eigenvalues of many symmetric matrices, and products of one row with their eigenvectors.

Householder reflections give a tridiagonal matrix, implicit QL steps its eigenvalues (Golub and Van
Loan, Matrix Computations, Sec. 8.3). Of the eigenvectors only their products with one row are
formed, at little extra cost. Compiled here, the bits do not depend on the LAPACK installed.
"""

import math

import numpy as np
from numpy.typing import NDArray

from models.numerics.blocks import copy
from models.numerics.jit import kernel, lean

Array = NDArray[np.float64]

_STEPS = 50  # QL steps for one eigenvalue, at most
_EPSILON = float(np.finfo(float).eps)


def eigenvalues(matrix: Array, row: Array) -> tuple[Array, Array]:
    """Return the eigenvalues of n symmetric matrices, largest first.

    Parameters
    ----------
    matrix : ndarray, shape (n, k, k)
        Only the diagonal and what is below it are read.
    row : ndarray, shape (k,)

    Returns
    -------
    values, products : ndarray, shape (n, k)
        Eigenvalues, and products of the row with the unit eigenvectors, of either sign.
    """
    n, k, _ = matrix.shape
    values, products = np.empty((n, k)), np.empty((n, k))
    _solve(matrix, row, values, products, np.empty((k, k)), np.empty((3, k)))
    order = np.argsort(-values, axis=1, kind="stable")
    return np.take_along_axis(values, order, 1), np.take_along_axis(products, order, 1)


@kernel
def _solve(matrix, row, values, products, work, room):
    off, v, p = room
    for n in range(matrix.shape[0]):
        for i in range(len(work)):
            copy(matrix[n, i], work[i])
        copy(row, products[n])
        _tridiagonalise(work, products[n], values[n], off, v, p)
        _diagonalise(values[n], off, products[n])


@lean
def _tridiagonalise(a, row, diagonal, off, v, p):
    """Reflect column by column until only two diagonals are left; reflect the row, too."""
    k = len(diagonal)
    for c in range(k - 2):
        head, rest = a[c + 1, c], 0.0
        for i in range(c + 2, k):
            rest += a[i, c] * a[i, c]
        off[c] = head
        if rest == 0:
            continue
        off[c] = -math.copysign(math.sqrt(head * head + rest), head)
        # The reflection is 1 - share v v^T.
        share = 1 / (off[c] * (off[c] - head))
        v[c + 1] = head - off[c]
        for i in range(c + 2, k):
            v[i] = a[i, c]
        along = 0.0
        for i in range(c + 1, k):
            p[i] = 0.0
            along += row[i] * v[i]
        for j in range(c + 1, k):
            p[j] += a[j, j] * v[j]
            for i in range(j + 1, k):
                p[i] += a[i, j] * v[j]
                p[j] += a[i, j] * v[i]
        both = 0.0
        for i in range(c + 1, k):
            p[i] *= share
            both += p[i] * v[i]
            row[i] -= share * along * v[i]
        for i in range(c + 1, k):
            p[i] -= 0.5 * share * both * v[i]
        for i in range(c + 1, k):
            for j in range(c + 1, i + 1):
                a[i, j] -= v[i] * p[j] + p[i] * v[j]
    if k > 1:
        off[k - 2] = a[k - 1, k - 2]
    off[k - 1] = 0.0
    for i in range(k):
        diagonal[i] = a[i, i]


@lean
def _diagonalise(d, e, row):
    """Turn the diagonal d into eigenvalues until nothing is left beside it; rotate the row."""
    k = len(d)
    for first in range(k):
        for _ in range(_STEPS):
            last = first
            while last < k - 1 and abs(e[last]) > _EPSILON * (abs(d[last]) + abs(d[last + 1])):
                last += 1
            if last == first:
                break
            _step(d, e, row, first, last)


@lean
def _step(d, e, row, first, last):
    """Take one implicit QL step of the block from first to last, with Wilkinson's shift."""
    half = (d[first + 1] - d[first]) / (2 * e[first])
    root = math.sqrt(half * half + 1)
    g = d[last] - d[first] + e[first] / (half + math.copysign(root, half))
    sine, cosine, shift = 1.0, 1.0, 0.0
    for i in range(last - 1, first - 1, -1):
        f, b = sine * e[i], cosine * e[i]
        length = math.sqrt(f * f + g * g)
        e[i + 1] = length
        if length == 0:
            d[i + 1] -= shift
            e[last] = 0.0
            return
        sine, cosine = f / length, g / length
        g = d[i + 1] - shift
        turned = (d[i] - g) * sine + 2 * cosine * b
        shift = sine * turned
        d[i + 1] = g + shift
        g = cosine * turned - b
        upper = row[i + 1]
        row[i + 1] = sine * row[i] + cosine * upper
        row[i] = cosine * row[i] - sine * upper
    d[first] -= shift
    e[first], e[last] = g, 0.0
