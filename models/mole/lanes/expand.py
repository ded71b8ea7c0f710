"""Taylor series of the motion of a block of moles.

Within a mode v' = a F + b, see `models.mole.theory.friction`; contact and relay are numbers, too,
so that every lane executes the same code. With the flux f = L i, the bar's share A of the
inductance and L' = A',

    u' = v,  v' = a F + b,  f' = p - R i,  p' = V' - i/C,  A' = L' v,

    L' = -2/width^2 u A,  i = (f - A i)/L_0,  F = i^2 L'/2 - c v - k (u - u_0)

all but the first factor of the division are sums of products. The mole's velocity is
a linear function of v and time.
"""

from models.mole.lanes.block import (
    ADDED,
    ADDED_S,
    AREA_S,
    BEND_S,
    COIL,
    COSINE,
    COSINE_S,
    CURRENT,
    CURRENT_S,
    DAMPING,
    DRIVE,
    ELASTANCE,
    FLUX_S,
    FORCE,
    FORCE_S,
    INVERSE,
    LANES,
    MEASURED,
    ORDER,
    P_S,
    PATH_S,
    PLAIN,
    PULL_S,
    RESISTANCE,
    RISE_S,
    SHARED,
    SINE,
    SINE_S,
    SLOPE,
    SPEED,
    SQUARE_S,
    STEP,
    STIFFNESS,
    TERMS,
    TURN_S,
    U_S,
    V_S,
    WORK_S,
    A,
    B,
    P,
    U,
    V,
)
from models.numerics.fma import fma
from models.numerics.jit import lean
from models.numerics.series import sums

products, value, value_and_slope = sums(LANES)
_SERIES = TERMS * LANES
_U, _V, _FLUX, _I = U_S * _SERIES, V_S * _SERIES, FLUX_S * _SERIES, CURRENT_S * _SERIES
_P, _ADDED, _SINE, _COSINE = P_S * _SERIES, ADDED_S * _SERIES, SINE_S * _SERIES, COSINE_S * _SERIES
_RISE, _SQUARE, _FORCE = RISE_S * _SERIES, SQUARE_S * _SERIES, FORCE_S * _SERIES
_BEND, _PULL, _TURN = BEND_S * _SERIES, PULL_S * _SERIES, TURN_S * _SERIES
_PATH, _AREA, _WORK = PATH_S * _SERIES, AREA_S * _SERIES, WORK_S * _SERIES


@lean
def expand(m, y, w):
    """Set the series of the motion."""
    for lane in range(LANES):
        w[_U + lane], w[_V + lane] = y[U * LANES + lane], y[V * LANES + lane]
        w[_P + lane], w[_ADDED + lane] = y[P * LANES + lane], y[ADDED * LANES + lane]
        w[_SINE + lane], w[_COSINE + lane] = y[SINE * LANES + lane], y[COSINE * LANES + lane]
        inductance = m[COIL * LANES + lane] + y[ADDED * LANES + lane]
        w[_FLUX + lane] = inductance * y[CURRENT * LANES + lane]
    for k in range(ORDER):
        at = k * LANES
        after = at + LANES
        for lane in range(LANES):
            w[_I + at + lane] = 0.0
        products(w, k + 1, _ADDED, _U + at, _RISE + at, _I + at, _I + at)
        for lane in range(LANES):
            j = at + lane
            w[_RISE + j] *= m[SLOPE * LANES + lane]
            w[_I + j] = (w[_FLUX + j] - w[_I + j]) * m[INVERSE * LANES + lane]
        products(w, k + 1, _I, _I + at, _SQUARE + at, _P + at, _WORK + after)
        products(w, k + 1, _RISE, _SQUARE + at, _FORCE + at, _V + at, _ADDED + after)
        first = 1.0 if k == 0 else 0.0
        share = 1.0 / (k + 1)
        for lane in range(LANES):
            j, n = at + lane, after + lane
            h = m[STEP * LANES + lane] * share
            force = fma(first, m[FORCE * LANES + lane], 0.5 * w[_FORCE + j])
            force = fma(-m[STIFFNESS * LANES + lane], w[_U + j], force)
            force = fma(-m[DAMPING * LANES + lane], w[_V + j], force)
            w[_FORCE + j] = force
            current, speed = w[_I + j], h * m[SPEED * LANES + lane]
            drive = m[DRIVE * LANES + lane] * w[_COSINE + j]
            w[_U + n] = h * w[_V + j]
            w[_V + n] = h * fma(m[A * LANES + lane], force, first * m[B * LANES + lane])
            w[_FLUX + n] = h * fma(-m[RESISTANCE * LANES + lane], current, w[_P + j])
            w[_P + n] = h * fma(-m[ELASTANCE * LANES + lane], current, drive)
            w[_ADDED + n] *= h
            w[_SINE + n] = speed * w[_COSINE + j]
            w[_COSINE + n] = -speed * w[_SINE + j]
            w[_PATH + n] = h * w[_U + j]
            w[_AREA + n] = h * w[_PATH + j]
            w[_WORK + n] *= h


