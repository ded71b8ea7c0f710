"""Dependent inputs: a Gaussian copula with given rank correlations."""

from itertools import combinations

import numpy as np

from uq.contract import Floats
from uq.sampling.input_faults import InputFault
from uq.sampling.unit_cube import Points, inside

Matrix = tuple[tuple[float, ...], ...]

_LEAST_EIGENVALUE = 1e-9
_NEAREST = 2e-9  # to -1 or 1; of two inputs alone the least eigenvalue then is large enough


def normal_correlations(ranks: Matrix) -> Floats:
    """Return the correlations of normal variables that have these rank correlations.

    Parameters
    ----------
    ranks : tuple of tuple of float
        Spearman's, symmetric, ones on the diagonal.

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
    """Return why a matrix is not one of rank correlations, or None.

    Parameters
    ----------
    names : tuple of str
        The parameters, in the order of rows and columns.
    ranks : tuple of tuple of float

    Returns
    -------
    InputFault or None
        Its path is row and column of the entry at fault, or empty.
    """
    k = len(names)
    if [len(row) for row in ranks] != [k] * k:
        return InputFault((), f"must have {k} rows of {k} numbers, one for each of the parameters")
    for i, j in np.ndindex(k, k):
        value, problem = ranks[i][j], ""
        if i == j and value != 1:
            problem = f"must be 1: that of '{names[i]}' with itself"
        elif i != j and not abs(value) <= 1 - _NEAREST:
            problem = f"must lie between -1 and 1, {_NEAREST:g} or more from both; for 1 use equals"
        elif value != ranks[j][i]:
            problem = f"must be the same as [{j}][{i}] = {ranks[j][i]!r}"
        if problem:
            return InputFault((i, j), problem, value)
    if _is_definite(normal_correlations(ranks)):
        return None
    return InputFault(
        (), f"no inputs can have these rank correlations together; {_remedy(names, ranks)}"
    )


def correlated(u: Points, ranks: Matrix) -> Points:
    """Give independent columns the rank correlations of a Gaussian copula.

    Parameters
    ----------
    u : ndarray, shape (n, k)
        Independent, in (0, 1); each row is mapped by itself.
    ranks : tuple of tuple of float

    Returns
    -------
    ndarray, shape (n, k)
        Each column stays uniform; the first is unchanged.
    """
    from scipy.special import ndtr, ndtri

    factor = np.linalg.cholesky(normal_correlations(ranks))
    # Sums of contiguous columns: a matrix product may round a row according to its place.
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
    """Return a correction of a matrix: one entry if possible, else weaker correlations.

    Given all others, the range of one entry is the part explained by the other inputs plus or minus
    the unexplained part: a partial correlation from -1 to 1.
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
        which = f"that of '{names[i]}' with '{names[j]}', {ranks[i][j]!r},"
        return f"given the others, {which} must lie {between}"
    return f"multiply all but the diagonal by {_most(ranks):.2f} or less"


def _most(ranks: Matrix) -> float:
    """Return the largest factor, in steps of 0.01, that makes the correlations possible."""
    off = np.array(ranks) - np.eye(len(ranks))
    for percent in range(99, 0, -1):
        weaker = normal_correlations(tuple(map(tuple, np.eye(len(off)) + percent / 100 * off)))
        if _is_definite(weaker):
            return percent / 100
    return 0.0
