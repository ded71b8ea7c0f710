"""The machine with its motors bolted to the body: its constants and accelerations.

Straight-line algebra for every integrator of (13) to (23), of one machine or sixteen at a time. The
rotors' equations (16), (17) give their accelerations in terms of the body's, which leaves a
symmetric 3 x 3 system S a = f for the body, a = (x'', y'', alpha'').

With e_i = (-sin theta_i, cos theta_i, g_i), m e_i times it is the inertia that couples rotor i and
body, with opposite sign for the clockwise vibrator 2; n_i = (cos theta_i, sin theta_i, h_i) is the
direction of its centrifugal force, and e_i = dn_i/dtheta_i.
"""

from typing import Any, NamedTuple

from models.numerics.fma import fma
from models.numerics.jit import inlined


class Rigid(NamedTuple):
    """Constants of the rigid machine's equations; n machines if the fields are arrays.

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
    gravity : float
        g [m s-2]
    support_lever : float
        l (k_R - k_L)/(k_R + k_L), by which the support on the right carries more [m]
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
    gravity: Any
    support_lever: Any


class Motion(NamedTuple):
    """Accelerations x'', y'' [m s-2], alpha'', psi_1'', psi_2'' [rad s-2]."""

    x: Any
    y: Any
    alpha: Any
    psi_1: Any
    psi_2: Any


@inlined
def accelerations(m, c_1, s_1, c_2, s_2, x, y, alpha, vx, vy, va, w_1, w_2):
    """Return the `Motion` of a machine; all divisions are merged into one.

    Parameters
    ----------
    m : Rigid
        Or any other tuple with its fields.
    c_1, s_1, c_2, s_2 : float
        Cosine and sine of theta_1 = beta + psi_1, theta_2 = beta - psi_2.
    x, y, alpha, vx, vy, va, w_1, w_2 : float
        Displacement of C, rotation, their rates, and speeds of the vibrators.

    Returns
    -------
    Motion
    """
    g_1 = fma(m.shaft_x_1, c_1, m.shaft_y_1 * s_1)
    g_2 = fma(m.shaft_x_2, c_2, m.shaft_y_2 * s_2)
    h_1 = fma(m.shaft_x_1, s_1, -m.shaft_y_1 * c_1)
    h_2 = fma(m.shaft_x_2, s_2, -m.shaft_y_2 * c_2)
    r_1, r_2 = m.unbalance_1 * m.mobility_1, m.unbalance_2 * m.mobility_2
    f_1, f_2 = m.unbalance_1 * r_1, m.unbalance_2 * r_2
    s_xx = fma(-f_2 * s_2, s_2, fma(-f_1 * s_1, s_1, m.mass))
    s_xy = fma(f_1 * s_1, c_1, f_2 * s_2 * c_2)
    s_yy = fma(-f_2 * c_2, c_2, fma(-f_1 * c_1, c_1, m.mass))
    s_xa = fma(f_1 * s_1, g_1, f_2 * s_2 * g_2) - m.moment_y
    s_ya = fma(-f_2 * c_2, g_2, fma(-f_1 * c_1, g_1, m.moment_x))
    s_aa = fma(-f_2 * g_2, g_2, fma(-f_1 * g_1, g_1, m.inertia))
    # Cofactors.
    b_xx = fma(s_yy, s_aa, -s_ya * s_ya)
    b_xy = fma(s_xa, s_ya, -s_xy * s_aa)
    b_xa = fma(s_xy, s_ya, -s_xa * s_yy)
    b_yy = fma(s_xx, s_aa, -s_xa * s_xa)
    b_ya = fma(s_xy, s_xa, -s_xx * s_ya)
    b_aa = fma(s_xx, s_yy, -s_xy * s_xy)
    determinant = fma(s_xa, b_xa, fma(s_xx, b_xx, s_xy * b_xy))
    lag_1, lag_2 = m.synchronous_speed_1 - w_1, m.synchronous_speed_2 - w_2
    d_1, d_2 = fma(m.slip_1, m.slip_1, lag_1 * lag_1), fma(m.slip_2, m.slip_2, lag_2 * lag_2)
    inverse = 1 / (d_1 * d_2 * determinant)
    # Kloss torque (22), (23), then less bearing loss and the moment of the unbalance's weight.
    share_1, share_2 = d_2 * determinant * inverse, d_1 * determinant * inverse
    kloss_1, kloss_2 = m.torque_1 * lag_1 * share_1, m.torque_2 * lag_2 * share_2
    q_1 = fma(-m.bearing_loss_1 * w_1 * w_1, 1.0 if w_1 > va else -1.0, kloss_1)
    q_2 = fma(-m.bearing_loss_2 * w_2 * w_2, 1.0 if w_2 > -va else -1.0, kloss_2)
    q_1 = fma(-m.gravity * m.unbalance_1, c_1, q_1)
    q_2 = fma(m.gravity * m.unbalance_2, c_2, q_2)
    # Forces on the body: of the supports, centrifugal, and those due to the rotors' torques.
    p_x = m.stiffness_x * fma(m.support_offset, alpha, x)
    p_x = fma(m.damping_x, fma(m.support_offset, va, vx), p_x)
    p_y = fma(m.stiffness_y, y, m.damping_y * vy)
    p_a = fma(m.stiffness_y, alpha, m.damping_y * va)
    turned, raised = p_a, p_y
    p_y = fma(m.support_lever, turned, raised)
    p_a = fma(turned * m.half_spacing, m.half_spacing, p_x * m.support_offset)
    p_a = fma(m.support_lever, raised, p_a)
    n_1, n_2 = m.unbalance_1 * w_1 * w_1, m.unbalance_2 * w_2 * w_2
    t_1, t_2 = r_1 * q_1, r_2 * q_2
    k_x = fma(-t_2, s_2, fma(n_2, c_2, fma(n_1, c_1, t_1 * s_1))) - p_x
    k_y = fma(t_2, c_2, fma(n_2, s_2, fma(n_1, s_1, -t_1 * c_1))) - p_y
    k_a = fma(t_2, g_2, fma(n_2, h_2, fma(n_1, h_1, -t_1 * g_1))) - p_a
    scale = d_1 * d_2 * inverse
    ax = fma(b_xa, k_a, fma(b_xx, k_x, b_xy * k_y)) * scale
    ay = fma(b_ya, k_a, fma(b_xy, k_x, b_yy * k_y)) * scale
    aa = fma(b_aa, k_a, fma(b_xa, k_x, b_ya * k_y)) * scale
    psi_1 = fma(m.mobility_1, q_1, -r_1 * fma(g_1, aa, fma(c_1, ay, -s_1 * ax)))
    psi_2 = fma(m.mobility_2, q_2, r_2 * fma(g_2, aa, fma(c_2, ay, -s_2 * ax)))
    return Motion(ax, ay, aa, psi_1, psi_2)
