"""Modes of a block of moles: their constants, and the coefficients of their guards.

A guard is positive while its part of the mode lasts: the distance to the stop; the slip velocity of
an interface in its direction, or the friction limit less the force required for sticking.
"""

import math

from models.mole.lanes import block as at
from models.mole.lanes.block import LANES
from models.mole.theory.friction import bar_hold, mole_hold, response
from models.mole.theory.system import Mole
from models.numerics.jit import lean

_LONGEST = 1.0  # step times the fastest rate


@lean
def mole_of(table, row):
    """Return the mole of one row of a table, shape (n, 20)."""
    return Mole(
        table[row, 0],
        table[row, 1],
        table[row, 2],
        table[row, 3],
        table[row, 4],
        table[row, 5],
        table[row, 6],
        table[row, 7],
        table[row, 8],
        table[row, 9],
        table[row, 10],
        table[row, 11],
        table[row, 12],
        table[row, 13],
        table[row, 14],
        table[row, 15],
        table[row, 16],
        table[row, 17],
        table[row, 18],
        table[row, 19],
    )


@lean
def force_on_bar(q, touching, u, v, i):
    """Return F [N], the force on the bar without friction, its inductance [H] and L' [H/m]."""
    added = q.bar_inductance * math.exp(-q.sharpness * u * u)
    rise = -2 * q.sharpness * u * added
    force = 0.5 * i * i * rise - q.damping * v - q.spring_stiffness * (u - q.spring_rest)
    if touching:
        force -= q.contact_stiffness * (u - q.stop_gap)
    return force, added, rise


@lean
def enter(q, lane, m, y):
    """Set everything that depends on a lane's mode: constants, coefficients of guards."""
    bar, mole = m[at.BAR_MODE * LANES + lane], m[at.MOLE_MODE * LANES + lane]
    touching = m[at.TOUCHING * LANES + lane] == 1
    mode = response(q, bar, mole)
    m[at.A * LANES + lane], m[at.B * LANES + lane] = mode.a, mode.b
    ratio = mode.d / mode.a if mode.a != 0 else 0.0
    m[at.RATIO * LANES + lane] = ratio
    m[at.DRIFT * LANES + lane] = mode.e - ratio * mode.b
    stop = q.contact_stiffness if touching else 0.0
    stiffness = q.spring_stiffness + stop
    m[at.STIFFNESS * LANES + lane], m[at.CONTACT * LANES + lane] = stiffness, stop
    m[at.FORCE * LANES + lane] = q.spring_stiffness * q.spring_rest + stop * q.stop_gap
    fastest = max(q.supply_speed, math.sqrt(stiffness / q.bar_mass))
    m[at.LONGEST * LANES + lane] = _LONGEST / fastest

    m[at.OPEN * LANES + lane] = -1.0 if touching else 1.0
    m[at.BAR_SLIP * LANES + lane] = bar
    m[at.MOLE_SLIP * LANES + lane] = mole
    hold = bar_hold(q, mole)
    m[at.BAR_HOLD * LANES + lane] = 1.0 if bar == 0 else 0.0
    m[at.BAR_OFFSET * LANES + lane] = hold.offset if bar == 0 else 0.0
    m[at.BAR_LIMIT * LANES + lane] = hold.limit if bar == 0 else 0.0
    # If both bar and mole stick, no net force acts on the mole.
    hold = mole_hold(q, bar)
    pulled = mole == 0 and bar != 0
    m[at.MOLE_HOLD * LANES + lane] = 1.0 if pulled else 0.0
    m[at.MOLE_OFFSET * LANES + lane] = -hold.offset if pulled else 0.0
    limit = 1.0 if bar == 0 else hold.limit
    m[at.MOLE_LIMIT * LANES + lane] = limit if mole == 0 else 0.0


@lean
def see(q, lane, m, y):
    """Set the inductance that the bar of a lane adds, after a change of u."""
    u = y[at.U * LANES + lane]
    y[at.ADDED * LANES + lane] = q.bar_inductance * math.exp(-q.sharpness * u * u)
    m[at.INVERSE * LANES + lane] = 1 / (q.coil_inductance + y[at.ADDED * LANES + lane])
