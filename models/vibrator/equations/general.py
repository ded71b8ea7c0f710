"""The vibrator's equations with exact kinematics, a flexible mount of the motor set, and feed.

All inertia beside that of turning parts is that of mass points: the motor set's centre, the two
unbalanced masses and the feed while it rides. The set slides by u on its mount and turns by chi
about O, the midpoint of the shafts, both relative to the body; a rigid mount keeps its coordinate
at zero. By the principle of virtual work each point adds J^T m J to the mass matrix and -J^T m b
to the forces; J = d(position)/dq, and b is the acceleration that the point has without q''.

The rotors' equations give psi_i'' in terms of the acceleration a of their shafts, as in
`models.vibrator.equations.rigid`: with n the direction of the unbalance and t = dn/dpsi
an unbalanced mass

    m J_zr mu I + (m e)^2 mu n n^T,    mu = 1/(J_zr + m e^2),

rides on the shaft, and m e w^2 n - m e mu Q t pulls at it. That leaves a symmetric system for x, y,
alpha, u and chi, of which the last two are eliminated first.

The feed is a point on the deck, straight right or left of C, free to move vertically. It rides
while the deck pushes it up, flies, and lands without rebound. x, y and alpha are measured from rest
under its weight.
"""

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics.jit import inlined, kernel
from models.numerics.sincos import cosine_sine

DEGREES = 8
"""x, y, alpha, psi_1, psi_2, u, chi and the height of the feed above the deck."""


class _Pose(NamedTuple):
    """How the body stands, seen from C."""

    cos: Any  # of its rotation
    sin: Any
    slide_x: Any  # direction in which the set slides
    slide_y: Any
    set_x: Any  # O
    set_y: Any
    set_cos: Any  # of the set's rotation
    set_sin: Any


class _Vibrator(NamedTuple):
    """An unbalanced mass."""

    n_x: Any  # where it points
    n_y: Any
    t_x: Any  # where it goes
    t_y: Any
    arm_x: Any  # its shaft from O
    arm_y: Any
    xx: Any  # mass that rides on the shaft
    xy: Any
    yy: Any


