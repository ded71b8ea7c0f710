"""Steps of a block of moles: every lane goes as far as its series reaches or its guards allow."""

from collections.abc import Callable
from typing import NamedTuple

from models.mole.lanes import block as at
from models.mole.lanes.block import LANES, MEASURED, ORDER, TERMS
from models.mole.lanes.expand import value
from models.numerics.fma import fma
from models.numerics.jit import inlined, lean

_SERIES = TERMS * LANES
_HERE = at.HERE_S * _SERIES
_PLACE = _HERE + 9 * LANES
_MORE = at.MORE_S * _SERIES


class Moves(NamedTuple):
    """Kernels that advance lanes.

    Attributes
    ----------
    move : kernel
        ``move(m, y, w)`` advances all lanes and adds to their sums.
    tangents : kernel
        ``tangents(m, y, w, columns)``, after `move`.
    """

    move: Callable[..., None]
    tangents: Callable[..., None]


@inlined
def decaying(x):
    """Return exp(-x) for x >= 0, to 1e-14, or 0 if x is more than 64; without branches."""
    y = -(x if x < 64.0 else 64.0) / 128
    e = fma(y, 1 / 6227020800, 1 / 479001600)
    e = fma(y, fma(y, e, 1 / 39916800), 1 / 3628800)
    e = fma(y, fma(y, e, 1 / 362880), 1 / 40320)
    e = fma(y, fma(y, e, 1 / 5040), 1 / 720)
    e = fma(y, fma(y, e, 1 / 120), 1 / 24)
    e = fma(y, fma(y, e, 1 / 6), 1 / 2)
    e = fma(y, fma(y, e, 1.0), 1.0)
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    e *= e
    return e * e if x < 64.0 else 0.0


@lean
def warm(m, w):
    """Add the integral of the square of the current over the step, before lanes `move`."""
    total = _HERE + 10 * LANES
    for lane in range(LANES):
        w[total + lane] = 0.0
    for k in range(ORDER - 1, -1, -1):
        share = 1.0 / (k + 1)
        for lane in range(LANES):
            term = share * w[at.SQUARE_S * _SERIES + k * LANES + lane]
            w[total + lane] = fma(w[total + lane], m[at.REACH * LANES + lane], term)
    for lane in range(LANES):
        time = m[at.REACH * LANES + lane] * m[at.STEP * LANES + lane]
        j = at.SQUARED * LANES + lane
        m[j] = fma(time, w[total + lane], m[j])


