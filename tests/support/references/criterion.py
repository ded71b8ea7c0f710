"""Blekhman's integral criterion of stable synchronisation, eq. (1), evaluated from the motion.

The stable phase difference of identical motors minimises D = <E - V> + <E_w - V_w>, the mean over a
period of kinetic less potential energy of the linear body and of the elastic mounts that couple the
vibrators to it. Only a conservative machine has such a function: damping of supports and mounts is
neglected, and the deck is empty.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from models.vibrator.parameters import Rows
from models.vibrator.theory.averaged import Motion, broadcast, steady_motion

_INSTANTS = 16  # per period; energies are quadratic in harmonic motion, so their mean is exact


def _mean_square(*parts: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return the sum of the mean squares of harmonic quantities, from samples of one period."""
    turn = np.exp(2j * np.pi * np.arange(_INSTANTS) / _INSTANTS)[:, None]
    return sum((np.mean((part * turn).real ** 2, axis=0) for part in parts), np.zeros(1))


def _stretch(stiffness: NDArray[np.float64], *parts: NDArray[np.complex128]) -> NDArray[np.float64]:
    """Return the mean potential energy of a spring; a rigid one stores none."""
    return 0.5 * np.where(np.isinf(stiffness), 0.0, stiffness) * _mean_square(*parts)


def _kinetic(p: Rows, w: NDArray[np.float64], q: Motion) -> NDArray[np.float64]:
    """Return the mean kinetic energy, with each unbalanced mass on its shaft."""
    cos, sin = np.cos(p.working_angle), np.sin(p.working_angle)
    along = p.shaft_distance * np.cos(p.shaft_half_angle)
    half = p.shaft_distance * np.sin(p.shaft_half_angle)
    direction = p.working_angle + p.mount_angle
    # twice the energy over w^2
    moved = p.body_mass * _mean_square(q.x, q.y) + p.body_inertia * _mean_square(q.alpha)
    moved += p.mount_inertia * _mean_square(q.alpha + q.turn)
    for side, mass in ((0, p.mount_mass), (1, p.unbalanced_mass), (-1, p.unbalanced_mass)):
        x = along * cos - p.axis_offset * sin
        y = along * sin + p.axis_offset * cos
        arm_x, arm_y = -side * half * sin, side * half * cos
        moved += mass * _mean_square(
            q.x + q.slide * np.cos(direction) - q.alpha * y - (q.alpha + q.turn) * arm_y,
            q.y + q.slide * np.sin(direction) + q.alpha * x + (q.alpha + q.turn) * arm_x,
        )
    return 0.5 * w**2 * moved


def _potential(p: Rows, q: Motion) -> NDArray[np.float64]:
    """Return the mean potential energy of supports and mounts."""
    supports = _stretch(p.stiffness_x, q.x + p.support_offset * q.alpha)
    supports += _stretch(p.stiffness_y, q.y, p.support_half_spacing * q.alpha)
    mounts = _stretch(p.mount_stiffness, q.slide)
    return supports + mounts + _stretch(p.mount_rotational_stiffness, q.turn)


def integral(p: Rows, speed: ArrayLike, angle: ArrayLike) -> NDArray[np.float64]:
    """Return D of eq. (1) at a given speed and phase difference.

    In joules, with L_1 - L_2 = -2 dD/d dphi; arguments as of `steady_motion`.
    """
    p, (w, dphi) = broadcast(p, speed, angle)
    p = p._replace(damping_ratio=0 * w, mount_damping_ratio=0 * w, feed_mass=0 * w)
    motion = steady_motion(p, w, dphi)
    return _kinetic(p, w, motion) - _potential(p, motion)


def minimising_angle(p: Rows, speed: ArrayLike) -> NDArray[np.float64]:
    """Return dphi in (-pi, pi] that minimises D, at which identical motors lock [rad]."""
    # D(dphi) is a constant plus a first harmonic, so three values determine it.
    thirds = 2 * np.pi / 3 * np.arange(3)
    harmonic = sum(integral(p, speed, a) * np.exp(1j * a) for a in thirds)
    angle = np.angle(-np.asarray(harmonic))
    return np.where(angle == -np.pi, np.pi, angle)
