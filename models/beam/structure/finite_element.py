"""Finite elements of the loosely supported beam: frequencies and tip values of its modes.

Equal Hermite cubic Euler-Bernoulli elements with consistent mass; one end is supported by a lateral
and a rotational spring, the other (the tip) is free, under the load and both contact springs.
Rotations are scaled by the element length, so that every matrix below is a constant times a
physical factor:

    M = rho A h Mhat,    K^-1 = (h^3/EI) Ghat + r r^T/k_tra + (h^2 s s^T)/k_rot,

with Ghat the flexibility of the clamped beam, r and s its rigid translation and rotation. The modes
are computed from the flexibility, because the eigenvalues 1/w^2 of K^-1 M make the LOW frequencies
the accurate ones: to about 1e-15 relative in the fundamental, however fine the mesh.
"""

import math
from functools import cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.fma import fma
from models.numerics.jit import kernel
from models.numerics.linear import inverse, product
from models.numerics.symmetric import eigenvalues

Array = NDArray[np.float64]


class Modes(NamedTuple):
    """Undamped, contact-free modes of n beams, lowest first.

    Attributes
    ----------
    frequency : ndarray, shape (n, m)
        Angular frequencies w_i [rad s-1].
    tip : ndarray, shape (n, m)
        Mass-normalised modes' value at the tip, phi_i [kg-1/2].
    """

    frequency: Array
    tip: Array


def element_matrices(elements: int) -> tuple[Array, Array]:
    """Assemble the dimensionless matrices of a free-free beam of equal Hermite elements.

    Parameters
    ----------
    elements : int

    Returns
    -------
    mass, stiffness : ndarray, shape (2 elements + 2, 2 elements + 2)
        In units of rho A h and EI/h^3; degrees of freedom w_0, h w'_0, w_1, h w'_1, ...
    """
    m = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
    k = np.array([[12.0, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]])
    size = 2 * elements + 2
    mass, stiffness = np.zeros((size, size)), np.zeros((size, size))
    for e in range(elements):
        dofs = slice(2 * e, 2 * e + 4)
        mass[dofs, dofs] += m
        stiffness[dofs, dofs] += k
    return mass, stiffness


@cache
def _constants(elements: int) -> tuple[Array, Array, Array, Array]:
    """Return L^T Ghat L, L^T r, L^T s and the last-deflection row of L^-T, with Mhat = L L^T."""
    mass, stiffness = element_matrices(elements)
    size = len(mass)
    lower = np.zeros((1, size, size))
    _factorise(mass, lower[0])
    flexibility = np.zeros((1, size, size))
    flexibility[:, 2:, 2:], _ = inverse(stiffness[None, 2:, 2:])
    translation = np.tile([1.0, 0.0], elements + 1)
    rotation = np.ones(size)
    rotation[0::2] = np.arange(elements + 1)
    upper = lower.transpose(0, 2, 1)
    clamped = product(product(upper, flexibility), lower)[0]
    moved, turned = product(upper, np.stack([translation, rotation], axis=1)[None])[0].T
    tip_row = inverse(lower)[0][0, :, -2]
    return 0.5 * (clamped + clamped.T), moved, turned, tip_row


@kernel
def _factorise(matrix, lower):
    """Set `lower` to the Cholesky factor of a positive definite matrix."""
    for j in range(len(matrix)):
        for i in range(j, len(matrix)):
            rest = matrix[i, j]
            for r in range(j):
                rest = fma(-lower[i, r], lower[j, r], rest)
            lower[i, j] = math.sqrt(rest) if i == j else rest / lower[j, j]


def modes(
    length: Array,
    flexural_rigidity: Array,
    mass_per_length: Array,
    lateral_support_stiffness: Array,
    rotational_support_stiffness: Array,
    elements: int,
    count: int | None = None,
) -> Modes:
    """Solve the eigenproblem of n sprung, contact-free beams.

    Parameters
    ----------
    length : ndarray, shape (n,)
        L [m].
    flexural_rigidity : ndarray, shape (n,)
        EI [N m2].
    mass_per_length : ndarray, shape (n,)
        rho A [kg m-1].
    lateral_support_stiffness : ndarray, shape (n,)
        k_tra [N m-1].
    rotational_support_stiffness : ndarray, shape (n,)
        k_rot [N m rad-1].
    elements : int
    count : int, optional
        Modes to return, all 2 elements + 2 by default.

    Returns
    -------
    Modes
        With positive tip values.
    """
    clamped, translation, rotation, tip_row = _constants(elements)
    h = length / elements
    mass = (mass_per_length * h)[:, None, None]
    flexibility = (
        (h * h * h / flexural_rigidity)[:, None, None] * clamped
        + np.outer(translation, translation) / lateral_support_stiffness[:, None, None]
        + (h**2 / rotational_support_stiffness)[:, None, None] * np.outer(rotation, rotation)
    )
    inverse_square, tip = eigenvalues(flexibility * mass, tip_row)
    tip = np.abs(tip) / np.sqrt(mass[:, :, 0])
    return Modes(1 / np.sqrt(inverse_square[:, :count]), tip[:, :count])
