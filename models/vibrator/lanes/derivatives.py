"""How the accelerations of sixteen rigid machines change with their states.

The body is described by x, y and alpha at S, the centre of the supports' stiffness, where each
support force depends on one of them alone. With e_i, n_i of `models.vibrator.equations.rigid` about
S, a change of the state changes the accelerations by

    da = B dF,    dpsi_1'' = dq_1 - r_1 e_1 . da,    dpsi_2'' = dq_2 + r_2 e_2 . da,

where B is the inverse of the body's inertia S there, F contains the rotors' reactions, and q_i is
the share of a rotor's acceleration that depends on its own motion. These factors are fewer than the
derivatives themselves. Positions and rates are those over a step: all rates are times the step.
"""

from models.numerics.blocks import LANES
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel
from models.vibrator.lanes.dynamics import C_1, C_2, DEGREES, S_1, S_2
from models.vibrator.lanes.packed import machine
from models.vibrator.lanes.steps import AT

_X, _Y, _ALPHA, _PSI_1, _PSI_2 = (AT.rise + i * LANES for i in range(DEGREES))
_VA, _W_1, _W_2 = (AT.speed + i * LANES for i in (2, 3, 4))

_FACTORS = 28
(
    _B_XX,
    _B_XY,
    _B_XA,
    _B_YY,
    _B_YA,
    _B_AA,
    _PSI_1_X,
    _PSI_1_Y,
    _PSI_1_A,
    _PSI_2_X,
    _PSI_2_Y,
    _PSI_2_A,
    _W_1_X,
    _W_1_Y,
    _W_1_A,
    _W_2_X,
    _W_2_Y,
    _W_2_A,
    _E_1_X,
    _E_1_Y,
    _E_1_A,
    _E_2_X,
    _E_2_Y,
    _E_2_A,
    _OWN_1,
    _OWN_2,
    _SLOPE_1,
    _SLOPE_2,
) = (i * LANES for i in range(_FACTORS))
FACTORS = _FACTORS * LANES
"""Numbers that a block of lanes needs at one stage."""

_SUPPORTS = 6
_STIFF_X, _DAMP_X, _STIFF_Y, _DAMP_Y, _STIFF_A, _DAMP_A = (i * LANES for i in range(_SUPPORTS))
SUPPORTS = _SUPPORTS * LANES
"""Numbers that it needs at all stages."""


@kernel
def support(c, h, out):
    """Set the quantities common to the derivatives at all stages.

    Parameters
    ----------
    c : ndarray
        Constants of the machines, in lanes.
    h : ndarray, shape (LANES,)
        Steps [s].
    out : ndarray, shape (SUPPORTS,)
    """
    for lane in range(LANES):
        m, step = machine(c, lane), h[lane]
        arm = fma(-m.support_lever, m.support_lever, m.half_spacing * m.half_spacing)
        out[_STIFF_X + lane] = -step * step * m.stiffness_x
        out[_STIFF_Y + lane] = -step * step * m.stiffness_y
        out[_STIFF_A + lane] = -step * step * m.stiffness_y * arm
        out[_DAMP_X + lane] = -step * m.damping_x
        out[_DAMP_Y + lane] = -step * m.damping_y
        out[_DAMP_A + lane] = -step * m.damping_y * arm


