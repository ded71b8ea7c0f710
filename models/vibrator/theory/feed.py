"""The feed thrown by the deck once per turn, and its effect on the motion of the deck.

The deck moves as y = A_y sin tau. The feed leaves it where sin tau_1 = 1/k_p, flies freely, lands
at tau_3 without rebound and rides until it leaves again. With n_1 the first Fourier coefficient
of the contact force over feed weight, the harmonic part of the force equals that of a mass

    kappa m_n,    kappa = -j n_1/k_p,

fixed to the deck: kappa = 1 while the feed never leaves it. The imaginary part of kappa takes
energy from the deck (Im kappa < 0); the real part makes it heavier in the vertical direction, which
drives the vibrators apart.
"""

import cmath
import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from models.numerics.jit import kernel

LARGEST_THROW = math.sqrt(1 + math.pi**2)
"""Throw coefficient at which the flight lasts a whole turn, the limit of single-stroke motion."""


@kernel
def _landing(throw):
    """Return tau_1 and tau_3 of one feed; NaN where it does not bounce once per turn."""
    if not 1.0 < throw <= LARGEST_THROW:
        return math.nan, math.nan
    start = math.asin(1 / throw)
    # The height above the deck is convex, then concave up to a whole turn: from there Newton's
    # method converges monotonically.
    flight = 2 * math.pi
    for _ in range(60):
        height = (
            (math.sin(start) - math.sin(start + flight))
            + flight * math.cos(start)
            - flight**2 / (2 * throw)
        )
        rate = math.cos(start) - flight / throw - math.cos(start + flight)
        step = height / rate
        flight -= step
        if not abs(step) > 1e-15 * flight:
            break
    return start, start + flight


@kernel
def _riding(tau, throw):
    """Integral of (1 - k_p sin tau) e^(-j tau)."""
    turn = cmath.exp(-1j * tau)
    return 1j * turn + throw * (0.5j * tau + 0.25 * turn * turn)


@kernel
def _contact(throw):
    """Return n_1 of one feed, of its impact and of the force while it rides."""
    if throw <= 1.0:
        return 1j * throw
    start, end = _landing(throw)
    impulse = throw * (math.cos(end) - math.cos(start)) + end - start
    coefficient = impulse * cmath.exp(-1j * end)
    coefficient += _riding(start, throw) - _riding(end - 2 * math.pi, throw)
    return coefficient * (1 / math.pi)


@kernel
def _landings(throw, out):
    for i in range(len(throw)):
        out[i] = _landing(throw[i])


@kernel
def _contacts(throw, out):
    for i in range(len(throw)):
        out[i] = _contact(throw[i])


def flight(throw_coefficient: Any) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Return the phases of the deck at which the feed leaves it and lands.

    sin tau_1 = 1/k_p,
    sin tau_1 + (tau_3 - tau_1) cos tau_1 - (tau_3 - tau_1)^2/(2 k_p) = sin tau_3.

    Parameters
    ----------
    throw_coefficient : array_like
        k_p = A_y w^2/g [1].

    Returns
    -------
    lift_off, landing : ndarray
        tau_1 and tau_3 [rad], in the shape of `throw_coefficient`; NaN up to 1, where the feed
        never leaves the deck, and above `LARGEST_THROW`, where a flight outlasts a turn.
    """
    throw = np.asarray(throw_coefficient, float)
    out = np.empty((throw.size, 2))
    _landings(throw.ravel(), out)
    return out[:, 0].reshape(throw.shape), out[:, 1].reshape(throw.shape)


def contact_coefficient(throw_coefficient: Any) -> NDArray[np.complex128]:
    """Return the first Fourier coefficient of the contact force over one turn.

    N_1 = (1/pi) int_0^2pi N e^(-j tau) dtau of eq. (12), divided by the weight of the feed. The
    force while the feed rides is included; the paper keeps only the impact.

    Parameters
    ----------
    throw_coefficient : array_like
        k_p [1].

    Returns
    -------
    ndarray of complex
        N_1/(m_n g) [1]; NaN above `LARGEST_THROW`.
    """
    throw = np.asarray(throw_coefficient, float)
    out = np.empty(throw.size, complex)
    _contacts(throw.ravel(), out)
    return out.reshape(throw.shape)


def apparent_mass(throw_coefficient: Any) -> NDArray[np.complex128]:
    """Return kappa = -j n_1/k_p, the ratio of the feed's apparent mass to its mass.

    Parameters
    ----------
    throw_coefficient : array_like
        k_p [1].

    Returns
    -------
    ndarray of complex
        1 where the feed never leaves the deck, NaN above `LARGEST_THROW`.
    """
    throw = np.asarray(throw_coefficient, float)
    return -1j * contact_coefficient(throw) / throw