class _Inertia(NamedTuple):
    """The mass matrix of x, y, alpha, u and chi, eliminated from the end: c for chi."""

    c: Any  # reciprocals of the pivots
    u: Any
    a: Any
    y: Any
    x: Any
    cu: Any  # elements of the rows at the time of their elimination
    ca: Any
    cy: Any
    cx: Any
    ua: Any
    uy: Any
    ux: Any
    ay: Any
    ax: Any
    yx: Any


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
    """Return the state of the rigid machine without feed as one of this machine, feed riding.

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
def _pose(m, alpha, u, chi):
    cos = sin = set_cos = set_sin = 0.0
    if m.exact:
        cos, sin = cosine_sine(alpha)
        set_cos, set_sin = cosine_sine(alpha + chi)
    else:
        cos = set_cos = 1.0
    slide_x = cos * m.slide_x - sin * m.slide_y
    slide_y = sin * m.slide_x + cos * m.slide_y
    return _Pose(
        cos,
        sin,
        slide_x,
        slide_y,
        cos * m.mount_x - sin * m.mount_y + m.exact * u * slide_x,
        sin * m.mount_x + cos * m.mount_y + m.exact * u * slide_y,
        set_cos,
        set_sin,
    )


@inlined
def _vibrator(m, pose, sense, psi, unbalance, mobility, shaft_x, shaft_y):
    theta = m.working_angle + sense * psi
    n_x, n_y = cosine_sine(theta)
    x, y = shaft_x - m.mount_x, shaft_y - m.mount_y
    along = unbalance * unbalance * mobility
    across = m.unbalanced_mass * m.rotor_inertia * mobility
    return _Vibrator(
        n_x,
        n_y,
        -sense * n_y,
        sense * n_x,
        pose.set_cos * x - pose.set_sin * y,
        pose.set_sin * x + pose.set_cos * y,
        across + along * n_x * n_x,
        along * n_x * n_y,
        across + along * n_y * n_y,
    )


@inlined
def _vibrators(m, pose, psi_1, psi_2):
    return (
        _vibrator(m, pose, 1.0, psi_1, m.unbalance_1, m.mobility_1, m.shaft_x_1, m.shaft_y_1),
        _vibrator(m, pose, -1.0, psi_2, m.unbalance_2, m.mobility_2, m.shaft_x_2, m.shaft_y_2),
    )


@inlined
def _inertia(m, pose, one, two, riding):
    """Return the mass matrix, eliminated."""
    o_x, o_y, to_x, to_y = pose.set_x, pose.set_y, pose.slide_x, pose.slide_y
    # How both masses on the shafts resist turning about O, then about C.
    cx_1, cy_1 = one.xy * one.arm_x - one.xx * one.arm_y, one.yy * one.arm_x - one.xy * one.arm_y
    cx_2, cy_2 = two.xy * two.arm_x - two.xx * two.arm_y, two.yy * two.arm_x - two.xy * two.arm_y
    cx, cy = cx_1 + cx_2, cy_1 + cy_2
    cc = m.mount_inertia + one.arm_x * cy_1 - one.arm_y * cx_1 + two.arm_x * cy_2 - two.arm_y * cx_2
    xx, xy, yy = m.mount_mass + one.xx + two.xx, one.xy + two.xy, m.mount_mass + one.yy + two.yy
    ax, ay = cx + xy * o_x - xx * o_y, cy + yy * o_x - xy * o_y
    ca = cc + o_x * cy - o_y * cx
    aa = ca + o_x * ay - o_y * ax + m.body_inertia
    ux, uy, ua = xx * to_x + xy * to_y, xy * to_x + yy * to_y, ax * to_x + ay * to_y
    uu = ux * to_x + uy * to_y + 1 - m.slides
    xx += m.body_mass
    yy += m.body_mass
    if riding:
        reach = pose.cos * m.feed_position
        yy += m.feed_mass
        ay += m.feed_mass * reach
        aa += m.feed_mass * reach * reach
    cx, cy, ca, cc = m.rocks * cx, m.rocks * cy, m.rocks * ca, m.rocks * cc + 1 - m.rocks
    cu = cx * to_x + cy * to_y

    c = 1 / cc
    f_u, f_a, f_y, f_x = c * cu, c * ca, c * cy, c * cx
    uu, ua, uy, ux = uu - f_u * cu, ua - f_u * ca, uy - f_u * cy, ux - f_u * cx
    u = 1 / uu
    g_a, g_y, g_x = u * ua, u * uy, u * ux
    a = 1 / (aa - f_a * ca - g_a * ua)
    ay, ax = ay - f_a * cy - g_a * uy, ax - f_a * cx - g_a * ux
    h_y, h_x = a * ay, a * ax
    y = 1 / (yy - f_y * cy - g_y * uy - h_y * ay)
    yx = xy - f_y * cx - g_y * ux - h_y * ax
    x = 1 / (xx - f_x * cx - g_x * ux - h_x * ax - y * yx * yx)
    return _Inertia(c, u, a, y, x, cu, ca, cy, cx, ua, uy, ux, ay, ax, yx)


@inlined
def _solve(inertia, x, y, a, u, c):
    """Return the accelerations x'', y'', alpha'', u'', chi'' due to generalised forces."""
    c = inertia.c * c
    u = inertia.u * (u - inertia.cu * c)
    a = inertia.a * (a - inertia.ca * c - inertia.ua * u)
    y = inertia.y * (y - inertia.cy * c - inertia.uy * u - inertia.ay * a)
    x = inertia.x * (x - inertia.cx * c - inertia.ux * u - inertia.ax * a - inertia.yx * y)
    y -= inertia.y * inertia.yx * x
    a -= inertia.a * (inertia.ax * x + inertia.ay * y)
    u -= inertia.u * (inertia.ux * x + inertia.uy * y + inertia.ua * a)
    c -= inertia.c * (inertia.cx * x + inertia.cy * y + inertia.ca * a + inertia.cu * u)
    return x, y, a, u, c


@inlined
def _drive(torque, lag, slip, loss, speed, speed_in_bearing):
    """Return Kloss torque less bearing loss (22), (23)."""
    friction = math.copysign(loss * speed * speed, speed_in_bearing)
    return torque * lag / (slip * slip + lag * lag) - friction


@inlined
def _pull(vibrator, unbalance, mobility, drive, speed, bias_x, bias_y):
    """Return the force of an unbalanced mass on a shaft that has the acceleration `bias`."""
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
    h, half = m.support_offset, m.half_spacing
    turned = pose.sin + (1 - m.exact) * alpha
    shrunk = pose.cos - 1
    force_x = -m.stiffness_x * (x + h * turned) - m.damping_x * (vx + h * pose.cos * va)
    force_y = -m.stiffness_y * (y - h * shrunk) - m.damping_y * (vy + h * pose.sin * va)
    # Where one support moves more than the other.
    more_x = m.stiffness_x * shrunk - m.damping_x * pose.sin * va
    more_y = m.stiffness_y * turned + m.damping_y * pose.cos * va
    moment = h * (pose.cos * force_x + pose.sin * force_y)
    return force_x, force_y, moment + half * half * (pose.sin * more_x - pose.cos * more_y)


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
    pose = _pose(m, state[2], state[5], state[6])
    one, two = _vibrators(m, pose, state[3], state[4])
    va, w_1, w_2 = state[DEGREES + 2], state[DEGREES + 3], state[DEGREES + 4]
    slide_speed, set_speed = state[DEGREES + 5], va + state[DEGREES + 6]
    inward = m.exact * va * va
    aside = 2 * m.exact * va * slide_speed
    bias_x = -inward * pose.set_x - aside * pose.slide_y
    bias_y = -inward * pose.set_y + aside * pose.slide_x
    turning = m.exact * set_speed * set_speed
    bias_x_1, bias_y_1 = bias_x - turning * one.arm_x, bias_y - turning * one.arm_y
    bias_x_2, bias_y_2 = bias_x - turning * two.arm_x, bias_y - turning * two.arm_y
    lag_1, lag_2 = m.synchronous_speed_1 - w_1, m.synchronous_speed_2 - w_2
    drive_1 = _drive(m.torque_1, lag_1, m.slip_1, m.bearing_loss_1, w_1, w_1 - set_speed)
    drive_2 = _drive(m.torque_2, lag_2, m.slip_2, m.bearing_loss_2, w_2, w_2 + set_speed)
    x_1, y_1 = _pull(one, m.unbalance_1, m.mobility_1, drive_1, w_1, bias_x_1, bias_y_1)
    x_2, y_2 = _pull(two, m.unbalance_2, m.mobility_2, drive_2, w_2, bias_x_2, bias_y_2)

    force_x = x_1 + x_2 - m.mount_mass * bias_x
    force_y = y_1 + y_2 - m.mount_mass * bias_y
    moment = one.arm_x * y_1 - one.arm_y * x_1 + two.arm_x * y_2 - two.arm_y * x_2
    slide = pose.slide_x * force_x + pose.slide_y * force_y
    slide -= m.slide_stiffness * state[5] + m.slide_damping * slide_speed
    rock = m.rocks * moment
    rock -= m.rock_stiffness * state[6] + m.rock_damping * state[DEGREES + 6]
    moment += pose.set_x * force_y - pose.set_y * force_x
    support_x, support_y, support_moment = _supports(m, pose, state)
    # The supports push up by the weight of the feed even while it flies.
    reach, sunk = m.feed_position * pose.cos, m.feed_position * pose.sin
    push = m.feed_mass * (inward * sunk if riding else m.feed_gravity)
    x, y, a, u, c = _solve(
        _inertia(m, pose, one, two, riding),
        force_x + support_x,
        force_y + support_y + push,
        moment + support_moment + push * reach,
        slide,
        rock,
    )
    # Acceleration of O, then of the shafts.
    set_x = x - a * pose.set_y + u * pose.slide_x
    set_y = y + a * pose.set_x + u * pose.slide_y
    psi_1 = m.mobility_1 * drive_1 + _felt(
        one, m.unbalance_1, m.mobility_1, set_x + bias_x_1, set_y + bias_y_1, a + c
    )
    psi_2 = m.mobility_2 * drive_2 + _felt(
        two, m.unbalance_2, m.mobility_2, set_x + bias_x_2, set_y + bias_y_2, a + c
    )
    height = 0.0 if riding else inward * sunk - m.feed_gravity - y - reach * a
    return Accelerations(x, y, a, psi_1, psi_2, u, c, height)


@inlined
def _felt(vibrator, unbalance, mobility, x, y, turning):
    """Return by how much a rotor feels x'' and y'' of its shaft, which also turns about O."""
    x -= turning * vibrator.arm_y
    y += turning * vibrator.arm_x
    return -mobility * unbalance * (vibrator.t_x * x + vibrator.t_y * y)


@kernel
def support_of_feed(m, state):
    """Return the force of the deck on a feed that rides, over its mass [m s-2]."""
    motion = accelerations(m, True, state)
    angle, spin = m.exact * state[2], m.exact * state[DEGREES + 2]
    turning = math.cos(angle) * motion.alpha - math.sin(angle) * spin * spin
    return m.feed_gravity + motion.y + m.feed_position * turning


@kernel
def land(m, state):
    """End the feed's flight: it keeps to the deck, by a vertical impulse between them.

    Parameters
    ----------
    m : System
    state : ndarray, shape (16,)
        Changed in place.
    """
    pose = _pose(m, state[2], state[5], state[6])
    one, two = _vibrators(m, pose, state[3], state[4])
    impulse = m.feed_mass * state[DEGREES + 7]
    x, y, a, u, c = _solve(
        _inertia(m, pose, one, two, True),
        0.0,
        impulse,
        impulse * m.feed_position * pose.cos,
        0.0,
        0.0,
    )
    set_x = x - a * pose.set_y + u * pose.slide_x
    set_y = y + a * pose.set_x + u * pose.slide_y
    psi_1 = _felt(one, m.unbalance_1, m.mobility_1, set_x, set_y, a + c)
    psi_2 = _felt(two, m.unbalance_2, m.mobility_2, set_x, set_y, a + c)
    jump = (x, y, a, psi_1, psi_2, u, c)
    for i in range(len(jump)):
        state[DEGREES + i] += jump[i]
    state[7] = state[DEGREES + 7] = 0.0
