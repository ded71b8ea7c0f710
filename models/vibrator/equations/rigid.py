"""The machine with its motors bolted to the body: accelerations and their derivatives.

Straight-line algebra for whoever integrates (13) to (23), one machine or sixteen abreast. The
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
    """The fields of `models.vibrator.equations.system.System` that the rigid machine needs."""

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


class Motion(NamedTuple):
    """Accelerations, and what their derivatives need besides.

    Attributes
    ----------
    x, y, alpha, psi_1, psi_2 : float
        Accelerations [m s-2, rad s-2].
    kloss_1, kloss_2 : float
        Motor torques before bearing loss [N m].
    g_1, h_1, g_2, h_2 : float
        Third components of e_i and n_i [m].
    inverse : tuple of six floats
        Upper triangle of S^-1, by rows.
    share_1, share_2 : float
        1/(slip^2 + lag^2) of the Kloss torques [s2 rad-2].
    """

    x: Any
    y: Any
    alpha: Any
    psi_1: Any
    psi_2: Any
    kloss_1: Any
    kloss_2: Any
    g_1: Any
    h_1: Any
    g_2: Any
    h_2: Any
    inverse: Any
    share_1: Any
    share_2: Any


@inlined
def accelerations(m, c_1, s_1, c_2, s_2, x, y, alpha, vx, vy, va, w_1, w_2):
    """Return the `Motion` of a machine; all divisions are merged into one.

    Parameters
    ----------
    m : Rigid
        Or any other with its fields.
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
    # Kloss torque (22), (23), then less bearing loss.
    share_1, share_2 = d_2 * determinant * inverse, d_1 * determinant * inverse
    kloss_1, kloss_2 = m.torque_1 * lag_1 * share_1, m.torque_2 * lag_2 * share_2
    q_1 = fma(-m.bearing_loss_1 * w_1 * w_1, 1.0 if w_1 > va else -1.0, kloss_1)
    q_2 = fma(-m.bearing_loss_2 * w_2 * w_2, 1.0 if w_2 > -va else -1.0, kloss_2)
    # Forces on the body: of the supports, centrifugal, and what the rotors' torques pass on.
    p_x = m.stiffness_x * fma(m.support_offset, alpha, x)
    p_x = fma(m.damping_x, fma(m.support_offset, va, vx), p_x)
    p_y = fma(m.stiffness_y, y, m.damping_y * vy)
    p_a = fma(m.stiffness_y, alpha, m.damping_y * va)
    p_a = fma(p_a * m.half_spacing, m.half_spacing, p_x * m.support_offset)
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
    return Motion(
        ax,
        ay,
        aa,
        psi_1,
        psi_2,
        kloss_1,
        kloss_2,
        g_1,
        h_1,
        g_2,
        h_2,
        (b_xx * scale, b_xy * scale, b_xa * scale, b_yy * scale, b_ya * scale, b_aa * scale),
        share_1,
        share_2,
    )


@inlined
def _column(m, motion, e_1, e_2, k_x, k_y, k_a, q_1, q_2):
    """Return the accelerations that a change of force and of the rotors' own terms makes."""
    b_xx, b_xy, b_xa, b_yy, b_ya, b_aa = motion.inverse
    x = fma(b_xa, k_a, fma(b_xx, k_x, b_xy * k_y))
    y = fma(b_ya, k_a, fma(b_xy, k_x, b_yy * k_y))
    a = fma(b_aa, k_a, fma(b_xa, k_x, b_ya * k_y))
    r_1, r_2 = m.unbalance_1 * m.mobility_1, m.unbalance_2 * m.mobility_2
    return (
        x,
        y,
        a,
        fma(-r_1, fma(e_1[2], a, fma(e_1[0], x, e_1[1] * y)), q_1),
        fma(r_2, fma(e_2[2], a, fma(e_2[0], x, e_2[1] * y)), q_2),
    )


