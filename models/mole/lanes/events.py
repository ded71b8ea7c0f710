"""What an event changes: contact, slip and stick, and the relay."""

import math

from models.mole.lanes import block as at
from models.mole.lanes.block import BAR, LANES, MOLE, SOIL, TOUCH, YIELD
from models.mole.lanes.modes import enter, enter_soil, force_on_bar, see
from models.mole.parameters import PHYSICAL
from models.mole.theory.friction import bar_hold, decide, mole_hold, response
from models.mole.theory.soil import (
    APART,
    ELASTIC,
    SLIDING,
    bar_hold_in_soil,
    decide_in_soil,
    mole_hold_in_soil,
    push,
    soil_force,
    started,
    touched,
)
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
def _accelerations(q, bar, mole, force, pushed):
    """Return v' and x' where the soil pushes with F_s [N]."""
    mode, by = response(q, bar, mole), push(q, bar, mole)
    return mode.a * force + mode.b + by.on_bar * pushed, (
        mode.d * force + mode.e + by.on_mole * pushed
    )


@lean
def _denting(q, soil, dent, x):
    """Return the rate of the dent in a mode of the soil [m s-1]."""
    rate = x
    if soil == SLIDING:
        damping = q.soil_damping
        rate = (q.soil_limit - q.soil_stiffness * dent) / damping if damping > 0 else 0.0
    return rate


@lean
def happen_in_soil(which, q, lane, m, y, columns):
    """Change the mode of a lane with soil ahead whose guard `which` has reached zero."""
    bar, mole = m[at.BAR_MODE * LANES + lane], m[at.MOLE_MODE * LANES + lane]
    soil = int(m[at.SOIL_MODE * LANES + lane])
    touching = m[at.TOUCHING * LANES + lane] == 1
    u, v, x = y[at.U * LANES + lane], y[at.V * LANES + lane], y[at.X * LANES + lane]
    dent, front = y[at.DENT * LANES + lane], y[at.FRONT * LANES + lane]
    force, _, _ = force_on_bar(q, touching, u, v, y[at.CURRENT * LANES + lane])
    limit = q.soil_limit
    pushed = soil_force(q, soil, dent, limit, x)
    new_bar, new_mole, new_soil = bar, mole, soil
    stuck, saltates = mole == 0, False
    if which == TOUCH:
        m[at.TOUCHING * LANES + lane] = 0 if touching else 1
        m[at.CONTACTS * LANES + lane] += 0 if touching else 1
        y[at.U * LANES + lane] = q.stop_gap
        see(q, lane, m, y)
    elif which == SOIL and soil == APART:
        dent = front  # to the bit: rounding errors must not part them at once
        y[at.DENT * LANES + lane] = dent
        new_soil = touched(q, dent, limit, x)
        if new_soil != APART and q.soil_damping > 0:
            # The dashpot pushes at once: each interface is judged again.
            here = soil_force(q, new_soil, dent, limit, x)
            new_bar, new_mole = decide_in_soil(q, v, x, force, here)
            saltates = True
    elif which == SOIL:
        new_soil = APART
        y[at.FRONT * LANES + lane] = dent
        if q.soil_damping == 0:
            y[at.FRONT * LANES + lane] = y[at.DENT * LANES + lane] = 0.0
        _pin(lane, y, columns, 1.0, 1.0 if q.soil_damping > 0 else 0.0)
    elif which == YIELD:
        new_soil = SLIDING if soil == ELASTIC else ELASTIC
        if new_soil == SLIDING and q.soil_damping == 0:
            y[at.DENT * LANES + lane] = limit / q.soil_stiffness
            _pin(lane, y, columns, 0.0, 0.0)
    elif which == BAR and bar == 0:
        # The force has just reached its limit: the direction of slip is known.
        new_bar = 1.0 if force + bar_hold_in_soil(q, mole, pushed).offset > 0 else -1.0
        if mole == 0 and q.mole_limit == 0 and pushed == 0:
            # No friction holds the mole, on which the force is still zero.
            new_mole = -new_bar
    elif which == MOLE and mole == 0:
        new_mole = 1 if mole_hold_in_soil(q, bar, pushed).offset - force > 0 else -1
    else:
        saltates = True
        if which == BAR:
            v = 0.0
            y[at.V * LANES + lane] = v
            force, _, _ = force_on_bar(q, touching, u, v, y[at.CURRENT * LANES + lane])
            m[at.LOW * LANES + lane] = min(m[at.LOW * LANES + lane], u)
            m[at.HIGH * LANES + lane] = max(m[at.HIGH * LANES + lane], u)
        else:
            x = 0.0
            y[at.X * LANES + lane] = x
            stuck = True
            new_soil = ELASTIC if soil == SLIDING else soil
            pushed = soil_force(q, soil, dent, limit, x)
        here = soil_force(q, new_soil, dent, limit, x)
        new_bar, new_mole = decide_in_soil(q, v, x, force, here)
    if stuck and x == 0 and which != YIELD:
        new_soil = started(q, new_soil, y[at.FRONT * LANES + lane], dent, limit, new_mole)
    m[at.BAR_MODE * LANES + lane], m[at.MOLE_MODE * LANES + lane] = new_bar, new_mole
    m[at.SOIL_MODE * LANES + lane] = new_soil
    if saltates:
        now = soil_force(q, new_soil, dent, limit, x)
        v_0, x_0 = _accelerations(q, bar, mole, force, pushed)
        v_1, x_1 = _accelerations(q, new_bar, new_mole, force, now)
        dent_0, dent_1 = _denting(q, soil, dent, x), _denting(q, new_soil, dent, x)
        creep = q.soil_stiffness * front / q.soil_damping if which == SOIL else 0.0
        for column in range(columns):
            z = (at.PLAIN + at.OF_SOIL + (at.MEASURED + at.OF_SOIL) * column) * LANES + lane
            if which == SOIL:
                ahead = y[z + at.FRONT_COLUMN * LANES] - y[z + at.DENT_COLUMN * LANES]
                late = ahead / (creep + x)
            elif which == BAR:
                late = -y[z + at.V * LANES] / v_0
            else:
                late = -y[z + at.X * LANES] / x_0
            y[z + at.V * LANES] -= (v_1 - v_0) * late
            y[z + at.X * LANES] -= (x_1 - x_0) * late
            y[z + at.DENT_COLUMN * LANES] -= (dent_1 - dent_0) * late
    enter(q, lane, m, y)
    enter_soil(q, lane, m, y)


@lean
def _pin(lane, y, columns, dent, front):
    """Scale the dent in the tangents, and let the front follow it, or not."""
    for column in range(columns):
        z = (at.PLAIN + at.OF_SOIL + (at.MEASURED + at.OF_SOIL) * column) * LANES + lane
        y[z + at.DENT_COLUMN * LANES] *= dent
        y[z + at.FRONT_COLUMN * LANES] = front * y[z + at.DENT_COLUMN * LANES]


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
