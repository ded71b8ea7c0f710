"""The vibrator's equations with exact kinematics, a flexible mount of the motor set, and feed.

All inertia beside that of turning parts is that of mass points: the motor set's centre, the two
unbalanced masses and the feed while it rides. Each is described by what moves it, d(position)/dq,
and by the acceleration it has without q''; by the principle of virtual work the equations are
sums over these points. The set slides by u on its mount and turns by chi about O, the
midpoint of the shafts, both relative to the body; a rigid mount keeps its coordinate at zero.

The feed is a point on the deck, straight right or left of C, free to move vertically. It rides
while the deck pushes it up, flies, and lands without rebound. x, y and alpha are measured from rest
under its weight.
"""

import math

import numpy as np
from numpy.typing import NDArray

from models.numerics.jit import kernel

DEGREES = 8
"""x, y, alpha, psi_1, psi_2, u, chi and the height of the feed above the deck."""

_BODY = 7  # degrees of freedom that are solved for together
_MATRIX, _FORCE, _TO_X, _TO_Y, ROWS = 0, 7, 8, 9, 10


def workspace() -> NDArray[np.float64]:
    """Return the work array that the kernels of this module need."""
    return np.empty((ROWS, _BODY))


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


@kernel
def _lever(work, x, y):
    """Begin a point of the body at (x, y) from C: how x, y and alpha move it."""
    work[_TO_X] = 0.0
    work[_TO_Y] = 0.0
    work[_TO_X, 0] = work[_TO_Y, 1] = 1.0
    work[_TO_X, 2], work[_TO_Y, 2] = -y, x


@kernel
def _add_point(work, mass, bias_x, bias_y):
    """Add the point begun, which has the acceleration `bias` without q''."""
    for i in range(_BODY):
        to_x, to_y = mass * work[_TO_X, i], mass * work[_TO_Y, i]
        work[_FORCE, i] -= to_x * bias_x + to_y * bias_y
        for j in range(i + 1):
            work[i, j] += to_x * work[_TO_X, j] + to_y * work[_TO_Y, j]


@kernel
def _torque(torque, lag, slip, loss, speed, speed_in_bearing):
    """Return Kloss torque less bearing loss (22), (23)."""
    friction = math.copysign(loss * speed * speed, speed_in_bearing)
    return torque * lag / (slip * slip + lag * lag) - friction


@kernel
def _add_supports(m, state, cos, sin, work):
    for side in (-1.0, 1.0):
        x, y = side * m.half_spacing, -m.support_offset
        to_x, to_y = cos * x - sin * y, sin * x + cos * y
        turned = (1 - m.exact) * state[2]
        dx = state[0] + to_x - x - turned * y
        dy = state[1] + to_y - y + turned * x
        vx = state[DEGREES] - state[DEGREES + 2] * to_y
        vy = state[DEGREES + 1] + state[DEGREES + 2] * to_x
        force_x = -0.5 * (m.stiffness_x * dx + m.damping_x * vx)
        force_y = -0.5 * (m.stiffness_y * dy + m.damping_y * vy)
        work[_FORCE, 0] += force_x
        work[_FORCE, 1] += force_y
        work[_FORCE, 2] += to_x * force_y - to_y * force_x


@kernel
def _add_vibrator(m, state, which, sense, set_x, set_y, slide_x, slide_y, bias_x, bias_y, work):
    """Add an unbalanced mass and its rotor to the set, which is at (set_x, set_y) from C."""
    first = which == 3
    me = m.unbalance_1 if first else m.unbalance_2
    e = me / m.unbalanced_mass
    theta = m.working_angle + sense * state[which]
    c, s = math.cos(theta), math.sin(theta)
    w = state[DEGREES + which]
    turned = m.exact * (state[2] + state[6])
    cos, sin = math.cos(turned), math.sin(turned)
    x = (m.shaft_x_1 if first else m.shaft_x_2) - m.mount_x
    y = (m.shaft_y_1 if first else m.shaft_y_2) - m.mount_y
    to_x, to_y = cos * x - sin * y, sin * x + cos * y
    set_speed = state[DEGREES + 2] + state[DEGREES + 6]
    inward = m.exact * set_speed * set_speed

    _lever(work, set_x + to_x, set_y + to_y)
    work[_TO_X, which], work[_TO_Y, which] = -sense * e * s, sense * e * c
    work[_TO_X, 5], work[_TO_Y, 5] = slide_x, slide_y
    work[_TO_X, 6], work[_TO_Y, 6] = -m.rocks * to_y, m.rocks * to_x
    _add_point(
        work,
        m.unbalanced_mass,
        bias_x - inward * to_x - e * w * w * c,
        bias_y - inward * to_y - e * w * w * s,
    )
    work[which, which] += m.rotor_inertia
    work[_FORCE, which] += _torque(
        m.torque_1 if first else m.torque_2,
        (m.synchronous_speed_1 if first else m.synchronous_speed_2) - w,
        m.slip_1 if first else m.slip_2,
        m.bearing_loss_1 if first else m.bearing_loss_2,
        w,
        w - sense * set_speed,
    )


