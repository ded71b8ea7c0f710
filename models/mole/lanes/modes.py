"""Modes of sixteen moles: their constants and guards.

A guard is positive while its part of the mode lasts: the distance to the stop; the slip velocity of
an interface in its direction, or the friction limit less the force required for sticking.
"""

import math

from models.mole.lanes import block as at
from models.mole.lanes.block import BAR, LANES, MOLE, TOUCH
from models.mole.theory.equations import coil_step
from models.mole.theory.friction import bar_hold, mole_hold, response
from models.mole.theory.system import Mole
from models.numerics.fma import fma
from models.numerics.jit import lean

_LONGEST = 0.6  # step times the fastest rate


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
    """Set everything that depends on a lane's mode: constants, longest step, initial guards."""
    bar, mole = m[at.BAR_MODE * LANES + lane], m[at.MOLE_MODE * LANES + lane]
    touching = m[at.TOUCHING * LANES + lane] == 1
    mode = response(q, bar, mole)
    m[at.A * LANES + lane], m[at.B * LANES + lane] = mode.a, mode.b
    m[at.D * LANES + lane], m[at.E * LANES + lane] = mode.d, mode.e
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

    u, v, x = y[at.U * LANES + lane], y[at.V * LANES + lane], y[at.X * LANES + lane]
    i, p = y[at.CURRENT * LANES + lane], y[at.P * LANES + lane]
    force, added, rise = force_on_bar(q, touching, u, v, i)
    y[at.ADDED * LANES + lane] = added
    bend = -2 * q.sharpness * (added + u * rise)
    current = (p - (q.resistance + rise * v) * i) / (q.coil_inductance + added)
    rate_v, rate_x = mode.a * force + mode.b, mode.d * force + mode.e
    change = i * current * rise + (0.5 * i * i * bend - stiffness) * v - q.damping * rate_v
    m[at.COIL_STEP * LANES + lane] = coil_step(u, v, m[at.WIDTH * LANES + lane])
    open_ = m[at.OPEN * LANES + lane]
    m[(at.START + TOUCH) * LANES + lane] = open_ * (q.stop_gap - u)
    m[(at.START_RATE + TOUCH) * LANES + lane] = -open_ * v
    _start(lane, m, 0, v, rate_v, force, change)
    _start(lane, m, 1, x, rate_x, force, change)


@lean
def _start(lane, m, which, speed, rate, force, change):
    slip = m[(at.BAR_SLIP + which) * LANES + lane]
    hold = m[(at.BAR_HOLD + which) * LANES + lane]
    load = force + m[(at.BAR_OFFSET + which) * LANES + lane]
    spare = m[(at.BAR_LIMIT + which) * LANES + lane] - hold * abs(load)
    side = hold if load > 0 else -hold
    m[(at.START + BAR + which) * LANES + lane] = slip * speed + spare
    m[(at.START_RATE + BAR + which) * LANES + lane] = slip * rate - side * change


@lean
def judge(m, y, k):
    """Set guards and, times the step, their rates at the end of a step."""
    for lane in range(LANES):
        u, v, x = y[at.U * LANES + lane], y[at.V * LANES + lane], y[at.X * LANES + lane]
        i, added = y[at.CURRENT * LANES + lane], y[at.ADDED * LANES + lane]
        kv, kx = k[at.V * LANES + lane], k[at.X * LANES + lane]
        slope = m[at.SLOPE * LANES + lane]
        rise = slope * u * added
        bend = slope * added * fma(slope * u, u, 1.0)
        stiffness, damping = m[at.STIFFNESS * LANES + lane], m[at.DAMPING * LANES + lane]
        force = fma(0.5 * i * i, rise, m[at.FORCE * LANES + lane])
        force = fma(-damping, v, fma(-stiffness, u, force))
        change = fma(i * k[at.CURRENT * LANES + lane], rise, -damping * kv)
        change = fma(fma(0.5 * i * i, bend, -stiffness) * v, m[at.STEP * LANES + lane], change)
        m[at.COIL_STEP * LANES + lane] = coil_step(u, v, m[at.WIDTH * LANES + lane])
        open_ = m[at.OPEN * LANES + lane]
        m[(at.END + TOUCH) * LANES + lane] = open_ * (m[at.GAP * LANES + lane] - u)
        m[(at.END_RATE + TOUCH) * LANES + lane] = -open_ * v * m[at.STEP * LANES + lane]
        slip, hold = m[at.BAR_SLIP * LANES + lane], m[at.BAR_HOLD * LANES + lane]
        load = force + m[at.BAR_OFFSET * LANES + lane]
        side = hold if load > 0 else -hold
        spare = fma(-side, load, m[at.BAR_LIMIT * LANES + lane])
        m[(at.END + BAR) * LANES + lane] = fma(slip, v, spare)
        m[(at.END_RATE + BAR) * LANES + lane] = fma(slip, kv, -side * change)
        slip, hold = m[at.MOLE_SLIP * LANES + lane], m[at.MOLE_HOLD * LANES + lane]
        load = force + m[at.MOLE_OFFSET * LANES + lane]
        side = hold if load > 0 else -hold
        spare = fma(-side, load, m[at.MOLE_LIMIT * LANES + lane])
        m[(at.END + MOLE) * LANES + lane] = fma(slip, x, spare)
        m[(at.END_RATE + MOLE) * LANES + lane] = fma(slip, kx, -side * change)
