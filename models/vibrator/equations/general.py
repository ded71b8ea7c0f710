"""The vibrator's equations with exact kinematics, a flexible mount of the motor set, and feed.

Apart from rotary inertia, all inertia is that of point masses: the motor set's centre, the two
unbalanced masses and the feed while it rides. The set slides by u on its mount and turns by chi
about O, the midpoint of the shafts, both relative to the body; a rigid mount keeps its coordinate
at zero. By the principle of virtual work each point adds J^T m J to the mass matrix and -J^T m b to
the forces; J = d(position)/dq, and b is the acceleration of the point at q'' = 0.

The rotors' equations give psi_i'' in terms of the acceleration a of their shafts, as in
`models.vibrator.equations.rigid`: with n the direction of the unbalance and t = dn/dpsi
an unbalanced mass

    m J_zr mu I + (m e)^2 mu n n^T,    mu = 1/(J_zr + m e^2),

rides on the shaft, and the force m e w^2 n - m e mu Q t pulls at it. That leaves a symmetric system
for x, y, alpha, u and chi, of which the last two are eliminated first.

The feed is a point mass on the deck, level with C, free to move vertically. It rides while the deck
pushes it up, flies, and lands without rebound. x, y, alpha and u are measured from equilibrium
under all weights, which springs carry wherever the body moves; only the unbalances swing under
gravity, as in `models.vibrator.equations.rigid_motion`.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.jit import inlined, kernel
from models.vibrator.equations.geometry import posed, vibrators
from models.vibrator.equations.mass_matrix import factorised, solve

DEGREES = 8
"""x, y, alpha, psi_1, psi_2, u, chi and the height of the feed above the deck."""


class Accelerations(NamedTuple):
    """Second derivatives of the degrees of freedom, in their order."""

    x: Any
    y: Any
    alpha: Any
    psi_1: Any
    psi_2: Any
    u: Any
    chi: Any
    height: Any


def extend(state: NDArray[np.float64]) -> NDArray[np.float64]:
    """Extend a state of the rigid machine without feed to this machine, with the feed riding.

    Parameters
    ----------
    state : ndarray, shape (10,)

    Returns
    -------
    ndarray, shape (16,)
    """
    longer = np.zeros(2 * DEGREES)
    longer[:5], longer[DEGREES : DEGREES + 5] = state[:5], state[5:]
    return longer


@inlined
def _drive(torque, lag, slip, loss, speed, speed_in_bearing):
    """Return Kloss torque less bearing loss (22), (23)."""
    friction = math.copysign(loss * speed * speed, speed_in_bearing)
    return torque * lag / (slip * slip + lag * lag) - friction


@inlined
def _pull(vibrator, unbalance, mobility, drive, speed, bias_x, bias_y):
    """Return the force of an unbalanced mass on a shaft whose acceleration is `bias`."""
    out, back = unbalance * speed * speed, unbalance * mobility * drive
    return (
        out * vibrator.n_x - back * vibrator.t_x - vibrator.xx * bias_x - vibrator.xy * bias_y,
        out * vibrator.n_y - back * vibrator.t_y - vibrator.xy * bias_x - vibrator.yy * bias_y,
    )


@inlined
def _supports(m, pose, state):
    """Return the force of both supports on the body, and its moment about C."""
    x, y, alpha = state[0], state[1], state[2]
    vx, vy, va = state[DEGREES], state[DEGREES + 1], state[DEGREES + 2]
    r = m.rigid
    h, half = r.support_offset, r.half_spacing
    turned = pose.sin + (1 - m.exact) * alpha
    shrunk = pose.cos - 1
    force_x = -r.stiffness_x * (x + h * turned) - r.damping_x * (vx + h * pose.cos * va)
    force_y = -r.stiffness_y * (y - h * shrunk) - r.damping_y * (vy + h * pose.sin * va)
    # The supports move by different amounts.
    more_x = r.stiffness_x * shrunk - r.damping_x * pose.sin * va
    more_y = r.stiffness_y * turned + r.damping_y * pose.cos * va
    both_x, both_y = force_x - r.support_lever * more_x, force_y - r.support_lever * more_y
    moment = h * (pose.cos * both_x + pose.sin * both_y)
    moment += half * half * (pose.sin * more_x - pose.cos * more_y)
    # The support on the right carries more of the forces common to both, by the imbalance.
    moment += r.support_lever * (pose.cos * force_y - pose.sin * force_x)
    return both_x, both_y, moment


@kernel
def accelerations(m, riding, state):
    """Return the `Accelerations`.

    Parameters
    ----------
    m : System
    riding : bool
        Whether the feed lies on the deck.
    state : ndarray, shape (16,)
    """
    r, pose = m.rigid, posed(m, state[2], state[5], state[6])
    v_1, v_2 = vibrators(m, pose, state[3], state[4])
    va, w_1, w_2 = state[DEGREES + 2], state[DEGREES + 3], state[DEGREES + 4]
    slide_speed, set_speed = state[DEGREES + 5], va + state[DEGREES + 6]
    inward = m.exact * va * va
    aside = 2 * m.exact * va * slide_speed
    bias_x = -inward * pose.set_x - aside * pose.slide_y
    bias_y = -inward * pose.set_y + aside * pose.slide_x
    turning = m.exact * set_speed * set_speed
    bias_x_1, bias_y_1 = bias_x - turning * v_1.arm_x, bias_y - turning * v_1.arm_y
    bias_x_2, bias_y_2 = bias_x - turning * v_2.arm_x, bias_y - turning * v_2.arm_y
    lag_1, lag_2 = r.synchronous_speed_1 - w_1, r.synchronous_speed_2 - w_2
    drive_1 = _drive(r.torque_1, lag_1, r.slip_1, r.bearing_loss_1, w_1, w_1 - set_speed)
    drive_2 = _drive(r.torque_2, lag_2, r.slip_2, r.bearing_loss_2, w_2, w_2 + set_speed)
    drive_1 -= r.gravity * r.unbalance_1 * v_1.n_x
    drive_2 += r.gravity * r.unbalance_2 * v_2.n_x
    x_1, y_1 = _pull(v_1, r.unbalance_1, r.mobility_1, drive_1, w_1, bias_x_1, bias_y_1)
    x_2, y_2 = _pull(v_2, r.unbalance_2, r.mobility_2, drive_2, w_2, bias_x_2, bias_y_2)

    force_x = x_1 + x_2 - m.mount_mass * bias_x
    force_y = y_1 + y_2 - m.mount_mass * bias_y
    moment = v_1.arm_x * y_1 - v_1.arm_y * x_1 + v_2.arm_x * y_2 - v_2.arm_y * x_2
    slide = pose.slide_x * force_x + pose.slide_y * force_y
    slide -= m.slide_stiffness * state[5] + m.slide_damping * slide_speed
    rock = m.rocks * moment
    rock -= m.rock_stiffness * state[6] + m.rock_damping * state[DEGREES + 6]
    moment += pose.set_x * force_y - pose.set_y * force_x
    support_x, support_y, support_moment = _supports(m, pose, state)
    # The supports carry the static weight of the feed even while it flies.
    reach, sunk = m.feed_position * pose.cos, m.feed_position * pose.sin
    push = m.feed_mass * (inward * sunk if riding else m.feed_gravity)
    x, y, a, u, c = solve(
        factorised(m, pose, v_1, v_2, riding),
        force_x + support_x,
        force_y + support_y + push,
        moment + support_moment + push * reach,
        slide,
        rock,
    )
    # Acceleration of O, then of the shafts.
    set_x = x - a * pose.set_y + u * pose.slide_x
    set_y = y + a * pose.set_x + u * pose.slide_y
    psi_1 = r.mobility_1 * drive_1 + _felt(
        v_1, r.unbalance_1, r.mobility_1, set_x + bias_x_1, set_y + bias_y_1, a + c
    )
    psi_2 = r.mobility_2 * drive_2 + _felt(
        v_2, r.unbalance_2, r.mobility_2, set_x + bias_x_2, set_y + bias_y_2, a + c
    )
    height = 0.0 if riding else inward * sunk - m.feed_gravity - y - reach * a
    return Accelerations(x, y, a, psi_1, psi_2, u, c, height)


@inlined
def _felt(vibrator, unbalance, mobility, x, y, turning):
    """Return the effect of x'' and y'' of the shaft, and of its turning about O, on a rotor."""
    x -= turning * vibrator.arm_y
    y += turning * vibrator.arm_x
    return -mobility * unbalance * (vibrator.t_x * x + vibrator.t_y * y)


@kernel
def support_of_feed(m, state):
    """Return the force of the deck on a riding feed, over its mass [m s-2]."""
    motion = accelerations(m, True, state)
    angle, spin = m.exact * state[2], m.exact * state[DEGREES + 2]
    turning = math.cos(angle) * motion.alpha - math.sin(angle) * spin * spin
    return m.feed_gravity + motion.y + m.feed_position * turning


@kernel
def land(m, state):
    """End the feed's flight: a vertical impulse between feed and deck equalises their velocities.

    Parameters
    ----------
    m : System
    state : ndarray, shape (16,)
        Changed in place.
    """
    r, pose = m.rigid, posed(m, state[2], state[5], state[6])
    v_1, v_2 = vibrators(m, pose, state[3], state[4])
    impulse = m.feed_mass * state[DEGREES + 7]
    x, y, a, u, c = solve(
        factorised(m, pose, v_1, v_2, True),
        0.0,
        impulse,
        impulse * m.feed_position * pose.cos,
        0.0,
        0.0,
    )
    set_x = x - a * pose.set_y + u * pose.slide_x
    set_y = y + a * pose.set_x + u * pose.slide_y
    psi_1 = _felt(v_1, r.unbalance_1, r.mobility_1, set_x, set_y, a + c)
    psi_2 = _felt(v_2, r.unbalance_2, r.mobility_2, set_x, set_y, a + c)
    jump = (x, y, a, psi_1, psi_2, u, c)
    for i in range(len(jump)):
        state[DEGREES + i] += jump[i]
    state[7] = state[DEGREES + 7] = 0.0
