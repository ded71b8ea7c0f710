"""Modes of a block of moles: their constants, and the coefficients of their guards.

A guard is positive while its part of the mode lasts: the distance to the stop; the slip velocity of
an interface in its direction, or the friction limit less the force required for sticking.
"""

import math

from models.mole.lanes import block as at
from models.mole.lanes.block import LANES
from models.mole.theory.friction import bar_hold, mole_hold, response
from models.mole.theory.soil import APART, ELASTIC, RELAXED, SLIDING, push, soil_force
from models.mole.theory.system import Mole
from models.numerics.jit import lean

_LONGEST = 1.0  # step times the fastest rate


@lean
def mole_of(table, row):
    """Return the mole of one row of a table, shape (n, 24)."""
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
        table[row, 20],
        table[row, 21],
        table[row, 22],
        table[row, 23],
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
def enter_soil(q, lane, m, y):
    """Set what a lane's mode adds if there is soil ahead, after `enter`."""
    bar, mole = m[at.BAR_MODE * LANES + lane], m[at.MOLE_MODE * LANES + lane]
    soil = m[at.SOIL_MODE * LANES + lane]
    k, c, limit = q.soil_stiffness, q.soil_damping, q.soil_limit
    mode, pushes = response(q, bar, mole), push(q, bar, mole)
    m[at.D * LANES + lane], m[at.E * LANES + lane] = mode.d, mode.e
    m[at.ON_BAR * LANES + lane], m[at.ON_MOLE * LANES + lane] = pushes.on_bar, pushes.on_mole
    m[at.SOIL_1 * LANES + lane] = limit if soil == SLIDING else 0.0
    m[at.SOIL_DENT * LANES + lane] = k if soil == ELASTIC else 0.0
    m[at.SOIL_X * LANES + lane] = c if soil == ELASTIC else 0.0
    creeps = soil == SLIDING and c > 0
    m[at.DENT_X * LANES + lane] = 0.0 if soil == SLIDING else 1.0
    m[at.DENT_1 * LANES + lane] = limit / c if creeps else 0.0
    m[at.DENT_DENT * LANES + lane] = -k / c if creeps else 0.0
    relaxes = soil == APART and c > 0
    m[at.RELAX * LANES + lane] = k / c if relaxes else 0.0
    m[at.HELD_SOIL * LANES + lane] = q.mass / q.mole_mass if bar == 0 and mole != 0 else 0.0
    # Where the mole sticks, the force of the soil is constant.
    force = soil_force(q, soil, y[at.DENT * LANES + lane], limit, y[at.X * LANES + lane])
    pulled = mole == 0 and bar != 0
    m[at.MOLE_OFFSET * LANES + lane] += force if pulled else 0.0
    fastest = math.sqrt(k / (q.bar_mass + q.mole_mass)) + c / q.mole_mass
    m[at.LONGEST * LANES + lane] = min(m[at.LONGEST * LANES + lane], _LONGEST / fastest)
    for j in range(4):
        m[(at.SOIL_OF + j) * LANES + lane] = m[(at.YIELD_OF + j) * LANES + lane] = 0.0
    m[(at.SOIL_OF + 3) * LANES + lane] = m[(at.YIELD_OF + 3) * LANES + lane] = 1.0
    if soil == APART:
        m[(at.SOIL_OF + 1) * LANES + lane] = -1.0
        m[(at.SOIL_OF + 2) * LANES + lane] = 1.0
        m[(at.SOIL_OF + 3) * LANES + lane] = 0.0
    elif soil == ELASTIC and mole != 0:
        m[at.SOIL_OF * LANES + lane], m[(at.SOIL_OF + 1) * LANES + lane] = c, k
        m[(at.SOIL_OF + 3) * LANES + lane] = 0.0
        m[at.YIELD_OF * LANES + lane], m[(at.YIELD_OF + 1) * LANES + lane] = -c, -k
        m[(at.YIELD_OF + 3) * LANES + lane] = limit
    elif creeps:
        m[at.YIELD_OF * LANES + lane], m[(at.YIELD_OF + 1) * LANES + lane] = c, k
        m[(at.YIELD_OF + 3) * LANES + lane] = -limit


@lean
def relax(q, lane, m, y):
    """Let the soil of a lane rest once its spring has relaxed; return its longest step [s]."""
    rate = max(m[at.RELAX * LANES + lane], -m[at.DENT_DENT * LANES + lane])
    if m[at.RELAX * LANES + lane] > 0 and abs(y[at.FRONT * LANES + lane]) < RELAXED:
        m[at.RELAX * LANES + lane] = y[at.FRONT * LANES + lane] = rate = 0.0
    settled = q.soil_limit / q.soil_stiffness
    sliding = m[at.DENT_DENT * LANES + lane] < 0
    if sliding and abs(y[at.DENT * LANES + lane] - settled) < RELAXED + 4e-16 * settled:
        m[at.DENT_DENT * LANES + lane] = m[at.DENT_1 * LANES + lane] = rate = 0.0
    return _LONGEST / rate if rate > 0 else math.inf


@lean
def see(q, lane, m, y):
    """Set the inductance that the bar of a lane adds, after a change of u."""
    u = y[at.U * LANES + lane]
    y[at.ADDED * LANES + lane] = q.bar_inductance * math.exp(-q.sharpness * u * u)
    m[at.INVERSE * LANES + lane] = 1 / (q.coil_inductance + y[at.ADDED * LANES + lane])
