"""Positions of the body, motor set and unbalanced masses of the general machine, from C."""

from typing import Any, NamedTuple

from models.numerics.jit import inlined
from models.numerics.sincos import cosine_sine


class Pose(NamedTuple):
    """The pose of the body and of the motor set, relative to C."""

    cos: Any  # of its rotation
    sin: Any
    slide_x: Any  # direction in which the motor set slides
    slide_y: Any
    set_x: Any  # O
    set_y: Any
    set_cos: Any  # of the set's rotation
    set_sin: Any


class Vibrator(NamedTuple):
    """An unbalanced mass."""

    n_x: Any  # its direction
    n_y: Any
    t_x: Any  # its direction of motion
    t_y: Any
    arm_x: Any  # its shaft from O
    arm_y: Any
    xx: Any  # mass that rides on the shaft
    xy: Any
    yy: Any


@inlined
def posed(m, alpha, u, chi):
    """Return the `Pose` at rotation alpha, slide u and turn chi of the motor set.

    Parameters
    ----------
    m : System
    alpha, u, chi : float
        [rad, m, rad]
    """
    cos = sin = set_cos = set_sin = 0.0
    if m.exact:
        cos, sin = cosine_sine(alpha)
        set_cos, set_sin = cosine_sine(alpha + chi)
    else:
        cos = set_cos = 1.0
    slide_x = cos * m.slide_x - sin * m.slide_y
    slide_y = sin * m.slide_x + cos * m.slide_y
    return Pose(
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
    theta = m.rigid.working_angle + sense * psi
    n_x, n_y = cosine_sine(theta)
    x, y = shaft_x - m.mount_x, shaft_y - m.mount_y
    along = unbalance * unbalance * mobility
    across = m.unbalanced_mass * m.rotor_inertia * mobility
    return Vibrator(
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
def vibrators(m, pose, psi_1, psi_2):
    """Return each `Vibrator` of a machine in a pose, at the angles psi_1 and psi_2 [rad]."""
    r = m.rigid
    return (
        _vibrator(
            m,
            pose,
            1.0,
            psi_1,
            r.unbalance_1,
            r.mobility_1,
            r.shaft_x_1,
            r.shaft_y_1,
        ),
        _vibrator(
            m,
            pose,
            -1.0,
            psi_2,
            r.unbalance_2,
            r.mobility_2,
            r.shaft_x_2,
            r.shaft_y_2,
        ),
    )