@inlined
def derivatives(m, motion, c_1, s_1, c_2, s_2, va, w_1, w_2):
    """Return the derivatives of the accelerations, which `accelerations` gave.

    Parameters
    ----------
    m : Rigid
    motion : Motion
    c_1, s_1, c_2, s_2, va, w_1, w_2 : float
        As there.

    Returns
    -------
    tuple of ten tuples of five floats
        By x, y, alpha, psi_1, psi_2 and their rates; the signum of the bearing loss is constant.
    """
    e_1, n_1 = (-s_1, c_1, motion.g_1), (c_1, s_1, motion.h_1)
    e_2, n_2 = (-s_2, c_2, motion.g_2), (c_2, s_2, motion.h_2)
    u_1, u_2 = m.unbalance_1, m.unbalance_2
    r_1, r_2 = u_1 * m.mobility_1, u_2 * m.mobility_2
    h, l2 = m.support_offset, m.half_spacing * m.half_spacing
    kx, ky, bx, by = m.stiffness_x, m.stiffness_y, m.damping_x, m.damping_y
    by_x = _column(m, motion, e_1, e_2, -kx, 0.0, -kx * h, 0.0, 0.0)
    by_y = _column(m, motion, e_1, e_2, 0.0, -ky, 0.0, 0.0, 0.0)
    by_a = _column(m, motion, e_1, e_2, -kx * h, 0.0, fma(-kx * h, h, -ky * l2), 0.0, 0.0)
    by_vx = _column(m, motion, e_1, e_2, -bx, 0.0, -bx * h, 0.0, 0.0)
    by_vy = _column(m, motion, e_1, e_2, 0.0, -by, 0.0, 0.0, 0.0)
    by_va = _column(m, motion, e_1, e_2, -bx * h, 0.0, fma(-bx * h, h, -by * l2), 0.0, 0.0)
    # theta_1 = beta + psi_1, theta_2 = beta - psi_2.
    j_1 = r_1 * fma(n_1[2], motion.alpha, fma(n_1[0], motion.x, n_1[1] * motion.y))
    j_2 = r_2 * fma(n_2[2], motion.alpha, fma(n_2[0], motion.x, n_2[1] * motion.y))
    along_1, across_1 = u_1 * motion.psi_1, u_1 * fma(w_1, w_1, -j_1)
    along_2, across_2 = u_2 * motion.psi_2, u_2 * fma(-w_2, w_2, j_2)
    by_psi_1 = _column(
        m,
        motion,
        e_1,
        e_2,
        fma(along_1, n_1[0], across_1 * e_1[0]),
        fma(along_1, n_1[1], across_1 * e_1[1]),
        fma(along_1, n_1[2], across_1 * e_1[2]),
        j_1,
        0.0,
    )
    by_psi_2 = _column(
        m,
        motion,
        e_1,
        e_2,
        fma(along_2, n_2[0], across_2 * e_2[0]),
        fma(along_2, n_2[1], across_2 * e_2[1]),
        fma(along_2, n_2[2], across_2 * e_2[2]),
        0.0,
        j_2,
    )
    # Slope of motor torque less bearing loss, and its share of the rotor's acceleration.
    lag_1, lag_2 = m.synchronous_speed_1 - w_1, m.synchronous_speed_2 - w_2
    slope_1 = motion.share_1 * fma(2 * lag_1, motion.kloss_1, -m.torque_1)
    slope_2 = motion.share_2 * fma(2 * lag_2, motion.kloss_2, -m.torque_2)
    slope_1 = fma(-2 * m.bearing_loss_1 * w_1, 1.0 if w_1 > va else -1.0, slope_1)
    slope_2 = fma(-2 * m.bearing_loss_2 * w_2, 1.0 if w_2 > -va else -1.0, slope_2)
    i_1, i_2 = m.mobility_1 * slope_1, m.mobility_2 * slope_2
    a_1, a_2 = 2 * u_1 * w_1, 2 * u_2 * w_2
    by_w_1 = _column(
        m,
        motion,
        e_1,
        e_2,
        fma(a_1, n_1[0], -u_1 * i_1 * e_1[0]),
        fma(a_1, n_1[1], -u_1 * i_1 * e_1[1]),
        fma(a_1, n_1[2], -u_1 * i_1 * e_1[2]),
        i_1,
        0.0,
    )
    by_w_2 = _column(
        m,
        motion,
        e_1,
        e_2,
        fma(a_2, n_2[0], u_2 * i_2 * e_2[0]),
        fma(a_2, n_2[1], u_2 * i_2 * e_2[1]),
        fma(a_2, n_2[2], u_2 * i_2 * e_2[2]),
        0.0,
        i_2,
    )
    return by_x, by_y, by_a, by_psi_1, by_psi_2, by_vx, by_vy, by_va, by_w_1, by_w_2
