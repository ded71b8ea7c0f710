"""Equations (13)-(23) as they are printed, forces between rotors and body included.

Weights of the unbalanced masses, which the paper neglects, are added to (20) and (21), and the
static forces of the supports that carry them to (14) and (15).
"""

import numpy as np


def rates(t, state, p):
    """Return the derivative of (x, y, alpha, phi_1, phi_2) and their rates."""
    x, y, a, phi_1, phi_2, vx, vy, va, w_1, w_2 = state
    m, e = p.unbalanced_mass, np.array([p.unbalance_1, p.unbalance_2]) / p.unbalanced_mass
    d, h = p.shaft_distance, p.support_offset
    th = p.working_angle + p.shaft_half_angle * np.array([1, -1])
    k_x, k_y, l2 = p.stiffness_x, p.stiffness_y, p.support_half_spacing**2
    b_x, b_y = (2 * p.damping_ratio * np.sqrt((p.body_mass + 2 * m) * k) for k in (k_x, k_y))
    w = np.array([w_1, w_2])
    w_s = np.array([p.synchronous_speed_1, p.synchronous_speed_2])
    slip = w_s - [p.breakdown_speed_1, p.breakdown_speed_2]
    rated = np.array([p.rated_torque_1, p.rated_torque_2])
    kloss = 2 * p.overload_capacity * rated * slip * (w_s - w) / (slip**2 + (w_s - w) ** 2)
    rho = np.array([p.bearing_constant_1, p.bearing_constant_2])
    om = kloss - rho * m * e * w**2 * np.sign([w_1 - va, w_2 + va])
    s_1, c_1, s_2, c_2 = np.sin(phi_1), np.cos(phi_1), np.sin(phi_2), np.cos(phi_2)

    # Unknowns: x'', y'', alpha'', phi_1'', phi_2'', P_x1, P_x2, P_y1, P_y2.
    matrix, right = np.zeros((9, 9)), np.zeros(9)
    ax, ay, aa, f_1, f_2, px_1, px_2, py_1, py_2 = range(9)
    # (13)
    matrix[0, [ax, px_1, px_2]] = p.body_mass, -1, -1
    right[0] = -k_x * (x + h * a) - b_x * (vx + h * va)
    # (14)
    matrix[1, [ay, py_1, py_2]] = p.body_mass, -1, -1
    weight = p.gravity * m
    right[1] = -k_y * y - b_y * vy + 2 * weight
    # (15)
    matrix[2, [aa, py_1, py_2]] = p.body_inertia, -d * np.cos(th[0]), -d * np.cos(th[1])
    matrix[2, [px_1, px_2]] = d * np.sin(th)
    right[2] = -h * (k_x * (x + h * a) + b_x * (vx + h * va)) - l2 * (k_y * a + b_y * va)
    right[2] += weight * d * np.cos(th).sum()
    # (16), (17)
    matrix[3, [f_1, px_1, py_1]] = p.rotor_inertia, e[0] * c_1, e[0] * s_1
    matrix[4, [f_2, px_2, py_2]] = p.rotor_inertia, -e[1] * c_2, e[1] * s_2
    right[3:5] = om
    # (18)-(21)
    matrix[5, [px_1, ax, aa, f_1]] = 1, m, -m * d * np.sin(th[0]), -m * e[0] * c_1
    right[5] = -m * e[0] * w_1**2 * s_1
    matrix[6, [px_2, ax, aa, f_2]] = 1, m, -m * d * np.sin(th[1]), m * e[1] * c_2
    right[6] = m * e[1] * w_2**2 * s_2
    matrix[7, [py_1, ay, aa, f_1]] = 1, m, m * d * np.cos(th[0]), -m * e[0] * s_1
    right[7] = m * e[0] * w_1**2 * c_1 - weight
    matrix[8, [py_2, ay, aa, f_2]] = 1, m, m * d * np.cos(th[1]), -m * e[1] * s_2
    right[8] = m * e[1] * w_2**2 * c_2 - weight
    return np.concatenate([state[5:], np.linalg.solve(matrix, right)[:5]])


def from_axis(p, state):
    """Turn psi_1, psi_2, counted from the working axis, into the paper's phi_1, phi_2."""
    state = np.array(state, float)
    state[3] += p.working_angle - np.pi / 2
    state[4] += np.pi / 2 - p.working_angle
    return state
