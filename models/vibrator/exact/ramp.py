"""A machine whose inverter raises the synchronous speeds, w_s min(1, t/t_r), at equal slip."""

from models.numerics.jit import inlined
from models.vibrator.equations.rigid import Rigid
from models.vibrator.equations.system import System


@inlined
def ramped(m, t):
    """Return the `System` at time t [s] of a run that begins with `ramp_left` of the ramp to go."""
    r = m.rigid
    left = m.ramp_left - t
    share = 1.0 - left / m.ramp_time if left > 0.0 else 1.0
    return System(
        Rigid(
            r.mass,
            r.moment_x,
            r.moment_y,
            r.inertia,
            r.working_angle,
            r.shaft_x_1,
            r.shaft_y_1,
            r.shaft_x_2,
            r.shaft_y_2,
            r.unbalance_1,
            r.unbalance_2,
            r.mobility_1,
            r.mobility_2,
            r.torque_1,
            r.torque_2,
            share * r.synchronous_speed_1,
            share * r.synchronous_speed_2,
            r.slip_1,
            r.slip_2,
            r.bearing_loss_1,
            r.bearing_loss_2,
            r.stiffness_x,
            r.stiffness_y,
            r.damping_x,
            r.damping_y,
            r.support_offset,
            r.half_spacing,
            r.gravity,
            r.support_lever,
        ),
        m.unbalanced_mass,
        m.rotor_inertia,
        m.body_mass,
        m.body_inertia,
        m.mount_x,
        m.mount_y,
        m.slides,
        m.rocks,
        m.slide_x,
        m.slide_y,
        m.mount_mass,
        m.mount_inertia,
        m.slide_stiffness,
        m.slide_damping,
        m.rock_stiffness,
        m.rock_damping,
        m.feed_mass,
        m.feed_gravity,
        m.feed_position,
        m.exact,
        m.ramp_time,
        m.ramp_left,
        m.torque_lag,
    )
