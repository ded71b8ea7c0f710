"""The vibrator as its equations see it: what they need of a machine, computed once.

C is the mass centre of the bare body, the origin of all levers; see `models.vibrator.parameters`.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics import elementary
from models.vibrator.parameters import Params, Rows
from models.vibrator.theory.averaged import feed_gravity

_NEVER_THROWN = 1e30  # gravity that keeps a feed without mass on the deck [m s-2]


class System(NamedTuple):
    """What the equations need of a machine, computed once; n machines if the fields are arrays.

    Attributes
    ----------
    mass, moment_x, moment_y, inertia : float
        Of all that moves with the body about C, unbalanced masses at their shafts: M [kg],
        sum of m s [kg m], J [kg m2].
    working_angle : float
        beta [rad]
    shaft_x_1, shaft_y_1, shaft_x_2, shaft_y_2 : float
        s_1, s_2 [m]
    unbalance_1, unbalance_2 : float
        m e_1, m e_2 [kg m]
    mobility_1, mobility_2 : float
        1/(J_zr + m e_i^2) [kg-1 m-2]
    torque_1, torque_2 : float
        2 p M_zn (w_s - w_u), of (22) [N m rad s-1]
    synchronous_speed_1, synchronous_speed_2 : float
        w_s [rad s-1]
    slip_1, slip_2 : float
        w_s - w_u [rad s-1]
    bearing_loss_1, bearing_loss_2 : float
        rho m e_i [kg m2]
    stiffness_x, stiffness_y, damping_x, damping_y : float
        k_x, k_y [N m-1], b_x, b_y [N s m-1]
    support_offset, half_spacing : float
        h, l [m]
    unbalanced_mass, rotor_inertia : float
        m [kg], J_zr [kg m2]
    body_mass, body_inertia : float
        Without motor set and unbalanced masses [kg, kg m2].
    mount_x, mount_y : float
        O, the midpoint of the shafts [m].
    slides, rocks : float
        1 if the motor set can move along its mount's direction, or turn about O, else 0.
    slide_x, slide_y : float
        Unit vector of that direction, 0 if it cannot.
    mount_mass, mount_inertia : float
        Of the motor set without unbalanced masses [kg, kg m2].
    slide_stiffness, slide_damping, rock_stiffness, rock_damping : float
        [N m-1, N s m-1, N m, N m s], 0 if rigid.
    feed_mass, feed_gravity, feed_position : float
        [kg, m s-2, m]
    exact : float
        1 for exact kinematics, 0 for the geometry at alpha = 0.
    """

    mass: Any
    moment_x: Any
    moment_y: Any
    inertia: Any
    working_angle: Any
    shaft_x_1: Any
    shaft_y_1: Any
    shaft_x_2: Any
    shaft_y_2: Any
    unbalance_1: Any
    unbalance_2: Any
    mobility_1: Any
    mobility_2: Any
    torque_1: Any
    torque_2: Any
    synchronous_speed_1: Any
    synchronous_speed_2: Any
    slip_1: Any
    slip_2: Any
    bearing_loss_1: Any
    bearing_loss_2: Any
    stiffness_x: Any
    stiffness_y: Any
    damping_x: Any
    damping_y: Any
    support_offset: Any
    half_spacing: Any
    unbalanced_mass: Any
    rotor_inertia: Any
    body_mass: Any
    body_inertia: Any
    mount_x: Any
    mount_y: Any
    slides: Any
    rocks: Any
    slide_x: Any
    slide_y: Any
    mount_mass: Any
    mount_inertia: Any
    slide_stiffness: Any
    slide_damping: Any
    rock_stiffness: Any
    rock_damping: Any
    feed_mass: Any
    feed_gravity: Any
    feed_position: Any
    exact: Any

    def row(self, i: int) -> "System":
        """Return one of n machines, its fields floats."""
        return System._make(float(field[i]) for field in self)


def systems(p: Rows, kinematics: str = "small") -> System:
    """Prepare n machines.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).
    kinematics : {"small", "exact"}

    Returns
    -------
    System
        Each field an ndarray of shape (n,).
    """
    cos, sin = elementary.cos(p.working_angle), elementary.sin(p.working_angle)
    along = p.shaft_distance * elementary.cos(p.shaft_half_angle)
    half = p.shaft_distance * elementary.sin(p.shaft_half_angle)
    levers = [
        (along * cos - across * sin, along * sin + across * cos)
        for across in (p.axis_offset + half, p.axis_offset - half, p.axis_offset)
    ]
    (x_1, y_1), (x_2, y_2), (x_0, y_0) = levers
    m = p.unbalanced_mass
    set_mass, set_inertia = p.mount_mass + 2 * m, p.mount_inertia + 2 * m * half**2
    sprung = p.body_mass + 2 * m
    slides, rocks = np.isfinite(p.mount_stiffness), np.isfinite(p.mount_rotational_stiffness)
    slide_stiffness = np.where(slides, p.mount_stiffness, 0.0)
    rock_stiffness = np.where(rocks, p.mount_rotational_stiffness, 0.0)
    direction = p.working_angle + p.mount_angle
    slip_1 = p.synchronous_speed_1 - p.breakdown_speed_1
    slip_2 = p.synchronous_speed_2 - p.breakdown_speed_2
    return System(
        mass=p.body_mass + set_mass,
        moment_x=set_mass * x_0,
        moment_y=set_mass * y_0,
        inertia=p.body_inertia + set_inertia + set_mass * (x_0**2 + y_0**2),
        working_angle=p.working_angle,
        shaft_x_1=x_1,
        shaft_y_1=y_1,
        shaft_x_2=x_2,
        shaft_y_2=y_2,
        unbalance_1=p.unbalance_1,
        unbalance_2=p.unbalance_2,
        mobility_1=1 / (p.rotor_inertia + p.unbalance_1**2 / m),
        mobility_2=1 / (p.rotor_inertia + p.unbalance_2**2 / m),
        torque_1=2 * p.overload_capacity * p.rated_torque_1 * slip_1,
        torque_2=2 * p.overload_capacity * p.rated_torque_2 * slip_2,
        synchronous_speed_1=p.synchronous_speed_1,
        synchronous_speed_2=p.synchronous_speed_2,
        slip_1=slip_1,
        slip_2=slip_2,
        bearing_loss_1=p.bearing_constant_1 * p.unbalance_1,
        bearing_loss_2=p.bearing_constant_2 * p.unbalance_2,
        stiffness_x=p.stiffness_x,
        stiffness_y=p.stiffness_y,
        damping_x=2 * p.damping_ratio * np.sqrt(sprung * p.stiffness_x),
        damping_y=2 * p.damping_ratio * np.sqrt(sprung * p.stiffness_y),
        support_offset=p.support_offset,
        half_spacing=p.support_half_spacing,
        unbalanced_mass=m,
        rotor_inertia=p.rotor_inertia,
        body_mass=p.body_mass,
        body_inertia=p.body_inertia,
        mount_x=x_0,
        mount_y=y_0,
        slides=slides.astype(float),
        rocks=rocks.astype(float),
        slide_x=slides * elementary.cos(direction),
        slide_y=slides * elementary.sin(direction),
        mount_mass=p.mount_mass,
        mount_inertia=p.mount_inertia,
        slide_stiffness=slide_stiffness,
        slide_damping=2 * p.mount_damping_ratio * np.sqrt(slide_stiffness * set_mass),
        rock_stiffness=rock_stiffness,
        rock_damping=2 * p.mount_damping_ratio * np.sqrt(rock_stiffness * set_inertia),
        feed_mass=p.feed_mass,
        feed_gravity=_gravity(p),
        feed_position=p.feed_position,
        exact=np.full_like(m, kinematics == "exact"),
    )


def _gravity(p: Rows) -> NDArray[np.float64]:
    """Return the gravity of the feed; so large that what has no mass never takes off."""
    loaded = p.feed_mass > 0
    gravity = np.full(len(loaded), _NEVER_THROWN)
    if loaded.any():
        gravity[loaded] = feed_gravity(Params._make(field[loaded] for field in p))
    return gravity


def system(params: Params, kinematics: str = "small") -> System:
    """Prepare one machine; see `systems`."""
    return systems(Params._make(np.array([v], float) for v in params), kinematics).row(0)
