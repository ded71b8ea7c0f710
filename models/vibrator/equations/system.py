"""The constants of the vibrator's equations, computed once from its parameters.

C is the mass centre of the bare body, the origin of all levers; see `models.vibrator.parameters`.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from models.numerics import elementary
from models.vibrator.equations.rigid import Rigid
from models.vibrator.parameters import Params, Rows
from models.vibrator.theory.averaged import feed_gravity
from models.vibrator.theory.motor_set import MotorSet, damping, motor_set

_NEVER_THROWN = 1e30  # gravity that keeps a massless feed on the deck [m s-2]


class System(NamedTuple):
    """Constants of a machine's equations; n machines if the fields are arrays.

    Attributes
    ----------
    rigid : Rigid
        The same machine with rigid mounts and without feed.
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
    ramp_time, ramp_left : float
        In which an inverter raises the synchronous speeds; how much of it is left [s].
    torque_lag : float
        Time constant of the motor torques [s].
    """

    rigid: Rigid
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
    ramp_time: Any
    ramp_left: Any
    torque_lag: Any

    def row(self, i: int) -> "System":
        """Return one of n machines, its fields floats."""
        rigid, *others = self
        rigid_row = Rigid._make(float(field[i]) for field in rigid)
        return System(rigid_row, *(float(field[i]) for field in others))


def _shafts(p: Rows, motors: MotorSet) -> list[tuple[Any, Any]]:
    """Return the levers (x, y) of both shafts and of their midpoint from C."""
    cos, sin = elementary.cos(p.working_angle), elementary.sin(p.working_angle)
    return [
        (motors.along * cos - across * sin, motors.along * sin + across * cos)
        for across in (p.axis_offset + motors.half, p.axis_offset - motors.half, p.axis_offset)
    ]


def rigid_machines(p: Rows) -> Rigid:
    """Prepare n machines as if their mounts were rigid and the deck empty.

    Parameters
    ----------
    p : Params
        Each field an ndarray of shape (n,).

    Returns
    -------
    Rigid
        Each field an ndarray of shape (n,).
    """
    motors, m = motor_set(p), p.unbalanced_mass
    (x_1, y_1), (x_2, y_2), (x, y) = _shafts(p, motors)
    sprung, power = p.body_mass + 2 * m, p.voltage_factor * p.voltage_factor
    slip_1 = p.synchronous_speed_1 - p.breakdown_speed_1
    slip_2 = p.synchronous_speed_2 - p.breakdown_speed_2
    return Rigid(
        mass=p.body_mass + motors.mass,
        moment_x=motors.mass * x,
        moment_y=motors.mass * y,
        inertia=p.body_inertia + motors.inertia + motors.mass * (x**2 + y**2),
        working_angle=p.working_angle,
        shaft_x_1=x_1,
        shaft_y_1=y_1,
        shaft_x_2=x_2,
        shaft_y_2=y_2,
        unbalance_1=p.unbalance_1,
        unbalance_2=p.unbalance_2,
        mobility_1=1 / (p.rotor_inertia + p.unbalance_1**2 / m),
        mobility_2=1 / (p.rotor_inertia + p.unbalance_2**2 / m),
        torque_1=2 * p.overload_capacity * p.rated_torque_1 * slip_1 * power,
        torque_2=2 * p.overload_capacity * p.rated_torque_2 * slip_2 * power,
        synchronous_speed_1=p.synchronous_speed_1,
        synchronous_speed_2=p.synchronous_speed_2,
        slip_1=slip_1,
        slip_2=slip_2,
        bearing_loss_1=p.bearing_constant_1 * p.unbalance_1,
        bearing_loss_2=p.bearing_constant_2 * p.unbalance_2,
        stiffness_x=p.stiffness_x,
        stiffness_y=p.stiffness_y,
        damping_x=damping(p.damping_ratio, sprung, p.stiffness_x),
        damping_y=damping(p.damping_ratio, sprung, p.stiffness_y),
        support_offset=p.support_offset,
        half_spacing=p.support_half_spacing,
        gravity=p.gravity,
        support_lever=p.support_imbalance * p.support_half_spacing,
    )


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
    motors = motor_set(p)
    mount_x, mount_y = _shafts(p, motors)[2]
    slides, rocks = np.isfinite(p.mount_stiffness), np.isfinite(p.mount_rotational_stiffness)
    slide_stiffness = np.where(slides, p.mount_stiffness, 0.0)
    rock_stiffness = np.where(rocks, p.mount_rotational_stiffness, 0.0)
    direction = p.working_angle + p.mount_angle
    return System(
        rigid=rigid_machines(p),
        unbalanced_mass=p.unbalanced_mass,
        rotor_inertia=p.rotor_inertia,
        body_mass=p.body_mass,
        body_inertia=p.body_inertia,
        mount_x=mount_x,
        mount_y=mount_y,
        slides=slides.astype(float),
        rocks=rocks.astype(float),
        slide_x=slides * elementary.cos(direction),
        slide_y=slides * elementary.sin(direction),
        mount_mass=p.mount_mass,
        mount_inertia=p.mount_inertia,
        slide_stiffness=slide_stiffness,
        slide_damping=damping(p.mount_damping_ratio, motors.mass, slide_stiffness),
        rock_stiffness=rock_stiffness,
        rock_damping=damping(p.mount_damping_ratio, motors.inertia, rock_stiffness),
        feed_mass=p.feed_mass,
        feed_gravity=_gravity(p),
        feed_position=p.feed_position,
        exact=np.full_like(p.unbalanced_mass, kinematics == "exact"),
        ramp_time=p.ramp_time,
        ramp_left=p.ramp_time,
        torque_lag=p.torque_lag,
    )


def _gravity(p: Rows) -> NDArray[np.float64]:
    """Return the gravity of the feed; for a massless one so large that it never takes off."""
    loaded = p.feed_mass > 0
    gravity = np.full(len(loaded), _NEVER_THROWN)
    if loaded.any():
        gravity[loaded] = feed_gravity(Params._make(field[loaded] for field in p))
    return gravity


def system(params: Params, kinematics: str = "small") -> System:
    """Prepare one machine; see `systems`."""
    return systems(Params._make(np.array([v], float) for v in params), kinematics).row(0)
