"""Accelerations of sixteen rigid machines with the fewest operations.

The equations of `models.vibrator.equations.rigid`, eliminated in the opposite order. About the
common centre of mass, in units of the mass and the radius of gyration, the inertia of body and
rotors' masses is the unit matrix: the body is eliminated without an inversion,

    a = F - nu_1 psi_1'' e_1 + nu_2 psi_2'' e_2,

which leaves two equations for the rotors. All products of constants, including the step, are formed
once.
"""

import numpy as np

from models.numerics.blocks import LANES
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel
from models.numerics.nystrom import layout
from models.numerics.sincos import cosine_sine

DEGREES = 5  # x, y, alpha, psi_1, psi_2
_AT = layout(DEGREES)
_X, _Y, _ALPHA, _PSI_1, _PSI_2 = (_AT.at + i * LANES for i in range(DEGREES))
_VX, _VY, _VA, _W_1, _W_2 = (_AT.speed + i * LANES for i in range(DEGREES))
_AX, _AY, _AA, _A_1, _A_2 = (_AT.rise + i * LANES for i in range(DEGREES))
_PASSED = 9  # numbers that one loop passes to the next
C_1, S_1, C_2, S_2, _F_X, _F_Y, _F_A, _Q_1, _Q_2 = (_AT.end + i * LANES for i in range(_PASSED))
_CONSTANTS = 40
(
    _ANGLE,
    _X_1,
    _Y_1,
    _X_2,
    _Y_2,
    _FREE_1,
    _FREE_2,
    _PHI_1,
    _PHI_2,
    _R_1,
    _R_2,
    _R_1_NU_2,
    _R_2_NU_1,
    _NU_1,
    _NU_2,
    _RADIAL_1,
    _RADIAL_2,
    _TORQUE_1,
    _TORQUE_2,
    _LOSS_1,
    _LOSS_2,
    _WEIGHT_1,
    _WEIGHT_2,
    _TOP_1,
    _TOP_2,
    _SLIP_1,
    _SLIP_2,
    _STIFF_X,
    _DAMP_X,
    _STIFF_Y,
    _DAMP_Y,
    _STIFF_A,
    _DAMP_A,
    _OFFSET,
    _LEVER_X,
    _LEVER_Y,
    _PER_RADIUS,
    _CENTRE_X,
    _CENTRE_Y,
    _LEVER,
) = (_AT.end + (_PASSED + i) * LANES for i in range(_CONSTANTS))
END = _AT.end + (_PASSED + _CONSTANTS) * LANES


