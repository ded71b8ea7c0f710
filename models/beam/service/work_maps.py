"""Work-rates of rods under a random force, mapped over both gaps: once for a rod and duty state.

Under a random force the mean work-rates depend on the gaps alone, so that lives under other wear
coefficients, scars, creep and orders of duty follow from a map without the beam. The logarithm of
each site's work-rate is a polynomial of both gaps of total degree `DEGREE`, fitted by weighted
least squares to time means at `MAP_NODES` x `MAP_NODES` pairs of gaps.
"""

import math
from typing import NamedTuple

import numpy as np

from models.beam.outputs import MAP_NODES, MAP_POSITIONS
from models.beam.structure.modal import Array
from models.numerics.elementary import log
from models.numerics.jit import kernel

DEGREE = 4
TERMS = (DEGREE + 1) * (DEGREE + 2) // 2

_LARGEST_DOUBT = 0.5  # standard error of a mean over the mean, in a map
_NO_WORK = -700.0  # logarithm of a work-rate that is 0

_POSITIONS = np.array(MAP_POSITIONS)


class WorkMaps(NamedTuple):
    """Maps of n rods in s states of duty.

    Attributes
    ----------
    gap : ndarray, shape (n, s, 2)
        Gaps of both sites without growth [m]; inf where nothing is mapped.
    work, error : ndarray, shape (n, s, 2, MAP_NODES, MAP_NODES)
        Work-rates [W] at growths of the right and the left gap, and their standard errors; NaN
        where nothing is mapped.
    """

    gap: Array
    work: Array
    error: Array


class FittedMaps(NamedTuple):
    """Polynomials of the maps of n rods.

    Attributes
    ----------
    gap : ndarray, shape (n, s, 2)
        As in `WorkMaps`; inf also where a work-rate is too uncertain for a map.
    terms : ndarray, shape (n, s, 2, TERMS)
        Coefficients of the logarithm of the work-rate [W].
    spread : ndarray, shape (n, s, 2, TERMS, TERMS)
        Rows are independent standard errors of the coefficients.
    """

    gap: Array
    terms: Array
    spread: Array


def no_maps(rods: int, states: int) -> WorkMaps:
    """Return maps of nothing."""
    work, error = np.full((2, rods, states, 2, MAP_NODES, MAP_NODES), np.nan)
    return WorkMaps(np.full((rods, states, 2), np.inf), work, error)


@kernel
def mapped_work(right, left, terms):
    """Return the work-rate of a site [W] from growths of both gaps over the largest mapped one."""
    u, v = 2 * right - 1, 2 * left - 1
    logarithm, term = 0.0, 0
    before, now = u, 1.0  # Chebyshev polynomials of the right growth, then of the left one
    for a in range(DEGREE + 1):
        below, here, part = v, 1.0, 0.0
        for _ in range(DEGREE + 1 - a):
            part += terms[term] * here
            term += 1
            below, here = here, 2 * v * here - below
        logarithm += now * part
        before, now = now, 2 * u * now - before
    return math.exp(logarithm)


def _basis() -> Array:
    """Return the polynomials at the nodes, shape (MAP_NODES * MAP_NODES, TERMS)."""
    u = np.polynomial.chebyshev.chebvander(2 * _POSITIONS - 1, DEGREE)
    pairs = [(a, b) for a in range(DEGREE + 1) for b in range(DEGREE + 1 - a)]
    return np.stack([np.outer(u[:, a], u[:, b]).ravel() for a, b in pairs], axis=1)


_BASIS = _basis()


def fit_maps(maps: WorkMaps) -> FittedMaps:
    """Fit polynomials to the maps of n rods.

    Their errors are those of the means, or of the deviations from the polynomial if these are
    larger.
    """
    n, states = maps.gap.shape[:2]
    terms = np.zeros((n, states, 2, TERMS))
    spread, gap = np.zeros((n, states, 2, TERMS, TERMS)), maps.gap.copy()
    for place in np.ndindex(n, states):
        if not np.isfinite(gap[place]).all():
            continue
        for site in range(2):
            work, doubt = maps.work[place][site].ravel(), maps.error[place][site].ravel()
            if not work.any():
                terms[place][site][0] = _NO_WORK
            elif ((doubt > 0) & (doubt <= _LARGEST_DOUBT * work)).all():
                terms[place][site], spread[place][site] = _fit(work, doubt)
            else:
                gap[place] = np.inf
    return FittedMaps(gap, terms, spread)


@kernel
def _least_squares(basis, weight, values, terms, spread):
    """Set the weighted fit of values by m columns, and its independent standard errors.

    By modified Gram-Schmidt orthogonalisation Q R: spread[j] is column j of the inverse of R.
    Returns the weighted sum of squared deviations.
    """
    points, m = basis.shape
    q, r = np.empty((m, points)), np.zeros((m, m))
    left = weight * values
    for j in range(m):
        q[j] = weight * basis[:, j]
        for i in range(j):
            for k in range(points):
                r[i, j] += q[i, k] * q[j, k]
            q[j] -= r[i, j] * q[i]
        for k in range(points):
            r[j, j] += q[j, k] * q[j, k]
        r[j, j] = math.sqrt(r[j, j])
        q[j] /= r[j, j]
        terms[j] = 0.0
        for k in range(points):
            terms[j] += q[j, k] * left[k]
        left -= terms[j] * q[j]
    spread[:] = 0.0
    for j in range(m - 1, -1, -1):
        for i in range(j + 1, m):
            terms[j] -= r[j, i] * terms[i]
        terms[j] /= r[j, j]
        spread[j, j] = 1 / r[j, j]
        for i in range(j - 1, -1, -1):
            for k in range(i + 1, j + 1):
                spread[j, i] -= r[i, k] * spread[j, k]
            spread[j, i] /= r[i, i]
    total = 0.0
    for k in range(points):
        total += left[k] * left[k]
    return total


def _fit(work: Array, doubt: Array) -> tuple[Array, Array]:
    """Return the polynomial of one site, shape (TERMS,), and its errors, shape (TERMS, TERMS)."""
    terms, spread = np.empty(TERMS), np.empty((TERMS, TERMS))
    deviations = _least_squares(_BASIS, work / doubt, log(work), terms, spread)
    scatter = max(1.0, deviations / (len(work) - TERMS))
    return terms, math.sqrt(scatter) * spread
