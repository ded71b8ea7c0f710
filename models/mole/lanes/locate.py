"""Where the step of a lane ends: at the first guard that falls through zero on the way.

Looks have found it between two places; the root of its series is then refined in all lanes at once.
"""

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
)
from models.mole.lanes.expand import value_and_slope
from models.numerics.events import crossing, dip
from models.numerics.fma import fma
from models.numerics.jit import lean

_GRAZE = 0.05  # of a guard at two places: a minimum between them below this is computed exactly
_CLOSE = 1e-7  # of a series' time: Newton's last step
_ITERATIONS = 60
_HALVINGS = 30  # to tell which of several guards is the first
_TRIES = 10  # a guard that opens for less than 1e-12 of a look never opened

_SERIES = TERMS * LANES
_U, _V, _F = at.U_S * _SERIES, at.V_S * _SERIES, at.FORCE_S * _SERIES
_GUARD, _HERE = at.GUARD_S * _SERIES, at.HERE_S * _SERIES
_PLACE = _HERE + 4 * LANES
_LENGTH = 1 / (LOOKS - 1)  # between two looks, of a step
_X, _DENT, _FRONT = at.X_S * _SERIES, at.DENT_S * _SERIES, at.FRONT_S * _SERIES


class Locating(NamedTuple):
    """Kernels that locate the ends of steps.

    Attributes
    ----------
    find : kernel
        ``find(lane, m, y, w)`` chooses the guard that ends the step of a lane, and notes between
        which places.
    refine : kernel
        ``refine(m, w)`` sets where the guards that lanes have met are zero, by Newton's method kept
        in brackets.
    """

    find: Callable[..., None]
    refine: Callable[..., None]


