"""Rates of change of sixteen moles: straight-line code without branches.

Within a mode v' = a F + b and x' = d F + e, see `models.mole.theory.friction`; contact and relay
are numbers, too, so that every lane executes the same code. Auxiliary variables make the equations
polynomial but for one division: the inductance added by the bar, and sine and cosine of the supply,
are integrated along. The first, which is negligible far from the coil, is reset at the start of
each step; the others whenever the relay switches.
"""

import math
from collections.abc import Callable

from models.mole.lanes.block import (
    ADDED,
    ADDED_MOST,
    COIL,
    CONTACT,
    COSINE,
    CURRENT,
    DAMPING,
    DRIVE,
    ELASTANCE,
    ELECTRIC,
    FORCE,
    GAP,
    IMPACT,
    IMPULSE,
    INTEGRAL,
    JACOBIAN,
    MEASURED,
    PLAIN,
    PROGRESS,
    RESISTANCE,
    SINE,
    SLOPE,
    SPEED,
    STEP,
    STIFFNESS,
    A,
    B,
    D,
    E,
    P,
    U,
    V,
    X,
)
from models.numerics.blocks import LANES
from models.numerics.fma import fma
from models.numerics.jit import lean


@lean
def renew(m, y):
    """Set the inductance added by the bar."""
    for lane in range(LANES):
        u = y[U * LANES + lane]
        share = math.exp(0.5 * m[SLOPE * LANES + lane] * u * u)
        y[ADDED * LANES + lane] = m[ADDED_MOST * LANES + lane] * share


def slopes(columns: int) -> Callable[..., None]:
    """Return the kernel of the rates.

    Parameters
    ----------
    columns : int
        Columns of tangents.

    Returns
    -------
    kernel
        ``slopes(m, y, k, weight)`` sets k to the rates at y times the step, and adds weight times
        the integrands, times the step, to the integrals.
    """

    @lean
    def _slopes(m, y, k, weight):
        for lane in range(LANES):
            h = m[STEP * LANES + lane]
            u, v, x = y[U * LANES + lane], y[V * LANES + lane], y[X * LANES + lane]
            i, p, added = (
                y[CURRENT * LANES + lane],
                y[P * LANES + lane],
                y[ADDED * LANES + lane],
            )
            rise = m[SLOPE * LANES + lane] * u * added
            turn = rise * v
            inverse = 1 / (m[COIL * LANES + lane] + added)
            magnetic = 0.5 * i * i * rise
            resisted = m[RESISTANCE * LANES + lane] + turn
            current = fma(-resisted, i, p) * inverse
            force = fma(-m[STIFFNESS * LANES + lane], u, magnetic + m[FORCE * LANES + lane])
            force = fma(-m[DAMPING * LANES + lane], v, force)
            speed, drive = m[SPEED * LANES + lane], m[DRIVE * LANES + lane]
            k[U * LANES + lane] = h * v
            k[V * LANES + lane] = h * fma(m[A * LANES + lane], force, m[B * LANES + lane])
            k[X * LANES + lane] = h * fma(m[D * LANES + lane], force, m[E * LANES + lane])
            k[CURRENT * LANES + lane] = h * current
            cosine = y[COSINE * LANES + lane]
            k[P * LANES + lane] = h * fma(drive, cosine, -m[ELASTANCE * LANES + lane] * i)
            k[ADDED * LANES + lane] = h * turn
            k[SINE * LANES + lane] = h * speed * cosine
            k[COSINE * LANES + lane] = -h * speed * y[SINE * LANES + lane]
            if weight != 0.0:
                part = weight * h
                contact = m[CONTACT * LANES + lane] * (u - m[GAP * LANES + lane])
                j = INTEGRAL * LANES + lane
                m[j + PROGRESS * LANES] = fma(part, x, m[j + PROGRESS * LANES])
                m[j + IMPACT * LANES] = fma(part * contact, x, m[j + IMPACT * LANES])
                electric = fma(m[RESISTANCE * LANES + lane] * i, i, magnetic * v)
                m[j + ELECTRIC * LANES] = fma(part, electric, m[j + ELECTRIC * LANES])
                m[j + IMPULSE * LANES] = fma(part, contact, m[j + IMPULSE * LANES])
            if columns > 0:
                # Derivatives of F with respect to u and i, of i' with respect to u, v, i, p.
                bend = m[SLOPE * LANES + lane] * added * fma(m[SLOPE * LANES + lane] * u, u, 1.0)
                m[JACOBIAN * LANES + lane] = fma(0.5 * i * i, bend, -m[STIFFNESS * LANES + lane])
                m[(JACOBIAN + 1) * LANES + lane] = i * rise
                m[(JACOBIAN + 2) * LANES + lane] = -fma(i * bend, v, current * rise) * inverse
                m[(JACOBIAN + 3) * LANES + lane] = -i * rise * inverse
                m[(JACOBIAN + 4) * LANES + lane] = -resisted * inverse
                m[(JACOBIAN + 5) * LANES + lane] = inverse
        for column in range(columns):
            z = (PLAIN + MEASURED * column) * LANES
            for lane in range(LANES):
                h = m[STEP * LANES + lane]
                u, v, i = y[z + lane], y[z + LANES + lane], y[z + 3 * LANES + lane]
                force = fma(m[JACOBIAN * LANES + lane], u, m[(JACOBIAN + 1) * LANES + lane] * i)
                force = fma(-m[DAMPING * LANES + lane], v, force)
                current = fma(
                    m[(JACOBIAN + 2) * LANES + lane], u, m[(JACOBIAN + 3) * LANES + lane] * v
                )
                current = fma(m[(JACOBIAN + 4) * LANES + lane], i, current)
                current = fma(m[(JACOBIAN + 5) * LANES + lane], y[z + 4 * LANES + lane], current)
                k[z + lane] = h * v
                k[z + LANES + lane] = h * m[A * LANES + lane] * force
                k[z + 2 * LANES + lane] = h * m[D * LANES + lane] * force
                k[z + 3 * LANES + lane] = h * current
                k[z + 4 * LANES + lane] = -h * m[ELASTANCE * LANES + lane] * i

    return _slopes
