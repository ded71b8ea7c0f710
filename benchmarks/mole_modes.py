"""The mole's modes as numbers, for tools that follow it from event to event.

The equations have one form in all modes: a column of constants says which one applies, and how far
its end is. The rules of friction are those of `models.mole.theory.friction`. Work of
impacts and supply is counted in kilojoules and the voltage in hundreds of volts, so that no
quantity is large.
"""

import math

from models.mole.lanes.modes import force_on_bar, mole_of
from models.mole.theory.friction import bar_hold, decide, mole_hold, response
from models.numerics.jit import kernel

U, V, X, CURRENT, P, SINE, COSINE, PROGRESS, IMPACT, ELECTRIC = range(10)
STATE = 10
VOLT, JOULE = 1e-2, 1e-3

(
    A,
    B,
    D,
    E,
    STIFFNESS,
    PUSH,
    CONTACT,
    OPEN,
    BAR_SLIP,
    BAR_HOLD,
    BAR_OFFSET,
    BAR_LIMIT,
    MOLE_SLIP,
    MOLE_HOLD,
    MOLE_OFFSET,
    MOLE_LIMIT,
    DRIVE,
    GAP,
    DAMPING,
    SLOPE,
    COIL,
    BAR_COIL,
    RESISTANCE,
    ELASTANCE,
    SPEED,
) = range(25)
CONSTANTS = 25

BAR, MOLE, TOUCHING, HALF = range(4)
MODE = 4

TOUCH_END, BAR_END, MOLE_END = range(3)
EVENTS = 3

_NUDGE = 1e-13  # [m s-1] off rest: there a slip's end would be found again


@kernel
def begin(table, lane, record, y, c, mode):
    """Let a lane go on from a record of `models.mole.lanes.rows`."""
    q = mole_of(table, lane)
    y[:, lane] = 0.0
    for j in range(5):
        y[j, lane] = record[j]
    y[P, lane] *= VOLT
    for j in range(MODE):
        mode[j, lane] = record[5 + j]
    c[GAP, lane], c[DAMPING, lane] = q.stop_gap, q.damping
    c[SLOPE, lane], c[COIL, lane] = -2 * q.sharpness, q.coil_inductance
    c[BAR_COIL, lane], c[RESISTANCE, lane] = q.bar_inductance, q.resistance
    c[ELASTANCE, lane], c[SPEED, lane] = VOLT * q.elastance, q.supply_speed
    _set_supply(q, lane, y, c, mode)
    _enter(q, lane, y, c, mode)


@kernel
def _set_supply(q, lane, y, c, mode):
    half = mode[HALF, lane]
    angle = q.supply_phase + q.supply_speed * (half * 0.5 * q.control_period)
    y[SINE, lane], y[COSINE, lane] = math.sin(angle), math.cos(angle)
    c[DRIVE, lane] = VOLT * q.supply_speed * q.voltage if half % 2 == 0 else 0.0


@kernel
def turn_relay(table, lane, y, c, mode):
    """Begin the next half of a control period."""
    q = mole_of(table, lane)
    mode[HALF, lane] += 1
    _set_supply(q, lane, y, c, mode)
    jump = VOLT * q.voltage * y[SINE, lane]
    y[P, lane] += jump if mode[HALF, lane] % 2 == 0 else -jump


