"""Rows of rigid machines in lanes: their constants, states and parts of a revolution."""

from typing import NamedTuple

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
        c[27 * LANES + lane],
        c[28 * LANES + lane],
    )


@kernel
def load(table, first, out):
    """Load up to LANES rows of an (n, q) table into lanes; spare lanes repeat the last row."""
    last = table.shape[0] - 1
    for lane in range(LANES):
        for i in range(table.shape[1]):
            out[i * LANES + lane] = table[min(first + lane, last), i]


@kernel
def gather(table, rows, out):
    """Load the rows of an (n, q) table with these indices into lanes, as `load` does."""
    last = len(rows) - 1
    for lane in range(LANES):
        for i in range(table.shape[1]):
            out[i * LANES + lane] = table[rows[min(lane, last)], i]


@kernel
def store(lanes, first, table):
    """Store lanes back into their rows of an (n, q) table."""
    for n in range(first, min(first + LANES, table.shape[0])):
        for i in range(table.shape[1]):
            table[n, i] = lanes[i * LANES + n - first]


class Part(NamedTuple):
    """One of one or two equal parts of a revolution; the second mirrors the first.

    Without gravity, the equations are the same for the opposite displacement of the body and
    vibrators turned by pi.

    Attributes
    ----------
    parts : int
        Of a revolution.
    mirror : ndarray, shape (10,)
        Signs with which the components of the state return.
    turn : float
        Angle by which the vibrators turn [rad].
    """

    parts: int
    mirror: Array
    turn: float


WHOLE = Part(1, np.ones(STATE), 2 * np.pi)
HALF = Part(2, np.where(np.isin(np.arange(STATE), (0, 1, 2, 5, 6, 7)), -1.0, 1.0), np.pi)


@kernel
def turn_back(y, mirror, turn, out):
    """Set `out` to the states y of all lanes after a part, turned back by it."""
    for i in range(STATE):
        angle = turn if i == 3 or i == 4 else 0.0
        for lane in range(LANES):
            out[i * LANES + lane] = mirror[i] * y[i * LANES + lane] - angle
