"""Evaluation of the series of a step: its admissible length, and guards that fall through zero.

A guard is positive while its part of the mode lasts: the distance to the stop; the slip velocity of
an interface in its direction, or the friction limit less the force required for sticking.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

from models.mole.lanes import block as at
from models.mole.lanes.block import (
    BAR,
    GUARDS,
    LANES,
    LOOKS,
    MOLE,
    ORDER,
    SOIL,
    TERMS,
    TOUCH,
    WITHOUT_SOIL,
    YIELD,
)
from models.mole.lanes.expand import value, value_and_slope
from models.mole.lanes.modes import mole_of, relax
from models.mole.theory.equations import coil_step
from models.numerics.fma import fma
from models.numerics.jit import lean

_SAFETY, _GROW = 0.9, 5.0
_BEFORE = 0.2  # weight of the last term but one in the error of a series
_DIP = 0.75  # of the height above the tangents at both ends: a dip below it needs a closer look

_SERIES = TERMS * LANES
_U, _V, _F = at.U_S * _SERIES, at.V_S * _SERIES, at.FORCE_S * _SERIES
_HERE = at.HERE_S * _SERIES  # u, v, F and the slope of F somewhere
_PLACE = _HERE + 4 * LANES
_LENGTH = 1 / (LOOKS - 1)  # between two looks, of a step
# With soil ahead, the change of v, and x, dent and front with theirs.
_X, _DENT, _FRONT = at.X_S * _SERIES, at.DENT_S * _SERIES, at.FRONT_S * _SERIES
_MORE = at.MORE_S * _SERIES


class Looks(NamedTuple):
    """Kernels that limit steps and look at guards.

    Attributes
    ----------
    limit_step : kernel
        ``limit_step(m, w)`` chooses the admissible length of each lane's step, and the step of its
        next series.
    look : kernel
        ``look(m, y, w)`` sets the guards and their rates along the step, and marks lanes in which
        one may end it. Beyond the step, where the series is wrong, they may seem to hold.
    next_step : kernel
        ``next_step(task, lane, m, y)`` chooses the step of a lane's next series: as wished, within
        bounds.
    """

    limit_step: Callable[..., None]
    look: Callable[..., None]
    next_step: Callable[..., None]


@lean
def _dips(g_0, d_0, g_1, d_1):
    """Return whether a guard falls far and rises again: its tangents at both ends meet low."""
    meet = -d_0 * d_1 > _DIP * (d_1 * g_0 - d_0 * g_1)
    return (d_0 < 0) & (d_1 > 0) & meet


def _judge(place: int, has_soil: bool) -> Callable[..., None]:
    """Return the kernel that sets the guards at one place, and their change until the next.

    It marks lanes in which a guard falls below zero between the previous place and this.
    """
    values, rates = (at.VALUE + GUARDS * place) * LANES, (at.RATE + GUARDS * place) * LANES
    guards = GUARDS if has_soil else WITHOUT_SOIL

    @lean
    def judge(m, y, w):
        for lane in range(LANES):
            length = _LENGTH * m[at.MOST * LANES + lane]
            h = length * m[at.STEP * LANES + lane]
            u, v = w[_HERE + lane], w[_HERE + LANES + lane]
            force, change = w[_HERE + 2 * LANES + lane], length * w[_HERE + 3 * LANES + lane]
            m[(at.PRESSED + place) * LANES + lane] = force
            ratio, drift = m[at.RATIO * LANES + lane], h * m[at.DRIFT * LANES + lane]
            x = fma(ratio, v - y[at.V * LANES + lane], y[at.X * LANES + lane])
            x = fma(drift, place, x)
            rate = h * fma(m[at.A * LANES + lane], force, m[at.B * LANES + lane])
            speeding = fma(ratio, rate, drift)
            if has_soil:
                rate = length * w[_MORE + lane]
                x, speeding = w[_MORE + LANES + lane], length * w[_MORE + 2 * LANES + lane]
            open_ = m[at.OPEN * LANES + lane]
            m[values + TOUCH * LANES + lane] = open_ * (m[at.GAP * LANES + lane] - u)
            m[rates + TOUCH * LANES + lane] = -open_ * h * v
            slip, hold = m[at.BAR_SLIP * LANES + lane], m[at.BAR_HOLD * LANES + lane]
            load = force + m[at.BAR_OFFSET * LANES + lane]
            side = hold if load > 0 else -hold
            spare = fma(-side, load, m[at.BAR_LIMIT * LANES + lane])
            m[values + BAR * LANES + lane] = fma(slip, v, spare)
            m[rates + BAR * LANES + lane] = fma(slip, rate, -side * change)
            slip, hold = m[at.MOLE_SLIP * LANES + lane], m[at.MOLE_HOLD * LANES + lane]
            load = force + m[at.MOLE_OFFSET * LANES + lane]
            side = hold if load > 0 else -hold
            spare = fma(-side, load, m[at.MOLE_LIMIT * LANES + lane])
            m[values + MOLE * LANES + lane] = fma(slip, x, spare)
            m[rates + MOLE * LANES + lane] = fma(slip, speeding, -side * change)
            if has_soil:
                dent, denting = w[_MORE + 3 * LANES + lane], length * w[_MORE + 4 * LANES + lane]
                front, fronting = w[_MORE + 5 * LANES + lane], length * w[_MORE + 6 * LANES + lane]
                for g in range(SOIL, YIELD + 1):
                    j = (at.SOIL_OF + 4 * (g - SOIL)) * LANES + lane
                    height = fma(m[j], x, m[j + 3 * LANES])
                    height = fma(m[j + LANES], dent, height)
                    m[values + g * LANES + lane] = fma(m[j + 2 * LANES], front, height)
                    slope = fma(m[j], speeding, m[j + LANES] * denting)
                    m[rates + g * LANES + lane] = fma(m[j + 2 * LANES], fronting, slope)
        if place > 0:
            before = GUARDS * LANES
            pressed = (at.PRESSED + place) * LANES
            for lane in range(LANES):
                marked = 0.0
                for g in range(guards):
                    j = g * LANES + lane
                    g_0, g_1 = m[values + j - before], m[values + j]
                    d_0, d_1 = m[rates + j - before], m[rates + j]
                    ends = (g_1 < 0) | _dips(g_0, d_0, g_1, d_1)
                    if TOUCH < g <= MOLE:
                        # On the way, the force may have been at the limit on its other side.
                        j = (g - BAR) * LANES + lane
                        held = m[at.BAR_HOLD * LANES + j] > 0
                        offset = m[at.BAR_OFFSET * LANES + j]
                        turned = (m[pressed - LANES + lane] > -offset) != (
                            m[pressed + lane] > -offset
                        )
                        both = 2 * m[at.BAR_LIMIT * LANES + j]
                        far_0, fall_0 = both - g_0, -d_0
                        near_0, near_fall = (far_0, fall_0) if turned else (g_0, d_0)
                        far_0, fall_0 = (g_0, d_0) if turned else (far_0, fall_0)
                        ends |= held & _dips(near_0, near_fall, g_1, d_1)
                        ends |= held & _dips(far_0, fall_0, both - g_1, -d_1)
                    marked += 2.0 ** (g + GUARDS * (place - 1)) if ends else 0.0
                earlier = m[at.LOOK * LANES + lane] if place > 1 else 0.0
                m[at.LOOK * LANES + lane] = earlier + marked

    return judge


@lean
def _evaluate(w):
    value(w, ORDER + 1, _U, _PLACE, _HERE)
    value(w, ORDER + 1, _V, _PLACE, _HERE + LANES)
    value_and_slope(w, ORDER, _F, _PLACE, _HERE + 2 * LANES, _HERE + 3 * LANES)


@lean
def _evaluate_in_soil(w):
    value(w, ORDER + 1, _U, _PLACE, _HERE)
    value_and_slope(w, ORDER + 1, _V, _PLACE, _HERE + LANES, _MORE)
    value_and_slope(w, ORDER, at.HELD_S * _SERIES, _PLACE, _HERE + 2 * LANES, _HERE + 3 * LANES)
    value_and_slope(w, ORDER + 1, _X, _PLACE, _MORE + LANES, _MORE + 2 * LANES)
    value_and_slope(w, ORDER + 1, _DENT, _PLACE, _MORE + 3 * LANES, _MORE + 4 * LANES)
    value_and_slope(w, ORDER + 1, _FRONT, _PLACE, _MORE + 5 * LANES, _MORE + 6 * LANES)


def looks(has_soil: bool) -> Looks:
    """Return the kernels that look at the guards of lanes with or without soil ahead."""
    judge_begin, judge_middle, judge_end = (_judge(place, has_soil) for place in range(LOOKS))
    evaluate = _evaluate_in_soil if has_soil else _evaluate
    force = at.HELD_S * _SERIES if has_soil else _F

    @lean
    def limit_step(m, w):
        last = ORDER * LANES
        for lane in range(LANES):
            error = 0.0
            for q in range(at.WATCHED):
                j = (at.U_S + q) * _SERIES + last + lane
                size = max(abs(w[j]), _BEFORE * abs(w[j - LANES]))
                error = max(error, size * m[(at.SHARE + q) * LANES + lane])
            if has_soil:
                for q in range(2):
                    j = (at.DENT_S if q else at.X_S) * _SERIES + last + lane
                    size = max(abs(w[j]), _BEFORE * abs(w[j - LANES]))
                    error = max(error, size * m[(at.SHARE_X + q) * LANES + lane])
            least = error if error > 1e-9 else 1e-9
            factor = _SAFETY / math.sqrt(math.sqrt(math.sqrt(least)))
            h = m[at.STEP * LANES + lane]
            m[at.WISH * LANES + lane] = h * min(factor, _GROW)
            rest = m[at.HALF_PERIOD * LANES + lane] - m[at.TIME * LANES + lane]
            reach = h if error <= 1.0 else h * factor
            reach = rest if rest <= reach * 1.000001 else reach
            m[at.REACH * LANES + lane] = m[at.MOST * LANES + lane] = reach / h
            m[at.MET * LANES + lane] = -1.0

    @lean
    def look(m, y, w):
        for lane in range(LANES):
            w[_HERE + lane], w[_HERE + LANES + lane] = w[_U + lane], w[_V + lane]
            w[_HERE + 2 * LANES + lane] = w[force + lane]
            w[_HERE + 3 * LANES + lane] = w[force + LANES + lane]
            w[_PLACE + lane] = _LENGTH * m[at.MOST * LANES + lane]
            if has_soil:
                w[_MORE + lane] = w[_V + LANES + lane]
                for q in range(3):
                    j = (at.X_S if q == 0 else at.DENT_S if q == 1 else at.FRONT_S) * _SERIES
                    w[_MORE + (2 * q + 1) * LANES + lane] = w[j + lane]
                    w[_MORE + (2 * q + 2) * LANES + lane] = w[j + LANES + lane]
        judge_begin(m, y, w)
        evaluate(w)
        judge_middle(m, y, w)
        for lane in range(LANES):
            w[_PLACE + lane] = m[at.MOST * LANES + lane]
        evaluate(w)
        judge_end(m, y, w)

    @lean
    def next_step(task, lane, m, y):
        u, v = y[at.U * LANES + lane], y[at.V * LANES + lane]
        h = min(m[at.WISH * LANES + lane], m[at.LONGEST * LANES + lane])
        if has_soil:
            row = int(m[at.ROW * LANES + lane])
            if row >= 0:
                h = min(h, relax(mole_of(task.table, row), lane, m, y))
        m[at.STEP * LANES + lane] = min(h, coil_step(u, v, m[at.WIDTH * LANES + lane]))

    return Looks(limit_step, look, next_step)