@kernel
def _assemble(m, riding, state, work):
    """Set the lower half of the mass matrix, and the forces."""
    work[: _FORCE + 1] = 0.0
    angle, spin = m.exact * state[2], m.exact * state[DEGREES + 2]
    cos, sin = math.cos(angle), math.sin(angle)
    work[0, 0] = work[1, 1] = m.body_mass
    work[2, 2] = m.body_inertia + m.mount_inertia
    work[6, 2] = m.rocks * m.mount_inertia
    work[5, 5] = 1 - m.slides
    work[6, 6] = 1 - m.rocks + m.rocks * m.mount_inertia
    _add_supports(m, state, cos, sin, work)

    u, slide_speed = state[5], state[DEGREES + 5]
    slide_x = cos * m.slide_x - sin * m.slide_y
    slide_y = sin * m.slide_x + cos * m.slide_y
    set_x = cos * m.mount_x - sin * m.mount_y + m.exact * u * slide_x
    set_y = sin * m.mount_x + cos * m.mount_y + m.exact * u * slide_y
    bias_x = -spin * spin * set_x - 2 * spin * slide_speed * slide_y
    bias_y = -spin * spin * set_y + 2 * spin * slide_speed * slide_x
    _lever(work, set_x, set_y)
    work[_TO_X, 5], work[_TO_Y, 5] = slide_x, slide_y
    _add_point(work, m.mount_mass, bias_x, bias_y)
    _add_vibrator(m, state, 3, 1.0, set_x, set_y, slide_x, slide_y, bias_x, bias_y, work)
    _add_vibrator(m, state, 4, -1.0, set_x, set_y, slide_x, slide_y, bias_x, bias_y, work)
    work[_FORCE, 5] -= m.slide_stiffness * u + m.slide_damping * slide_speed
    work[_FORCE, 6] -= m.rock_stiffness * state[6] + m.rock_damping * state[DEGREES + 6]

    # The supports push up by the weight of the feed even while it flies.
    weight = m.feed_mass * m.feed_gravity
    if riding:
        _lever(work, cos * m.feed_position, sin * m.feed_position)
        work[_TO_X] = 0.0
        _add_point(work, m.feed_mass, 0.0, -spin * spin * sin * m.feed_position)
    else:
        work[_FORCE, 1] += weight
        work[_FORCE, 2] += weight * cos * m.feed_position


@kernel
def _solve(work):
    """Solve for the accelerations, in place of the forces, by the factors L D L^T."""
    for j in range(_BODY):
        for i in range(j + 1, _BODY):
            factor = work[i, j] / work[j, j]
            for k in range(j + 1, i + 1):
                work[i, k] -= factor * work[k, j]
            work[_FORCE, i] -= factor * work[_FORCE, j]
    for i in range(_BODY - 1, -1, -1):
        for j in range(i + 1, _BODY):
            work[_FORCE, i] -= work[j, i] * work[_FORCE, j]
        work[_FORCE, i] /= work[i, i]


@kernel
def deck_acceleration(m, riding, state, work):
    """Return the vertical acceleration of the deck under the feed [m s-2].

    Parameters
    ----------
    m : System
    riding : bool
        Whether the feed lies on the deck.
    state : ndarray, shape (16,)
    work : ndarray
        See `workspace`.
    """
    _assemble(m, riding, state, work)
    _solve(work)
    angle, spin = m.exact * state[2], m.exact * state[DEGREES + 2]
    turning = math.cos(angle) * work[_FORCE, 2] - math.sin(angle) * spin * spin
    return work[_FORCE, 1] + m.feed_position * turning


@kernel
def acceleration(m, riding, state, work, out):
    """Set out[:8] to the accelerations; see `deck_acceleration`."""
    deck = deck_acceleration(m, riding, state, work)
    for i in range(_BODY):
        out[i] = work[_FORCE, i]
    out[7] = 0.0 if riding else -m.feed_gravity - deck


@kernel
def land(m, state, work):
    """End the feed's flight: it keeps to the deck, by a vertical impulse between them.

    Parameters
    ----------
    m : System
    state : ndarray, shape (16,)
        Changed in place.
    work : ndarray
    """
    impulse = m.feed_mass * state[DEGREES + 7]
    _assemble(m, True, state, work)
    work[_FORCE] = 0.0
    work[_FORCE, 1] = impulse
    work[_FORCE, 2] = impulse * m.feed_position * math.cos(m.exact * state[2])
    _solve(work)
    for i in range(_BODY):
        state[DEGREES + i] += work[_FORCE, i]
    state[7] = state[DEGREES + 7] = 0.0
