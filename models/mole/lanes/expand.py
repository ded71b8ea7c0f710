"""Taylor series of the motion of a block of moles.

Within a mode v' = a F + b, see `models.mole.theory.friction`; contact and relay are numbers, too,
so that every lane executes the same code. With the flux f = L i, the bar's share A of the
inductance and L' = A',

    u' = v,  v' = a F + b,  f' = p - R i,  p' = V' - i/C,  A' = L' v,

    L' = -2/width^2 u A,  i = (f - A i)/L_0,  F = i^2 L'/2 - c v - k (u - u_0)

all but the first factor of the division are sums of products. The mole's velocity is
a linear function of v and time, except with soil ahead: then it has a series of its own,

    v' = a F + b + s F_s,  x' = d F + e + r F_s,

and F_s, the rates of the dent w - b and of the front z - b are linear in these and x within a mode;
see `models.mole.theory.soil`.
"""

from collections.abc import Callable
from typing import NamedTuple

from models.mole.lanes import block as at
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
    PULL_S,
    RESISTANCE,
    RISE_S,
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
_X, _WAY, _DENT = at.X_S * _SERIES, at.WAY_S * _SERIES, at.DENT_S * _SERIES
_FRONT, _HELD, _RUB = at.FRONT_S * _SERIES, at.HELD_S * _SERIES, at.RUB_S * _SERIES


class Expansions(NamedTuple):
    """Kernels that set the series of the lanes.

    Attributes
    ----------
    motion : kernel
        ``motion(m, y, w)``
    tangents : kernel
        ``tangents(m, y, w, columns)``, after `motion`.
    """

    motion: Callable[..., None]
    tangents: Callable[..., None]


@lean
def _lay(m, y, w):
    """Set the first coefficients."""
    for lane in range(LANES):
        w[_U + lane], w[_V + lane] = y[U * LANES + lane], y[V * LANES + lane]
        w[_P + lane], w[_ADDED + lane] = y[P * LANES + lane], y[ADDED * LANES + lane]
        w[_SINE + lane], w[_COSINE + lane] = y[SINE * LANES + lane], y[COSINE * LANES + lane]
        inductance = m[COIL * LANES + lane] + y[ADDED * LANES + lane]
        w[_FLUX + lane] = inductance * y[CURRENT * LANES + lane]


@lean
def _lay_soil(y, w):
    for lane in range(LANES):
        w[_X + lane] = y[at.X * LANES + lane]
        w[_DENT + lane], w[_FRONT + lane] = y[at.DENT * LANES + lane], y[at.FRONT * LANES + lane]
        w[_WAY + lane] = w[_RUB + lane] = 0.0


@lean
def _push(k, m, w):
    """Continue the series of lanes with soil ahead by one coefficient; add its push to the bar."""
    here = k * LANES
    after = here + LANES
    first = 1.0 if k == 0 else 0.0
    share = 1.0 / (k + 1)
    products(w, k + 1, _U, _X + here, _RUB + after, _X + here, _RUB + after)
    for lane in range(LANES):
        j, n = here + lane, after + lane
        h = m[STEP * LANES + lane] * share
        force, x, dent = w[_FORCE + j], w[_X + j], w[_DENT + j]
        soil = first * m[at.SOIL_1 * LANES + lane]
        soil = fma(m[at.SOIL_DENT * LANES + lane], dent, soil)
        soil = fma(m[at.SOIL_X * LANES + lane], x, soil)
        w[_HELD + j] = fma(m[at.HELD_SOIL * LANES + lane], soil, force)
        w[_V + n] = fma(h * m[at.ON_BAR * LANES + lane], soil, w[_V + n])
        rate = fma(m[at.D * LANES + lane], force, first * m[at.E * LANES + lane])
        w[_X + n] = h * fma(m[at.ON_MOLE * LANES + lane], soil, rate)
        rate = fma(m[at.DENT_X * LANES + lane], x, first * m[at.DENT_1 * LANES + lane])
        w[_DENT + n] = h * fma(m[at.DENT_DENT * LANES + lane], dent, rate)
        w[_FRONT + n] = -h * m[at.RELAX * LANES + lane] * w[_FRONT + j]
        w[_WAY + n] = h * x
        w[_RUB + n] *= h


