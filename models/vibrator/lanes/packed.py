"""Rows of rigid machines in lanes: their constants, states and rates of change."""

import numpy as np
from numpy.typing import NDArray

from models.numerics.blocks import LANES
from models.numerics.jit import inlined, kernel
from models.numerics.sincos import cosine_sine
from models.vibrator.equations.rigid import Rigid, accelerations

Array = NDArray[np.float64]

STATE = 10  # x, y, alpha, psi_1, psi_2 and their rates
CONSTANTS = len(Rigid._fields)


def pack(machines: Rigid) -> Array:
    """Return the constants of n machines, shape (n, CONSTANTS)."""
    return np.stack(machines, axis=1)


@inlined
def machine(c, lane):
    """Return the constants of one lane."""
    return Rigid(
        c[lane],
        c[LANES + lane],
        c[2 * LANES + lane],
        c[3 * LANES + lane],
        c[4 * LANES + lane],
        c[5 * LANES + lane],
        c[6 * LANES + lane],
        c[7 * LANES + lane],
        c[8 * LANES + lane],
        c[9 * LANES + lane],
        c[10 * LANES + lane],
        c[11 * LANES + lane],
        c[12 * LANES + lane],
        c[13 * LANES + lane],
        c[14 * LANES + lane],
        c[15 * LANES + lane],
        c[16 * LANES + lane],
        c[17 * LANES + lane],
        c[18 * LANES + lane],
        c[19 * LANES + lane],
        c[20 * LANES + lane],
        c[21 * LANES + lane],
        c[22 * LANES + lane],
        c[23 * LANES + lane],
        c[24 * LANES + lane],
        c[25 * LANES + lane],
        c[26 * LANES + lane],
    )


@inlined
def set_slopes(c, h, y, k, lane):
    """Set k to the rates of change of one lane, times the step; return what they depend on."""
    m, step = machine(c, lane), h[lane]
    c_1, s_1 = cosine_sine(m.working_angle + y[3 * LANES + lane])
    c_2, s_2 = cosine_sine(m.working_angle - y[4 * LANES + lane])
    x, y_, alpha = y[lane], y[LANES + lane], y[2 * LANES + lane]
    vx, vy, va = y[5 * LANES + lane], y[6 * LANES + lane], y[7 * LANES + lane]
    w_1, w_2 = y[8 * LANES + lane], y[9 * LANES + lane]
    motion = accelerations(m, c_1, s_1, c_2, s_2, x, y_, alpha, vx, vy, va, w_1, w_2)
    k[lane] = step * vx
    k[LANES + lane] = step * vy
    k[2 * LANES + lane] = step * va
    k[3 * LANES + lane] = step * w_1
    k[4 * LANES + lane] = step * w_2
    k[5 * LANES + lane] = step * motion.x
    k[6 * LANES + lane] = step * motion.y
    k[7 * LANES + lane] = step * motion.alpha
    k[8 * LANES + lane] = step * motion.psi_1
    k[9 * LANES + lane] = step * motion.psi_2
    return m, step, motion, c_1, s_1, c_2, s_2, va, w_1, w_2


@kernel
def slopes(c, h, y, k):
    """Set k to the rates of change of the states y of all lanes, times the step."""
    for lane in range(LANES):
        set_slopes(c, h, y, k, lane)


@kernel
def load(table, first, out):
    """Load up to LANES rows of an (n, q) table into lanes; spare lanes repeat the last row."""
    last = table.shape[0] - 1
    for lane in range(LANES):
        for i in range(table.shape[1]):
            out[i * LANES + lane] = table[min(first + lane, last), i]


@kernel
def store(lanes, first, table):
    """Store lanes back into their rows of an (n, q) table."""
    for n in range(first, min(first + LANES, table.shape[0])):
        for i in range(table.shape[1]):
            table[n, i] = lanes[i * LANES + n - first]