@inlined
def prepare(m, h, w, lane):
    """Set one lane's constants for steps of length h.

    Parameters
    ----------
    m : Rigid
    h : float
        [s]
    w : ndarray
        Block of lanes.
    lane : int
    """
    centre_x, centre_y = m.moment_x / m.mass, m.moment_y / m.mass
    per_radius = 1 / np.sqrt(m.inertia / m.mass - centre_x * centre_x - centre_y * centre_y)
    nu_1, nu_2 = m.unbalance_1 / m.mass, m.unbalance_2 / m.mass
    r_1, r_2 = m.unbalance_1 * m.mobility_1, m.unbalance_2 * m.mobility_2
    stiff, damp, arm = -h * m.stiffness_y / m.mass, -h * m.damping_y / m.mass, m.half_spacing
    w[_ANGLE + lane] = m.working_angle
    w[_X_1 + lane] = (m.shaft_x_1 - centre_x) * per_radius
    w[_Y_1 + lane] = (m.shaft_y_1 - centre_y) * per_radius
    w[_X_2 + lane] = (m.shaft_x_2 - centre_x) * per_radius
    w[_Y_2 + lane] = (m.shaft_y_2 - centre_y) * per_radius
    w[_FREE_1 + lane], w[_FREE_2 + lane] = 1 - nu_1 * r_1, 1 - nu_2 * r_2
    w[_PHI_1 + lane], w[_PHI_2 + lane] = nu_1 * r_1, nu_2 * r_2
    w[_R_1 + lane], w[_R_2 + lane] = r_1, r_2
    w[_R_1_NU_2 + lane], w[_R_2_NU_1 + lane] = r_1 * nu_2, r_2 * nu_1
    w[_NU_1 + lane], w[_NU_2 + lane] = nu_1, nu_2
    w[_RADIAL_1 + lane], w[_RADIAL_2 + lane] = h * nu_1, h * nu_2
    w[_TORQUE_1 + lane] = h * m.mobility_1 * m.torque_1
    w[_TORQUE_2 + lane] = h * m.mobility_2 * m.torque_2
    w[_LOSS_1 + lane] = h * m.mobility_1 * m.bearing_loss_1
    w[_LOSS_2 + lane] = h * m.mobility_2 * m.bearing_loss_2
    w[_WEIGHT_1 + lane] = -h * r_1 * m.gravity
    w[_WEIGHT_2 + lane] = h * r_2 * m.gravity
    w[_TOP_1 + lane], w[_TOP_2 + lane] = m.synchronous_speed_1, m.synchronous_speed_2
    w[_SLIP_1 + lane], w[_SLIP_2 + lane] = m.slip_1 * m.slip_1, m.slip_2 * m.slip_2
    w[_STIFF_X + lane] = -h * m.stiffness_x / m.mass
    w[_DAMP_X + lane] = -h * m.damping_x / m.mass
    w[_STIFF_Y + lane], w[_DAMP_Y + lane] = stiff, damp
    # about the centre of both supports, which unequal ones shift
    lever = m.support_lever
    share = 1 - (lever / arm) * (lever / arm)
    w[_STIFF_A + lane] = stiff * arm * arm * per_radius * share
    w[_DAMP_A + lane] = damp * arm * arm * per_radius * share
    w[_OFFSET + lane] = m.support_offset
    w[_LEVER_X + lane] = (m.support_offset + centre_y) * per_radius
    w[_LEVER_Y + lane] = (lever - centre_x) * per_radius
    w[_LEVER + lane] = lever
    w[_PER_RADIUS + lane] = per_radius
    w[_CENTRE_X + lane], w[_CENTRE_Y + lane] = centre_x, centre_y