@kernel
def linearise(c, w, out):
    """Set the factors of the derivatives where the accelerations have just been evaluated.

    Parameters
    ----------
    c : ndarray
        Constants of the machines, in lanes.
    w : ndarray
        Block of lanes, as `models.vibrator.lanes.dynamics.accelerate` leaves it.
    out : ndarray, shape (FACTORS,)
    """
    for lane in range(LANES):
        m, step = machine(c, lane), w[AT.step + lane]
        c_1, s_1, c_2, s_2 = w[C_1 + lane], w[S_1 + lane], w[C_2 + lane], w[S_2 + lane]
        va, w_1, w_2 = w[_VA + lane], w[_W_1 + lane], w[_W_2 + lane]
        up, right = m.support_offset, m.support_lever
        x_1, x_2 = m.shaft_x_1 - right, m.shaft_x_2 - right
        y_1, y_2 = m.shaft_y_1 + up, m.shaft_y_2 + up
        g_1, h_1 = fma(x_1, c_1, y_1 * s_1), fma(x_1, s_1, -y_1 * c_1)
        g_2, h_2 = fma(x_2, c_2, y_2 * s_2), fma(x_2, s_2, -y_2 * c_2)
        u_1, u_2 = m.unbalance_1, m.unbalance_2
        r_1, r_2 = u_1 * m.mobility_1, u_2 * m.mobility_2
        # The inertia of the body less what the rotors give way, and its cofactors.
        f_1, f_2 = u_1 * r_1, u_2 * r_2
        s_xx = fma(-f_2 * s_2, s_2, fma(-f_1 * s_1, s_1, m.mass))
        s_xy = fma(f_1 * s_1, c_1, f_2 * s_2 * c_2)
        s_yy = fma(-f_2 * c_2, c_2, fma(-f_1 * c_1, c_1, m.mass))
        s_xa = fma(-up, m.mass, fma(f_1 * s_1, g_1, f_2 * s_2 * g_2) - m.moment_y)
        s_ya = fma(-f_2 * c_2, g_2, fma(-f_1 * c_1, g_1, fma(-right, m.mass, m.moment_x)))
        s_aa = fma(up, fma(up, m.mass, 2 * m.moment_y), m.inertia)
        s_aa = fma(right, fma(right, m.mass, -2 * m.moment_x), s_aa)
        s_aa = fma(-f_2 * g_2, g_2, fma(-f_1 * g_1, g_1, s_aa))
        b_xx = fma(s_yy, s_aa, -s_ya * s_ya)
        b_xy = fma(s_xa, s_ya, -s_xy * s_aa)
        b_xa = fma(s_xy, s_ya, -s_xa * s_yy)
        b_yy = fma(s_xx, s_aa, -s_xa * s_xa)
        b_ya = fma(s_xy, s_xa, -s_xx * s_ya)
        b_aa = fma(s_xx, s_yy, -s_xy * s_xy)
        determinant = fma(s_xa, b_xa, fma(s_xx, b_xx, s_xy * b_xy))
        # Slopes of motor torque less bearing loss.
        lag_1, lag_2 = m.synchronous_speed_1 - w_1, m.synchronous_speed_2 - w_2
        d_1, d_2 = fma(m.slip_1, m.slip_1, lag_1 * lag_1), fma(m.slip_2, m.slip_2, lag_2 * lag_2)
        both = d_1 * d_2
        inverse = 1 / (both * determinant)
        scale = both * inverse
        share_1, share_2 = d_2 * determinant * inverse, d_1 * determinant * inverse
        slope_1 = m.torque_1 * share_1 * fma(2 * lag_1 * lag_1, share_1, -1.0)
        slope_2 = m.torque_2 * share_2 * fma(2 * lag_2 * lag_2, share_2, -1.0)
        slope_1 = fma(-2 * m.bearing_loss_1 * w_1, 1.0 if w_1 > va else -1.0, slope_1)
        slope_2 = fma(-2 * m.bearing_loss_2 * w_2, 1.0 if w_2 > -va else -1.0, slope_2)
        slope_1, slope_2 = step * m.mobility_1 * slope_1, step * m.mobility_2 * slope_2
        # The body's acceleration along n_i turns the rotor; gravity acts like one upwards.
        aa = step * w[_ALPHA + lane]
        ax = fma(up, aa, step * w[_X + lane])
        ay = fma(right, aa, fma(step * step, m.gravity, step * w[_Y + lane]))
        own_1 = r_1 * fma(h_1, aa, fma(c_1, ax, s_1 * ay))
        own_2 = r_2 * fma(h_2, aa, fma(c_2, ax, s_2 * ay))
        v_1, v_2 = step * w_1, step * w_2
        along_1, across_1 = u_1 * step * w[_PSI_1 + lane], u_1 * fma(v_1, v_1, -own_1)
        along_2, across_2 = u_2 * step * w[_PSI_2 + lane], u_2 * fma(-v_2, v_2, own_2)
        out[_PSI_1_X + lane] = fma(along_1, c_1, -across_1 * s_1)
        out[_PSI_1_Y + lane] = fma(along_1, s_1, across_1 * c_1)
        out[_PSI_1_A + lane] = fma(along_1, h_1, across_1 * g_1)
        out[_PSI_2_X + lane] = fma(along_2, c_2, -across_2 * s_2)
        out[_PSI_2_Y + lane] = fma(along_2, s_2, across_2 * c_2)
        out[_PSI_2_A + lane] = fma(along_2, h_2, across_2 * g_2)
        along_1, across_1 = 2 * u_1 * v_1, -u_1 * slope_1
        along_2, across_2 = 2 * u_2 * v_2, u_2 * slope_2
        out[_W_1_X + lane] = fma(along_1, c_1, -across_1 * s_1)
        out[_W_1_Y + lane] = fma(along_1, s_1, across_1 * c_1)
        out[_W_1_A + lane] = fma(along_1, h_1, across_1 * g_1)
        out[_W_2_X + lane] = fma(along_2, c_2, -across_2 * s_2)
        out[_W_2_Y + lane] = fma(along_2, s_2, across_2 * c_2)
        out[_W_2_A + lane] = fma(along_2, h_2, across_2 * g_2)
        out[_B_XX + lane], out[_B_XY + lane] = b_xx * scale, b_xy * scale
        out[_B_XA + lane], out[_B_YY + lane] = b_xa * scale, b_yy * scale
        out[_B_YA + lane], out[_B_AA + lane] = b_ya * scale, b_aa * scale
        out[_E_1_X + lane], out[_E_1_Y + lane] = r_1 * s_1, -r_1 * c_1
        out[_E_2_X + lane], out[_E_2_Y + lane] = -r_2 * s_2, r_2 * c_2
        out[_E_1_A + lane], out[_E_2_A + lane] = -r_1 * g_1, r_2 * g_2
        out[_OWN_1 + lane], out[_SLOPE_1 + lane] = own_1, slope_1
        out[_OWN_2 + lane], out[_SLOPE_2 + lane] = own_2, slope_2