def moves(has_soil: bool) -> Moves:
    """Return the kernels that advance lanes with or without soil ahead."""
    plain, measured, shared, column_of = at.lengths_of(has_soil)[:4]

    @lean
    def move(m, y, w):
        for lane in range(LANES):
            w[_PLACE + lane] = m[at.REACH * LANES + lane]
        value(w, ORDER + 1, at.U_S * _SERIES, _PLACE, _HERE)
        value(w, ORDER + 1, at.V_S * _SERIES, _PLACE, _HERE + LANES)
        value(w, ORDER + 1, at.FLUX_S * _SERIES, _PLACE, _HERE + 2 * LANES)
        value(w, ORDER + 1, at.P_S * _SERIES, _PLACE, _HERE + 3 * LANES)
        value(w, ORDER + 1, at.SINE_S * _SERIES, _PLACE, _HERE + 4 * LANES)
        value(w, ORDER + 1, at.COSINE_S * _SERIES, _PLACE, _HERE + 5 * LANES)
        value(w, ORDER + 1, at.PATH_S * _SERIES, _PLACE, _HERE + 6 * LANES)
        value(w, ORDER + 1, at.AREA_S * _SERIES, _PLACE, _HERE + 7 * LANES)
        value(w, ORDER + 1, at.WORK_S * _SERIES, _PLACE, _HERE + 8 * LANES)
        if has_soil:
            value(w, ORDER + 1, at.X_S * _SERIES, _PLACE, _MORE)
            value(w, ORDER + 1, at.WAY_S * _SERIES, _PLACE, _MORE + LANES)
            value(w, ORDER + 1, at.DENT_S * _SERIES, _PLACE, _MORE + 2 * LANES)
            value(w, ORDER + 1, at.FRONT_S * _SERIES, _PLACE, _MORE + 3 * LANES)
            value(w, ORDER + 1, at.RUB_S * _SERIES, _PLACE, _MORE + 4 * LANES)
        for lane in range(LANES):
            time = m[at.REACH * LANES + lane] * m[at.STEP * LANES + lane]
            u_0, v_0 = y[at.U * LANES + lane], y[at.V * LANES + lane]
            x_0, i_0 = y[at.X * LANES + lane], y[at.CURRENT * LANES + lane]
            u, v, flux = w[_HERE + lane], w[_HERE + LANES + lane], w[_HERE + 2 * LANES + lane]
            ratio, drift = m[at.RATIO * LANES + lane], m[at.DRIFT * LANES + lane]
            added = (
                decaying(-0.5 * m[at.SLOPE * LANES + lane] * u * u)
                * m[at.ADDED_MOST * LANES + lane]
            )
            inverse = 1 / (m[at.COIL * LANES + lane] + added)
            m[at.INVERSE * LANES + lane] = inverse
            i = flux * inverse
            y[at.U * LANES + lane], y[at.V * LANES + lane] = u, v
            y[at.X * LANES + lane] = fma(drift, time, fma(ratio, v - v_0, x_0))
            y[at.CURRENT * LANES + lane] = i
            y[at.P * LANES + lane] = w[_HERE + 3 * LANES + lane]
            y[at.SINE * LANES + lane] = w[_HERE + 4 * LANES + lane]
            y[at.COSINE * LANES + lane] = w[_HERE + 5 * LANES + lane]
            y[at.ADDED * LANES + lane] = added
            m[at.TIME * LANES + lane] += time
            m[at.TRIALS * LANES + lane] += 1.0
            # With x = rest + ratio v + drift t: integrals of x, of (u - G) and of (u - G) x.
            rest, gap = fma(-ratio, v_0, x_0), m[at.GAP * LANES + lane]
            deep_0, deep = u_0 - gap, u - gap
            contact = m[at.CONTACT * LANES + lane]
            pressed = fma(-gap, time, w[_HERE + 6 * LANES + lane])
            # By parts: the integral of t u is that of u times the time, less the integral of that.
            later = time * fma(-0.5 * gap, time, w[_HERE + 6 * LANES + lane])
            later -= w[_HERE + 7 * LANES + lane]
            worked = fma(rest, pressed, drift * later)
            worked = fma(0.5 * ratio, (deep - deep_0) * (deep + deep_0), worked)
            path = fma(ratio, u - u_0, fma(0.5 * drift * time, time, rest * time))
            if has_soil:
                path = w[_MORE + LANES + lane]
                worked = fma(-gap, path, w[_MORE + 4 * LANES + lane])
                y[at.X * LANES + lane] = w[_MORE + lane]
                y[at.DENT * LANES + lane] = w[_MORE + 2 * LANES + lane]
                y[at.FRONT * LANES + lane] = w[_MORE + 3 * LANES + lane]
            stored = 0.5 * (flux * i - w[at.FLUX_S * _SERIES + lane] * i_0)
            j = at.SUM * LANES + lane
            m[j + at.PROGRESS * LANES] += path
            m[j + at.IMPACT * LANES] += contact * worked
            m[j + at.ELECTRIC * LANES] += w[_HERE + 8 * LANES + lane] - stored
            m[j + at.IMPULSE * LANES] += contact * pressed

    @lean
    def tangents(m, y, w, columns):
        for column in range(columns):
            z = (plain + measured * column) * LANES
            first = (shared + column_of * column) * _SERIES
            for q in range(MEASURED):
                value(w, ORDER + 1, first + q * _SERIES, _PLACE, _HERE + q * LANES)
            if has_soil:
                for q in range(3):
                    series = first + (MEASURED + q) * _SERIES
                    value(w, ORDER + 1, series, _PLACE, _MORE + q * LANES)
            for lane in range(LANES):
                du, dv = w[_HERE + lane], w[_HERE + LANES + lane]
                flux, dp = w[_HERE + 2 * LANES + lane], w[_HERE + 4 * LANES + lane]
                rise = (
                    m[at.SLOPE * LANES + lane] * y[at.U * LANES + lane] * y[at.ADDED * LANES + lane]
                )
                linked = fma(-rise * y[at.CURRENT * LANES + lane], du, flux)
                j = z + at.X * LANES + lane
                y[j] = fma(m[at.RATIO * LANES + lane], dv - y[z + LANES + lane], y[j])
                if has_soil:
                    y[j] = w[_MORE + lane]
                    y[z + at.DENT_COLUMN * LANES + lane] = w[_MORE + LANES + lane]
                    y[z + at.FRONT_COLUMN * LANES + lane] = w[_MORE + 2 * LANES + lane]
                y[z + lane], y[z + LANES + lane] = du, dv
                y[z + at.CURRENT * LANES + lane] = linked * m[at.INVERSE * LANES + lane]
                y[z + at.P * LANES + lane] = dp

    return Moves(move, tangents)