@kernel
def _enter(q, lane, y, c, mode):
    """Set the constants of a lane's mode; what slips from rest is nudged."""
    bar, mole = mode[BAR, lane], mode[MOLE, lane]
    moves = response(q, bar, mole)
    c[A, lane], c[B, lane], c[D, lane], c[E, lane] = moves.a, moves.b, moves.d, moves.e
    touching = mode[TOUCHING, lane] == 1
    stop = q.contact_stiffness if touching else 0.0
    c[STIFFNESS, lane], c[CONTACT, lane] = q.spring_stiffness + stop, JOULE * stop
    c[PUSH, lane] = q.spring_stiffness * q.spring_rest + stop * q.stop_gap
    c[OPEN, lane] = -1.0 if touching else 1.0
    c[BAR_SLIP, lane], c[MOLE_SLIP, lane] = bar, mole
    hold, sticks = bar_hold(q, mole), bar == 0
    c[BAR_HOLD, lane] = 1.0 if sticks else 0.0
    c[BAR_OFFSET, lane] = hold.offset
    c[BAR_LIMIT, lane] = hold.limit**2 if sticks else 0.0
    # Where the bar sticks to a mole that sticks, nothing pulls at the mole.
    hold, sticks = mole_hold(q, bar), mole == 0
    c[MOLE_HOLD, lane] = 1.0 if sticks and bar != 0 else 0.0
    c[MOLE_OFFSET, lane] = -hold.offset
    c[MOLE_LIMIT, lane] = hold.limit**2 if sticks else 0.0
    if bar != 0 and y[V, lane] == 0:
        y[V, lane] = _NUDGE * bar
    if mole != 0 and y[X, lane] == 0:
        y[X, lane] = _NUDGE * mole


@kernel
def happen(which, table, lane, y, c, mode):
    """Change the mode of a lane after an event."""
    q = mole_of(table, lane)
    bar, mole, touching = mode[BAR, lane], mode[MOLE, lane], mode[TOUCHING, lane] == 1
    if which == TOUCH_END:
        mode[TOUCHING, lane] = 0.0 if touching else 1.0
        y[U, lane] = q.stop_gap
    elif which == BAR_END and bar != 0:
        y[V, lane] = 0.0
    elif which == MOLE_END and mole != 0:
        y[X, lane] = 0.0
    force, _, _ = force_on_bar(q, touching, y[U, lane], y[V, lane], y[CURRENT, lane])
    if which == BAR_END and bar == 0:
        bar = 1.0 if force + bar_hold(q, mole).offset > 0 else -1.0
        mode[BAR, lane] = bar
        if mole == 0:
            mode[MOLE, lane] = decide(q, bar, 0.0, force)[1]
    elif which == MOLE_END and mole == 0:
        mode[MOLE, lane] = 1.0 if mole_hold(q, bar).offset - force > 0 else -1.0
    elif which != TOUCH_END:
        mode[BAR, lane], mode[MOLE, lane] = decide(q, y[V, lane], y[X, lane], force)
    _enter(q, lane, y, c, mode)


@kernel
def motion(y, c, added):
    """Return rates and guards of a state; `motion.py_func` takes expressions for numbers.

    Guards are positive while the mode lasts: a distance; a slip velocity; or the square of a
    friction limit less that of the force.

    Parameters
    ----------
    y, c : sequence
        State and constants.
    added : float
        The bar's share of the inductance [H].

    Returns
    -------
    rates, guards : tuple
    """
    u, v, x, i, p = y[U], y[V], y[X], y[CURRENT], y[P]
    rise = c[SLOPE] * (u * added)
    magnetic = 0.5 * ((i * i) * rise)
    resisted = c[RESISTANCE] * i
    force = magnetic + c[PUSH] - c[STIFFNESS] * u - c[DAMPING] * v
    rates = (
        v,
        c[A] * force + c[B],
        c[D] * force + c[E],
        (p * (1 / VOLT) - resisted - rise * v * i) / (c[COIL] + added),
        c[DRIVE] * y[COSINE] - c[ELASTANCE] * i,
        c[SPEED] * y[COSINE],
        -c[SPEED] * y[SINE],
        x,
        c[CONTACT] * ((u - c[GAP]) * x),
        JOULE * (resisted * i + magnetic * v),
    )
    bar, mole = force + c[BAR_OFFSET], force + c[MOLE_OFFSET]
    guards = (
        c[OPEN] * (c[GAP] - u),
        c[BAR_SLIP] * v + c[BAR_LIMIT] - c[BAR_HOLD] * (bar * bar),
        c[MOLE_SLIP] * x + c[MOLE_LIMIT] - c[MOLE_HOLD] * (mole * mole),
    )
    return rates, guards
