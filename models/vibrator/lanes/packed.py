"""Rows of rigid machines in lanes: their constants and states."""

import numpy as np
from numpy.typing import NDArray

from models.numerics.blocks import LANES
from models.numerics.jit import inlined, kernel
from models.vibrator.equations.rigid import Rigid

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
