"""Derivatives of the accelerations of `models.vibrator.equations.rigid`."""

from models.numerics.fma import fma
from models.numerics.jit import inlined


@inlined
def _column(m, motion, e_1, e_2, k_x, k_y, k_a, q_1, q_2):
    """Return the change of the accelerations due to changes of the forces and the rotors' terms."""
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
    """Return the derivatives of the accelerations returned by `accelerations`.

    Parameters
    ----------
    m : Rigid
    motion : Motion
    c_1, s_1, c_2, s_2, va, w_1, w_2 : float
        As there.

    Returns
    -------
    tuple of ten tuples of five floats
        With respect to x, y, alpha, psi_1, psi_2 and their rates; the sign of the bearing loss is
        treated as constant.
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