@inlined
def change(w, s, o, z, v):
    """Return the change of the accelerations, times the square of the step.

    Parameters
    ----------
    w : ndarray
        Holds the numbers of `support` and `linearise`.
    s, o : int
        Offsets of these, for one lane.
    z, v : tuple of five floats
        Changes of the positions x, y, alpha at S, psi_1, psi_2 and of their rates times the step.

    Returns
    -------
    tuple of five floats
    """
    x = fma(w[o + _PSI_1_X], z[3], fma(w[s + _DAMP_X], v[0], w[s + _STIFF_X] * z[0]))
    x += fma(w[o + _W_2_X], v[4], fma(w[o + _PSI_2_X], z[4], w[o + _W_1_X] * v[3]))
    y = fma(w[o + _PSI_1_Y], z[3], fma(w[s + _DAMP_Y], v[1], w[s + _STIFF_Y] * z[1]))
    y += fma(w[o + _W_2_Y], v[4], fma(w[o + _PSI_2_Y], z[4], w[o + _W_1_Y] * v[3]))
    a = fma(w[o + _PSI_1_A], z[3], fma(w[s + _DAMP_A], v[2], w[s + _STIFF_A] * z[2]))
    a += fma(w[o + _W_2_A], v[4], fma(w[o + _PSI_2_A], z[4], w[o + _W_1_A] * v[3]))
    ax = fma(w[o + _B_XA], a, fma(w[o + _B_XY], y, w[o + _B_XX] * x))
    ay = fma(w[o + _B_YA], a, fma(w[o + _B_YY], y, w[o + _B_XY] * x))
    aa = fma(w[o + _B_AA], a, fma(w[o + _B_YA], y, w[o + _B_XA] * x))
    q_1 = fma(w[o + _SLOPE_1], v[3], w[o + _OWN_1] * z[3])
    q_2 = fma(w[o + _SLOPE_2], v[4], w[o + _OWN_2] * z[4])
    return (
        ax,
        ay,
        aa,
        fma(w[o + _E_1_A], aa, fma(w[o + _E_1_Y], ay, fma(w[o + _E_1_X], ax, q_1))),
        fma(w[o + _E_2_A], aa, fma(w[o + _E_2_Y], ay, fma(w[o + _E_2_X], ax, q_2))),
    )
