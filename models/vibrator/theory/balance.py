"""Torque balances of the two vibrators at one common speed, and whether a state is stable."""

import math
from typing import Any, NamedTuple

import numpy as np

from models.numerics.jit import kernel
from models.vibrator.parameters import Rows
from models.vibrator.theory.receptance import respond


class Motor(NamedTuple):
    """One motor with its vibrator; n of them if the fields are arrays.

    Attributes
    ----------
    breakdown : float
        2 p M_zn (w_s - w_u) [N m rad s-1].
    synchronous, slip : float
        w_s and w_s - w_u [rad s-1].
    bearing : float
        rho m e [kg m2]: bearing torque over w^2.
    inertia : float
        J_zr + m e^2, about the shaft [kg m2].
    """

    breakdown: Any
    synchronous: Any
    slip: Any
    bearing: Any
    inertia: Any


class Balance(NamedTuple):
    """Both torque balances at a common speed, at the restoring dphi.

    Attributes
    ----------
    sum : float
        T_1 + T_2 + L_1 + L_2 [N m].
    moment_1, moment_2, rate_1, rate_2 : float
        L_i and dL_i/d dphi.
    cos, sin : float
        Of dphi.
    reached : bool
        Whether the moments can balance the difference of the torques.
    alpha : complex
        Body rotation over w^2, as a factor of e^(j psi_1).
    """

    sum: float
    moment_1: float
    moment_2: float
    rate_1: float
    rate_2: float
    cos: float
    sin: float
    reached: bool
    alpha: complex


def motors(p: Rows) -> np.recarray[Any, Any]:
    """Return both motors of each of n rows.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).

    Returns
    -------
    recarray, shape (n, 2)
        Each a record with the fields of `Motor`.
    """
    rated = np.stack([p.rated_torque_1, p.rated_torque_2], axis=1)
    synchronous = np.stack([p.synchronous_speed_1, p.synchronous_speed_2], axis=1)
    slip = synchronous - np.stack([p.breakdown_speed_1, p.breakdown_speed_2], axis=1)
    unbalance = np.stack([p.unbalance_1, p.unbalance_2], axis=1)
    power = p.voltage_factor * p.voltage_factor
    return np.rec.fromarrays(
        Motor(
            breakdown=2 * p.overload_capacity[:, None] * rated * slip * power[:, None],
            synchronous=synchronous,
            slip=slip,
            bearing=np.stack([p.bearing_constant_1, p.bearing_constant_2], axis=1) * unbalance,
            inertia=p.rotor_inertia[:, None] + unbalance**2 / p.unbalanced_mass[:, None],
        ),
        dtype=[(name, float) for name in Motor._fields],
    )


@kernel
def kloss(drive, w):
    """Return the torque of a motor at speed w (eq 22, first term)."""
    behind = drive.synchronous - w
    return drive.breakdown * behind / (drive.slip * drive.slip + behind * behind)


@kernel
def torque(drive, w):
    """Return T_i, the torque of a motor less its bearing torque (eq 22)."""
    return kloss(drive, w) - drive.bearing * w * w


@kernel
def moments(a, g, w, cos, sin):
    """Return L_1, L_2 and their rates d/d dphi, from the response `g` of machine `a`."""
    half = 0.5 * w * w * w * w
    both = half * a.unbalance_1 * a.unbalance_2
    return (
        half * a.unbalance_1**2 * g.q_11.imag + both * (g.q_12.imag * cos - g.q_12.real * sin),
        half * a.unbalance_2**2 * g.q_22.imag + both * (g.q_21.imag * cos + g.q_21.real * sin),
        -both * (g.q_12.imag * sin + g.q_12.real * cos),
        both * (g.q_21.real * cos - g.q_21.imag * sin),
    )


@kernel
def balance(a, motor_1, motor_2, w):
    """Return the `Balance` of machine `a` at speed w.

    Where the moments cannot synchronise the motors, dphi is where they come closest to it, which
    makes the sum a continuous function of w.
    """
    g = respond(a, w)
    t1, t2 = torque(motor_1, w), torque(motor_2, w)
    half = 0.5 * w * w * w * w
    both = half * a.unbalance_1 * a.unbalance_2
    own_1 = half * a.unbalance_1 * a.unbalance_1 * g.q_11.imag
    own_2 = half * a.unbalance_2 * a.unbalance_2 * g.q_22.imag
    # (T_1 + L_1) - (T_2 + L_2) = rho (cos(dphi - delta) - near), restoring where the sine is > 0
    in_phase = both * (g.q_12.imag - g.q_21.imag)
    quadrature = -both * (g.q_12.real + g.q_21.real)
    rho = math.sqrt(in_phase * in_phase + quadrature * quadrature)
    needed = ((t2 + own_2) - (t1 + own_1)) / rho
    near = min(1.0, max(-1.0, needed))
    off = math.sqrt((1 - near) * (1 + near))
    cos = (in_phase * near - quadrature * off) / rho
    sin = (quadrature * near + in_phase * off) / rho
    l1, l2, rate_1, rate_2 = moments(a, g, w, cos, sin)
    alpha = a.unbalance_1 * g.alpha_1 + a.unbalance_2 * g.alpha_2 * complex(cos, -sin)
    return Balance(
        (t1 + t2) + (l1 + l2), l1, l2, rate_1, rate_2, cos, sin, abs(needed) <= 1.0, alpha
    )


@kernel
def is_stable(a, motor_1, motor_2, w, at):
    """Whether the solution of I_i psi_i'' = T_i + L_i is stable (Routh); L_i at the mean speed."""
    step = 1e-6 * w
    l1, l2, _, _ = moments(a, respond(a, w + step), w + step, at.cos, at.sin)
    slope_1 = (torque(motor_1, w + step) - torque(motor_1, w)) / step
    slope_2 = (torque(motor_2, w + step) - torque(motor_2, w)) / step
    drag_1, drag_2 = 0.5 * (l1 - at.moment_1) / step, 0.5 * (l2 - at.moment_2) / step
    i1, i2 = motor_1.inertia, motor_2.inertia
    # Jacobian for (psi_1', psi_2', dphi) with third row (1, -1, 0)
    j11, j12, j13 = (slope_1 + drag_1) / i1, drag_1 / i1, at.rate_1 / i1
    j21, j22, j23 = drag_2 / i2, (slope_2 + drag_2) / i2, at.rate_2 / i2
    trace = j11 + j22
    minors = j11 * j22 - j12 * j21 - j13 + j23
    determinant = (j11 + j12) * j23 - (j21 + j22) * j13
    return trace < 0.0 and determinant < 0.0 and -trace * minors > -determinant
