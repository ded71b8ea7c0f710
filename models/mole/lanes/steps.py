"""Decisions after a trial step of sixteen moles, lane by lane."""

import math

import numpy as np

from models.mole.lanes import block as at
from models.mole.lanes.block import GUARDS, INTEGRALS, LANES
from models.mole.lanes.events import happen, turn_relay
from models.mole.lanes.modes import mole_of
from models.numerics.events import crossing, dip
from models.numerics.jit import lean

_SAFETY, _SHRINK, _GROW = 0.9, 0.2, 5.0
_LOCATED = 1e-6  # of the longest step: distance to an event that is bridged to first order
_LOST = 1e-9  # of the longest step: a guard positive for less than this never opened
_DONE = 1 - 1e-12  # of half a control period: the rest is rounding error
_GRAZE = 0.05  # of a guard at the ends of a step: a minimum below this must end a step
_LOW = 0.75  # of a guard: a smaller extrapolated fall needs no check for a minimum


@lean
def next_step(lane, m, wish):
    """Choose the next step of a lane: as wished, within bounds, up to the switching if near."""
    h = min(wish, m[at.LONGEST * LANES + lane], m[at.COIL_STEP * LANES + lane])
    rest = m[at.HALF_PERIOD * LANES + lane] - m[at.TIME * LANES + lane]
    m[at.STEP * LANES + lane] = rest if rest <= h * 1.000001 else h


@lean
def accept(m, error):
    """Accept the steps of all lanes that met no event; mark the others."""
    for lane in range(LANES):
        h, time = m[at.STEP * LANES + lane], m[at.TIME * LANES + lane]
        crossed = m[at.END * LANES + lane] < 0
        crossed |= m[(at.END + 1) * LANES + lane] < 0
        crossed |= m[(at.END + 2) * LANES + lane] < 0
        for g in range(GUARDS):
            # A guard that falls and rises again, and would have come near zero at its first rate.
            start = m[(at.START + g) * LANES + lane]
            fall = m[(at.START_RATE + g) * LANES + lane] * h
            crossed |= (fall < -_LOW * start) & (m[(at.END_RATE + g) * LANES + lane] > 0)
        half = m[at.HALF_PERIOD * LANES + lane]
        good = (error[lane] <= 1.0) & (m[at.TARGET * LANES + lane] < 0) & (time + h < _DONE * half)
        taken = good & (not crossed)
        m[at.LOOK * LANES + lane] = 0.0 if taken else 1.0
        m[at.TRIALS * LANES + lane] += 1.0
        step = h if taken else 0.0
        m[at.TIME * LANES + lane] = time + step
        # The error estimate grows with the eighth power of the step.
        least = error[lane] if error[lane] > 1e-9 else 1e-9
        factor = _SAFETY / math.sqrt(math.sqrt(math.sqrt(least)))
        factor = factor if factor < _GROW else _GROW
        wish = h * factor if taken else m[at.WISH * LANES + lane]
        m[at.WISH * LANES + lane] = wish
        longest = m[at.LONGEST * LANES + lane]
        wish = wish if wish < longest else longest
        most = m[at.COIL_STEP * LANES + lane]
        wish = wish if wish < most else most
        rest = half - (time + step)
        wish = rest if rest <= wish * 1.000001 else wish
        m[at.STEP * LANES + lane] = wish if taken else h
        inverse = 1.0 / h if taken else 0.0
        for g in range(GUARDS):
            j, e = (at.START + g) * LANES + lane, (at.END + g) * LANES + lane
            m[j] = m[e] if taken else m[j]
            j, e = (at.START_RATE + g) * LANES + lane, (at.END_RATE + g) * LANES + lane
            m[j] = m[e] * inverse if taken else m[j]