@lean
def expand_tangents(m, y, w, columns):
    """Set the series of the tangents.

    With dA = L' du: F changes by i^2 L''/2 du + i L' di - c dv - k du, the flux by i L' du + L di.
    """
    for k in range(ORDER):
        at = k * LANES
        products(w, k + 1, _RISE, _U + at, _BEND + at, _I + at, _TURN + at)
        for lane in range(LANES):
            bend = w[_ADDED + at + lane] + w[_BEND + at + lane]
            w[_BEND + at + lane] = 0.5 * m[SLOPE * LANES + lane] * bend
        products(w, k + 1, _SQUARE, _BEND + at, _PULL + at, _BEND + at, _PULL + at)
    for column in range(columns):
        z = (PLAIN + MEASURED * column) * LANES
        du = (SHARED + MEASURED * column) * _SERIES
        dv, flux, di, dp = du + _SERIES, du + 2 * _SERIES, du + 3 * _SERIES, du + 4 * _SERIES
        for lane in range(LANES):
            w[du + lane], w[dv + lane] = y[z + lane], y[z + V * LANES + lane]
            w[dp + lane] = y[z + P * LANES + lane]
            inductance = m[COIL * LANES + lane] + y[ADDED * LANES + lane]
            linked = inductance * y[z + CURRENT * LANES + lane]
            w[flux + lane] = fma(w[_TURN + lane], y[z + lane], linked)
        for k in range(ORDER):
            at = k * LANES
            after = at + LANES
            for lane in range(LANES):
                w[di + at + lane] = 0.0
            products(w, k + 1, _ADDED, di + at, di + at, di + at, di + at)
            products(w, k + 1, du, _TURN + at, flux + after, _PULL + at, dv + after)
            for lane in range(LANES):
                j = at + lane
                rest = w[flux + j] - w[flux + j + LANES] - w[di + j]
                w[di + j] = rest * m[INVERSE * LANES + lane]
            products(w, k + 1, di, _TURN + at, du + after, _TURN + at, flux + after)
            share = 1.0 / (k + 1)
            for lane in range(LANES):
                j, n = at + lane, after + lane
                h = m[STEP * LANES + lane] * share
                force = w[dv + n] + w[flux + n]
                force = fma(-m[STIFFNESS * LANES + lane], w[du + j], force)
                force = fma(-m[DAMPING * LANES + lane], w[dv + j], force)
                w[du + n] = h * w[dv + j]
                w[dv + n] = h * m[A * LANES + lane] * force
                w[flux + n] = h * fma(-m[RESISTANCE * LANES + lane], w[di + j], w[dp + j])
                w[dp + n] = -h * m[ELASTANCE * LANES + lane] * w[di + j]