def locating(has_soil: bool) -> Locating:
    """Return the kernels that locate the ends of steps with or without soil ahead."""
    guards = GUARDS if has_soil else WITHOUT_SOIL
    force = at.HELD_S * _SERIES if has_soil else _F

    @lean
    def pose(g, side, lane, m, y):
        """Set a lane's guard, of a force on one side, as a function of u, v, F and time."""
        of_u = of_v = of_f = of_1 = of_t = 0.0
        of_x = of_dent = of_front = 0.0
        if has_soil and g >= SOIL:
            j = (at.SOIL_OF + 4 * (g - SOIL)) * LANES + lane
            of_x, of_dent, of_front, of_1 = m[j], m[j + LANES], m[j + 2 * LANES], m[j + 3 * LANES]
        elif g == TOUCH:
            of_u = -m[at.OPEN * LANES + lane]
            of_1 = m[at.OPEN * LANES + lane] * m[at.GAP * LANES + lane]
        else:
            which = g - BAR
            slip = m[(at.BAR_SLIP + which) * LANES + lane]
            offset = m[(at.BAR_OFFSET + which) * LANES + lane]
            of_f = -side * m[(at.BAR_HOLD + which) * LANES + lane]
            of_1 = m[(at.BAR_LIMIT + which) * LANES + lane] + of_f * offset
            if g == BAR:
                of_v = slip
            elif has_soil:
                of_x = slip
            else:
                of_v = slip * m[at.RATIO * LANES + lane]
                of_1 += slip * y[at.X * LANES + lane] - of_v * y[at.V * LANES + lane]
                of_t = slip * m[at.DRIFT * LANES + lane] * m[at.STEP * LANES + lane]
        m[at.OF_U * LANES + lane], m[at.OF_V * LANES + lane] = of_u, of_v
        m[at.OF_F * LANES + lane] = of_f
        m[at.OF_1 * LANES + lane], m[at.OF_T * LANES + lane] = of_1, of_t
        if has_soil:
            m[at.OF_X * LANES + lane] = of_x
            m[at.OF_DENT * LANES + lane], m[at.OF_FRONT * LANES + lane] = of_dent, of_front

    @lean
    def term_of(k, lane, m, w):
        """Return a coefficient of a lane's guard."""
        j = k * LANES + lane
        term = fma(m[at.OF_V * LANES + lane], w[_V + j], m[at.OF_F * LANES + lane] * w[force + j])
        term = fma(m[at.OF_U * LANES + lane], w[_U + j], term)
        if has_soil:
            term = fma(m[at.OF_X * LANES + lane], w[_X + j], term)
            term = fma(m[at.OF_DENT * LANES + lane], w[_DENT + j], term)
            term = fma(m[at.OF_FRONT * LANES + lane], w[_FRONT + j], term)
        if k == 0:
            term += m[at.OF_1 * LANES + lane]
        elif k == 1:
            term += m[at.OF_T * LANES + lane]
        return term

    @lean
    def height_at(lane, place, m, w):
        """Return the guard of a lane somewhere."""
        total = 0.0
        for k in range(ORDER, -1, -1):
            total = fma(total, place, term_of(k, lane, m, w))
        return total

    @lean
    def narrow(lane, left, right, m, w):
        """Return two close places between which the guard of a lane falls through zero."""
        for _ in range(_HALVINGS):
            middle = 0.5 * (left + right)
            if height_at(lane, middle, m, w) > 0:
                left = middle
            else:
                right = middle
        return left, right

    @lean
    def bottom_near(lane, place, m, w):
        """Return where the guard of a lane is lowest, close to a place, and its value there."""
        height = slope = bend = 0.0
        for k in range(ORDER, -1, -1):
            bend = fma(bend, place, slope)
            slope = fma(slope, place, height)
            height = fma(height, place, term_of(k, lane, m, w))
        step = -0.5 * slope / bend
        return place + step, fma(0.5 * slope, step, height)

    @lean
    def low_point(g, side, left, g_0, d_0, g_1, d_1, lane, m, y, w):
        """Return where a guard that falls and rises is lowest, if that is below zero; else -1."""
        bottom, lowest = dip(g_0, d_0, g_1, d_1)
        if lowest < _GRAZE * min(g_0, g_1):
            pose(g, side, lane, m, y)
            length = _LENGTH * m[at.MOST * LANES + lane]
            bottom, lowest = bottom_near(lane, left + bottom * length, m, w)
            if lowest < 0 and left < bottom < left + length:
                return bottom
        return -1.0

    @lean
    def bracket(g, place, several, lane, m, y, w):
        """Return two places between which a guard falls through zero, about where, and its side.

        It falls nowhere if the third is -1. A force that an interface holds has its limits on two
        sides, 1 and -1.
        """
        j = (at.VALUE + GUARDS * place + g) * LANES + lane
        k = (at.RATE + GUARDS * place + g) * LANES + lane
        g_0, g_1 = m[j - GUARDS * LANES], m[j]
        d_0, d_1 = m[k - GUARDS * LANES], m[k]
        length = _LENGTH * m[at.MOST * LANES + lane]
        right = place * length
        left, side = right - length, 1.0
        if TOUCH < g <= MOLE and m[(at.BAR_HOLD + g - BAR) * LANES + lane] > 0:
            j = (g - BAR) * LANES + lane
            offset, both = m[at.BAR_OFFSET * LANES + j], 2 * m[at.BAR_LIMIT * LANES + j]
            side = 1.0 if m[(at.PRESSED + place) * LANES + lane] + offset > 0 else -1.0
            before = 1.0 if m[(at.PRESSED + place - 1) * LANES + lane] + offset > 0 else -1.0
            far, fall = both - g_0, -d_0
            if side != before:
                far, fall, g_0, d_0 = g_0, d_0, far, fall
            if fall < 0 and d_1 < 0 and far > 0:
                bottom = low_point(g, -side, left, far, fall, both - g_1, -d_1, lane, m, y, w)
                if bottom > 0:
                    return left, bottom, 0.5 * (left + bottom), -side
        if g_1 < 0 and g_0 > 0:
            here = crossing(g_0, d_0, g_1, d_1) if several else g_0 / (g_0 - g_1)
            return left, right, left + length * here, side
        if g_1 < 0:
            # Just begun, it opens and closes before the look, or never opens.
            pose(g, side, lane, m, y)
            for _ in range(_TRIES):
                left = right / 16
                if height_at(lane, left, m, w) > 0:
                    bend = term_of(2, lane, m, w)
                    here = -term_of(1, lane, m, w) / bend if bend < 0 else right
                    return left, right, min(max(here, left), right), side
                right = left
            return 0.0, 0.0, 0.0, side
        if d_0 < 0 and d_1 > 0 and g_0 > 0:
            bottom = low_point(g, side, left, g_0, d_0, g_1, d_1, lane, m, y, w)
            if bottom > 0:
                return left, bottom, 0.5 * (left + bottom), side
        return left, right, -1.0, side

    @lean
    def find(lane, m, y, w):
        guard, seen, guess = -1, 1.0, 0.0
        marks = int(m[at.LOOK * LANES + lane])
        early, late = marks % 2**GUARDS, marks // 2**GUARDS
        several = (early | late) & ((early | late) - 1)
        for g in range(guards):
            if not (early | late) >> g & 1:
                continue
            left, right, here, side = 0.0, 0.0, -1.0, 1.0
            if early >> g & 1:
                left, right, here, side = bracket(g, 1, several, lane, m, y, w)
            if here < 0 and late >> g & 1:
                left, right, here, side = bracket(g, 2, several, lane, m, y, w)
            if here > 0 and several:
                # A guess is not enough: a body would move on with a velocity below zero.
                pose(g, side, lane, m, y)
                left, right = narrow(lane, left, right, m, w)
                here = right
            if here >= 0 and (guard < 0 or here < guess):
                guard, seen, guess = g, side, here
                m[at.LEFT * LANES + lane], m[at.RIGHT * LANES + lane] = left, right
        m[at.MET * LANES + lane] = guard
        if guard >= 0:
            m[at.REACH * LANES + lane] = guess
            pose(guard, seen, lane, m, y)

    @lean
    def refine(m, w):
        for k in range(ORDER + 1):
            for lane in range(LANES):
                j = k * LANES + lane
                term = fma(
                    m[at.OF_V * LANES + lane], w[_V + j], m[at.OF_F * LANES + lane] * w[force + j]
                )
                term = fma(m[at.OF_U * LANES + lane], w[_U + j], term)
                if has_soil:
                    term = fma(m[at.OF_X * LANES + lane], w[_X + j], term)
                    term = fma(m[at.OF_DENT * LANES + lane], w[_DENT + j], term)
                    term = fma(m[at.OF_FRONT * LANES + lane], w[_FRONT + j], term)
                w[_GUARD + j] = term
        for lane in range(LANES):
            w[_GUARD + lane] += m[at.OF_1 * LANES + lane]
            w[_GUARD + LANES + lane] += m[at.OF_T * LANES + lane]
            met = m[at.MET * LANES + lane] >= 0
            m[at.LOOK * LANES + lane] = 1.0 if met else 0.0
        for _ in range(_ITERATIONS):
            for lane in range(LANES):
                w[_PLACE + lane] = m[at.REACH * LANES + lane]
            value_and_slope(w, ORDER + 1, _GUARD, _PLACE, _HERE, _HERE + LANES)
            going = 0  # an integer: sums of floats are not vectorised
            for lane in range(LANES):
                height, slope = w[_HERE + lane], w[_HERE + LANES + lane]
                place, here = m[at.REACH * LANES + lane], m[at.LOOK * LANES + lane] == 1.0
                left, right = m[at.LEFT * LANES + lane], m[at.RIGHT * LANES + lane]
                left = place if height > 0 else left
                right = right if height > 0 else place
                step = -height / slope if slope < 0 else right - left
                new = place + step
                near = abs(step) < _CLOSE
                new = new if near | ((left < new) & (new < right)) else 0.5 * (left + right)
                near |= right - left < _CLOSE * _CLOSE
                m[at.LEFT * LANES + lane] = left if here else m[at.LEFT * LANES + lane]
                m[at.RIGHT * LANES + lane] = right if here else m[at.RIGHT * LANES + lane]
                m[at.REACH * LANES + lane] = new if here else place
                still = here & (not near)
                m[at.LOOK * LANES + lane] = 1.0 if still else 0.0
                going += 1 if still else 0
            if going == 0:
                break
        for lane in range(LANES):
            late = m[at.REACH * LANES + lane] > m[at.MOST * LANES + lane]
            m[at.MET * LANES + lane] = -1.0 if late else m[at.MET * LANES + lane]
            reach = m[at.MOST * LANES + lane] if late else m[at.REACH * LANES + lane]
            m[at.REACH * LANES + lane] = reach

    return Locating(find, refine)