@lean
def _add_rest(lane, rest, m, y):
    """Account for the short time between the end of a located step and its event."""
    u, v, x = y[at.U * LANES + lane], y[at.V * LANES + lane], y[at.X * LANES + lane]
    i, added = y[at.CURRENT * LANES + lane], y[at.ADDED * LANES + lane]
    magnetic = 0.5 * i * i * m[at.SLOPE * LANES + lane] * u * added
    contact = m[at.CONTACT * LANES + lane] * (u - m[at.GAP * LANES + lane])
    electric = m[at.RESISTANCE * LANES + lane] * i * i + magnetic * v
    m[at.TIME * LANES + lane] += rest
    m[(at.SUM + at.PROGRESS) * LANES + lane] += rest * x
    m[(at.SUM + at.IMPACT) * LANES + lane] += rest * contact * x
    m[(at.SUM + at.ELECTRIC) * LANES + lane] += rest * electric
    m[(at.SUM + at.IMPULSE) * LANES + lane] += rest * contact


@lean
def conclude(lane, table, m, y, new, end, error, size, columns):
    """Treat a lane whose step was not yet accepted; return whether half a control period ended."""
    h, target = m[at.STEP * LANES + lane], int(m[at.TARGET * LANES + lane])
    m[at.TARGET * LANES + lane] = -1
    if not error <= 1.0:
        factor = _SAFETY * error**-0.125
        factor = factor if factor > _SHRINK else _SHRINK
        m[at.WISH * LANES + lane] = m[at.STEP * LANES + lane] = h * factor
        return False
    longest = m[at.LONGEST * LANES + lane]
    # The first guard that became negative, or came near it on the way.
    which, place = -1, 1.0
    for g in range(GUARDS):
        g_0, g_1 = m[(at.START + g) * LANES + lane], m[(at.END + g) * LANES + lane]
        d_0 = m[(at.START_RATE + g) * LANES + lane] * h
        d_1 = m[(at.END_RATE + g) * LANES + lane]
        if g_1 < 0:
            # It opens and closes within the step: try a shorter one.
            here = crossing(g_0, d_0, g_1, d_1) if g_0 > 0 else 0.25
            if which < 0 or here < place:
                which, place = g, here
        elif d_0 < 0 and d_1 > 0 and g_0 > 0:
            here, lowest = dip(g_0, d_0, g_1, d_1)
            near = lowest < _GRAZE * min(g_0, g_1) and 1e-3 < here < 0.999
            near = near and h > _LOCATED * longest
            if near and (which < 0 or here < place):
                which, place = g, here
    met, rest = -1, 0.0
    if target >= 0 and (which < 0 or which == target):
        g_1, d_1 = (
            m[(at.END + target) * LANES + lane],
            m[(at.END_RATE + target) * LANES + lane],
        )
        rest = -g_1 * h / d_1 if d_1 < 0 else np.inf
        met = target if abs(rest) <= _LOCATED * longest else -1
    if met < 0 and which >= 0 and h * place < _LOST * longest:
        met, rest = which, 0.0
    if met < 0 and which >= 0:
        m[at.TARGET * LANES + lane] = which
        m[at.STEP * LANES + lane] = place * h
        return False

    for j in range(size):
        y[j * LANES + lane] = new[j * LANES + lane]
    for j in range(INTEGRALS):
        m[(at.SUM + j) * LANES + lane] += m[(at.INTEGRAL + j) * LANES + lane]
    m[at.TIME * LANES + lane] += h
    factor = _SAFETY * error**-0.125 if error > 1e-9 else _GROW
    wish = max(m[at.WISH * LANES + lane], h * min(factor, _GROW))
    m[at.WISH * LANES + lane] = wish
    if met >= 0:
        for j in range(size):
            y[j * LANES + lane] += rest / h * end[j * LANES + lane]
        _add_rest(lane, rest, m, y)
        happen(met, mole_of(table, int(m[at.ROW * LANES + lane])), lane, m, y, columns)
    else:
        for g in range(GUARDS):
            m[(at.START + g) * LANES + lane] = m[(at.END + g) * LANES + lane]
            rate = m[(at.END_RATE + g) * LANES + lane]
            m[(at.START_RATE + g) * LANES + lane] = rate / h
        if target >= 0:
            # Just short of the event: the next step shall end there.
            m[at.TARGET * LANES + lane] = target
            wish = min(wish, rest)
    ended = m[at.TIME * LANES + lane] >= _DONE * m[at.HALF_PERIOD * LANES + lane]
    if ended:
        turn_relay(mole_of(table, int(m[at.ROW * LANES + lane])), lane, m, y)
    next_step(lane, m, wish)
    return ended