@kernel
def accelerate(w):
    """Set the accelerations of all lanes, times the step.

    Three short loops instead of a long one: work on the next lanes overlaps the latency of sines
    and quotients.
    """
    for lane in range(LANES):
        c_1, s_1 = cosine_sine(w[_ANGLE + lane] + w[_PSI_1 + lane])
        c_2, s_2 = cosine_sine(w[_ANGLE + lane] - w[_PSI_2 + lane])
        w[C_1 + lane], w[S_1 + lane] = c_1, s_1
        w[C_2 + lane], w[S_2 + lane] = c_2, s_2
    for lane in range(LANES):
        c_1, s_1, c_2, s_2 = w[C_1 + lane], w[S_1 + lane], w[C_2 + lane], w[S_2 + lane]
        alpha, va, w_1, w_2 = w[_ALPHA + lane], w[_VA + lane], w[_W_1 + lane], w[_W_2 + lane]
        lag_1, lag_2 = w[_TOP_1 + lane] - w_1, w[_TOP_2 + lane] - w_2
        kloss_1 = w[_TORQUE_1 + lane] * lag_1 / fma(lag_1, lag_1, w[_SLIP_1 + lane])
        kloss_2 = w[_TORQUE_2 + lane] * lag_2 / fma(lag_2, lag_2, w[_SLIP_2 + lane])
        square_1, square_2 = w_1 * w_1, w_2 * w_2
        loss_1, loss_2 = w[_LOSS_1 + lane] * square_1, w[_LOSS_2 + lane] * square_2
        q_1 = kloss_1 - (loss_1 if w_1 > va else -loss_1)
        q_2 = kloss_2 - (loss_2 if w_2 > -va else -loss_2)
        w[_Q_1 + lane] = fma(w[_WEIGHT_1 + lane], c_1, q_1)
        w[_Q_2 + lane] = fma(w[_WEIGHT_2 + lane], c_2, q_2)
        # Forces of the supports, and their moment about the centre of mass.
        offset = w[_OFFSET + lane]
        p_x = w[_STIFF_X + lane] * fma(offset, alpha, w[_X + lane])
        p_x = fma(w[_DAMP_X + lane], fma(offset, va, w[_VX + lane]), p_x)
        lever = w[_LEVER + lane]
        p_y = w[_DAMP_Y + lane] * fma(lever, va, w[_VY + lane])
        p_y = fma(w[_STIFF_Y + lane], fma(lever, alpha, w[_Y + lane]), p_y)
        p_a = fma(w[_STIFF_A + lane], alpha, w[_DAMP_A + lane] * va)
        p_a += fma(w[_LEVER_X + lane], p_x, w[_LEVER_Y + lane] * p_y)
        n_1, n_2 = w[_RADIAL_1 + lane] * square_1, w[_RADIAL_2 + lane] * square_2
        h_1 = fma(w[_X_1 + lane], s_1, -w[_Y_1 + lane] * c_1)
        h_2 = fma(w[_X_2 + lane], s_2, -w[_Y_2 + lane] * c_2)
        w[_F_X + lane] = fma(n_2, c_2, fma(n_1, c_1, p_x))
        w[_F_Y + lane] = fma(n_2, s_2, fma(n_1, s_1, p_y))
        w[_F_A + lane] = fma(n_2, h_2, fma(n_1, h_1, p_a))
    for lane in range(LANES):
        c_1, s_1, c_2, s_2 = w[C_1 + lane], w[S_1 + lane], w[C_2 + lane], w[S_2 + lane]
        g_1 = fma(w[_X_1 + lane], c_1, w[_Y_1 + lane] * s_1)
        g_2 = fma(w[_X_2 + lane], c_2, w[_Y_2 + lane] * s_2)
        both = fma(g_1, g_2, fma(c_1, c_2, s_1 * s_2))
        b_1, b_2 = w[_R_1_NU_2 + lane] * both, w[_R_2_NU_1 + lane] * both
        d_1 = fma(-w[_PHI_1 + lane] * g_1, g_1, w[_FREE_1 + lane])
        d_2 = fma(-w[_PHI_2 + lane] * g_2, g_2, w[_FREE_2 + lane])
        inverse = 1 / fma(d_1, d_2, -b_1 * b_2)
        f_x, f_y, f_a = w[_F_X + lane], w[_F_Y + lane], w[_F_A + lane]
        q_1 = fma(-w[_R_1 + lane], fma(g_1, f_a, fma(c_1, f_y, -s_1 * f_x)), w[_Q_1 + lane])
        q_2 = fma(w[_R_2 + lane], fma(g_2, f_a, fma(c_2, f_y, -s_2 * f_x)), w[_Q_2 + lane])
        a_1, a_2 = (fma(d_2, q_1, -b_1 * q_2) * inverse, fma(d_1, q_2, -b_2 * q_1) * inverse)
        w[_A_1 + lane], w[_A_2 + lane] = a_1, a_2
        a_1, a_2 = w[_NU_1 + lane] * a_1, w[_NU_2 + lane] * a_2
        aa = fma(a_2, g_2, fma(-a_1, g_1, f_a)) * w[_PER_RADIUS + lane]
        w[_AA + lane] = aa
        w[_AX + lane] = fma(w[_CENTRE_Y + lane], aa, fma(-a_2, s_2, fma(a_1, s_1, f_x)))
        w[_AY + lane] = fma(-w[_CENTRE_X + lane], aa, fma(a_2, c_2, fma(-a_1, c_1, f_y)))