def expansions(has_soil: bool) -> Expansions:
    """Return the kernels that set the series of lanes with or without soil ahead."""
    lengths = at.lengths_of(has_soil)
    plain, measured, shared, column_of = lengths[:4]

    @lean
    def expand(m, y, w):
        _lay(m, y, w)
        if has_soil:
            _lay_soil(y, w)
        for k in range(ORDER):
            here = k * LANES
            after = here + LANES
            for lane in range(LANES):
                w[_I + here + lane] = 0.0
            products(w, k + 1, _ADDED, _U + here, _RISE + here, _I + here, _I + here)
            for lane in range(LANES):
                j = here + lane
                w[_RISE + j] *= m[SLOPE * LANES + lane]
                w[_I + j] = (w[_FLUX + j] - w[_I + j]) * m[INVERSE * LANES + lane]
            products(w, k + 1, _I, _I + here, _SQUARE + here, _P + here, _WORK + after)
            products(w, k + 1, _RISE, _SQUARE + here, _FORCE + here, _V + here, _ADDED + after)
            first = 1.0 if k == 0 else 0.0
            share = 1.0 / (k + 1)
            for lane in range(LANES):
                j, n = here + lane, after + lane
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
            if has_soil:
                _push(k, m, w)

    @lean
    def expand_tangents(m, y, w, columns):
        """Set the series of the tangents.

        With dA = L' du: F changes by i^2 L''/2 du + i L' di - c dv - k du, the flux by
        i L' du + L di.
        """
        for k in range(ORDER):
            here = k * LANES
            products(w, k + 1, _RISE, _U + here, _BEND + here, _I + here, _TURN + here)
            for lane in range(LANES):
                bend = w[_ADDED + here + lane] + w[_BEND + here + lane]
                w[_BEND + here + lane] = 0.5 * m[SLOPE * LANES + lane] * bend
            products(w, k + 1, _SQUARE, _BEND + here, _PULL + here, _BEND + here, _PULL + here)
        for column in range(columns):
            z = (plain + measured * column) * LANES
            du = (shared + column_of * column) * _SERIES
            dv, flux, di, dp = du + _SERIES, du + 2 * _SERIES, du + 3 * _SERIES, du + 4 * _SERIES
            for lane in range(LANES):
                w[du + lane], w[dv + lane] = y[z + lane], y[z + V * LANES + lane]
                w[dp + lane] = y[z + P * LANES + lane]
                inductance = m[COIL * LANES + lane] + y[ADDED * LANES + lane]
                linked = inductance * y[z + CURRENT * LANES + lane]
                w[flux + lane] = fma(w[_TURN + lane], y[z + lane], linked)
            dx = du + MEASURED * _SERIES
            ddent, dfront = dx + _SERIES, dx + 2 * _SERIES
            if has_soil:
                for lane in range(LANES):
                    w[dx + lane] = y[z + at.X * LANES + lane]
                    w[ddent + lane] = y[z + at.DENT_COLUMN * LANES + lane]
                    w[dfront + lane] = y[z + at.FRONT_COLUMN * LANES + lane]
            for k in range(ORDER):
                here = k * LANES
                after = here + LANES
                for lane in range(LANES):
                    w[di + here + lane] = 0.0
                products(w, k + 1, _ADDED, di + here, di + here, di + here, di + here)
                products(w, k + 1, du, _TURN + here, flux + after, _PULL + here, dv + after)
                for lane in range(LANES):
                    j = here + lane
                    rest = w[flux + j] - w[flux + j + LANES] - w[di + j]
                    w[di + j] = rest * m[INVERSE * LANES + lane]
                products(w, k + 1, di, _TURN + here, du + after, _TURN + here, flux + after)
                share = 1.0 / (k + 1)
                for lane in range(LANES):
                    j, n = here + lane, after + lane
                    h = m[STEP * LANES + lane] * share
                    force = w[dv + n] + w[flux + n]
                    force = fma(-m[STIFFNESS * LANES + lane], w[du + j], force)
                    force = fma(-m[DAMPING * LANES + lane], w[dv + j], force)
                    w[du + n] = h * w[dv + j]
                    w[dv + n] = h * m[A * LANES + lane] * force
                    w[flux + n] = h * fma(-m[RESISTANCE * LANES + lane], w[di + j], w[dp + j])
                    w[dp + n] = -h * m[ELASTANCE * LANES + lane] * w[di + j]
                    if has_soil:
                        x, dent = w[dx + j], w[ddent + j]
                        soil = m[at.SOIL_DENT * LANES + lane] * dent
                        soil = fma(m[at.SOIL_X * LANES + lane], x, soil)
                        w[dv + n] = fma(h * m[at.ON_BAR * LANES + lane], soil, w[dv + n])
                        rate = m[at.D * LANES + lane] * force
                        w[dx + n] = h * fma(m[at.ON_MOLE * LANES + lane], soil, rate)
                        rate = m[at.DENT_DENT * LANES + lane] * dent
                        w[ddent + n] = h * fma(m[at.DENT_X * LANES + lane], x, rate)
                        w[dfront + n] = -h * m[at.RELAX * LANES + lane] * w[dfront + j]

    return Expansions(expand, expand_tangents)
