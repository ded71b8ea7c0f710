"""What an event changes: contact, slip and stick, and the relay."""

import math

from models.mole.lanes import block as at
from models.mole.lanes.block import BAR, LANES, MOLE, TOUCH
from models.mole.lanes.modes import enter, force_on_bar, see
from models.mole.parameters import PHYSICAL
from models.mole.theory.friction import bar_hold, decide, mole_hold, response
from models.numerics.jit import lean


@lean
def happen(which, q, lane, m, y, columns):
    """Change the mode of a lane whose guard `which` has reached zero."""
    bar, mole = m[at.BAR_MODE * LANES + lane], m[at.MOLE_MODE * LANES + lane]
    touching = m[at.TOUCHING * LANES + lane] == 1
    u, v, x = y[at.U * LANES + lane], y[at.V * LANES + lane], y[at.X * LANES + lane]
    i = y[at.CURRENT * LANES + lane]
    force, _, _ = force_on_bar(q, touching, u, v, i)
    if which == TOUCH:
        m[at.TOUCHING * LANES + lane] = 0 if touching else 1
        m[at.CONTACTS * LANES + lane] += 0 if touching else 1
        y[at.U * LANES + lane] = q.stop_gap
        see(q, lane, m, y)
    elif which == BAR and bar == 0:
        # The force has just reached its limit: the direction of slip is known.
        bar = 1.0 if force + bar_hold(q, mole).offset > 0 else -1.0
        m[at.BAR_MODE * LANES + lane] = bar
        if mole == 0 and q.mole_limit == 0:
            # No friction holds the mole, on which the force is still zero.
            m[at.MOLE_MODE * LANES + lane] = -bar
    elif which == MOLE and mole == 0:
        m[at.MOLE_MODE * LANES + lane] = 1 if mole_hold(q, bar).offset - force > 0 else -1
    else:
        if which == BAR:
            v = 0.0
            y[at.V * LANES + lane] = v
            force, _, _ = force_on_bar(q, touching, u, v, i)
            m[at.LOW * LANES + lane] = min(m[at.LOW * LANES + lane], u)
            m[at.HIGH * LANES + lane] = max(m[at.HIGH * LANES + lane], u)
        else:
            x = 0.0
            y[at.X * LANES + lane] = x
        new_bar, new_mole = decide(q, v, x, force)
        m[at.BAR_MODE * LANES + lane] = new_bar
        m[at.MOLE_MODE * LANES + lane] = new_mole
        before, after = response(q, bar, mole), response(q, new_bar, new_mole)
        _saltate(lane, y, which, columns, force, before, after)
    enter(q, lane, m, y)


@lean
def _saltate(lane, y, which, columns, force, before, after):
    """Apply the saltation matrix of the end of a slip to the tangents."""
    kick_v = (after.a - before.a) * force + after.b - before.b
    kick_x = (after.d - before.d) * force + after.e - before.e
    along = at.V if which == BAR else at.X
    rate = before.a * force + before.b if which == BAR else before.d * force + before.e
    for column in range(columns):
        z = (at.PLAIN + at.MEASURED * column) * LANES + lane
        late = -y[z + along * LANES] / rate
        y[z + at.V * LANES] -= kick_v * late
        y[z + at.X * LANES] -= kick_x * late


@lean
def turn_relay(q, lane, m, y):
    """Begin the next half of a control period."""
    half = m[at.HALF * LANES + lane] + 1
    m[at.HALF * LANES + lane] = half
    set_supply(q, lane, m, y)
    if q.formulation == PHYSICAL:
        jump = q.voltage * y[at.SINE * LANES + lane]
        y[at.P * LANES + lane] += jump if half % 2 == 0 else -jump


@lean
def set_supply(q, lane, m, y):
    """Set clock and supply at the start of half a control period."""
    half = m[at.HALF * LANES + lane]
    angle = q.supply_phase + q.supply_speed * (half * 0.5 * q.control_period)
    y[at.SINE * LANES + lane] = math.sin(angle)
    y[at.COSINE * LANES + lane] = math.cos(angle)
    on = half % 2 == 0
    m[at.DRIVE * LANES + lane] = q.supply_speed * q.voltage if on else 0.0
    m[at.TIME * LANES + lane] = 0.0
