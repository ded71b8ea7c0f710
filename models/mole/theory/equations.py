"""Equations of motion (1), (2), (4), (10), (12), (16), (17) of Ho, Nguyen & Woo 2011, in a mode.

A mode states whether the bar touches the stop, whether the relay is closed, and how each interface
slips. With p, the source voltage less the capacitor's, which is that across resistance and coil,

    L i' = p - (R + L'(u) v) i,    p' = V' - i/C,

the circuit requires neither v' nor L''(u) of (15).
"""

import math
from typing import NamedTuple

from models.mole.theory.friction import Hold, Response, bar_hold, mole_hold, response
from models.mole.theory.soil import APART, RELAXED, SLIDING, Push, push, soil_force
from models.mole.theory.system import Mole
from models.numerics.jit import inlined, kernel

DISPLACEMENT, VELOCITY, MOLE_VELOCITY, CURRENT, VOLTAGE, MOLE_DISPLACEMENT = range(6)
"""u [m], v, x [m s-1], i [A], p [V], w [m]: the first part of a state; nothing depends on w. The
second part holds energies since the start [J]:
"""
IMPACT_WORK, ELECTRICAL_WORK, MAGNETIC_WORK, FRICTION_LOSS, VISCOUS_LOSS = range(6, 11)
"""Work of the contact force on the mole, of the supply less the energy stored in coil and
capacitor, and of the magnetic force on the bar; heat from dry friction and from viscous damping."""
IMPULSE = 11
"""Impulse of the contact force since the start [N s]."""
SIZE = 12
SOIL_FRONT, SOIL_BASE, SOIL_LOSS = range(12, 15)
"""z, b [m], and heat in the soil [J]: the third part, only of a mole with soil ahead."""
SIZE_IN_SOIL = 15

_FAR = 8.0  # widths of the coil, beyond which the bar adds less than 1e-14 of its inductance


class Coil(NamedTuple):
    """Inductance (10) of the coil and its derivative with respect to u.

    Attributes
    ----------
    inductance : float
        L [H]
    slope : float
        L' [H m-1]
    """

    inductance: float
    slope: float


class Mode(NamedTuple):
    """What is constant between two events.

    Attributes
    ----------
    q : Mole
    contact : bool
        Whether the bar touches the stop.
    relay : bool
        Whether the supply is connected.
    bar, mole : int
        Direction of slip: 1, -1, or 0 if they stick.
    response : Response
    bar_hold, mole_hold : Hold
        The latter is meaningless while the bar sticks: then no force makes the mole slip. Both are
        without the force of the soil.
    soil : int
        `APART`, `ELASTIC` or `SLIDING`, of `models.mole.theory.soil`.
    push : Push
    """

    q: Mole
    contact: bool
    relay: bool
    bar: int
    mole: int
    response: Response
    bar_hold: Hold
    mole_hold: Hold
    soil: int
    push: Push


@kernel
def mode(q, contact, relay, bar, mole, soil):
    """Return the `Mode` of a mole q."""
    return Mode(
        q,
        contact,
        relay,
        bar,
        mole,
        response(q, bar, mole),
        bar_hold(q, mole),
        mole_hold(q, bar),
        soil,
        push(q, bar, mole),
    )


@kernel
def coil(q, u):
    """Return the `Coil` with the bar at u."""
    bar = q.bar_inductance * math.exp(-q.sharpness * u * u)
    slope = -2 * q.sharpness * u * bar
    return Coil(q.coil_inductance + bar, slope)


@inlined
def coil_step(u, v, width):
    """Return the longest step [s] in which a bar cannot cross the coil unnoticed.

    Parameters
    ----------
    u, v : float
        [m], [m s-1]
    width : float
        Half of sigma: the standard deviation of the Gaussian L - L0 [m].
    """
    room = abs(u) - _FAR * width
    room = room if room > width else width
    return room / abs(v)


@kernel
def contact_force(q, contact, u):
    """Return the force of the stop on the mole, and of the bar on the stop (4) [N]."""
    return q.contact_stiffness * (u - q.stop_gap) if contact else 0.0


@kernel
def force(q, contact, u, v, i):
    """Return the force F on the bar without friction (16) [N]."""
    magnetic = 0.5 * i * i * coil(q, u).slope
    spring = q.spring_stiffness * (u - q.spring_rest)
    return magnetic - q.damping * v - spring - contact_force(q, contact, u)


@kernel
def rates(t, y, mode, dy):
    """Set dy to the time derivative of a state y in a mode."""
    q = mode.q
    u, v, x, i, p = y[0], y[1], y[2], y[3], y[4]
    now = coil(q, u)
    magnetic = 0.5 * i * i * now.slope
    contact = contact_force(q, mode.contact, u)
    total = magnetic - q.damping * v - q.spring_stiffness * (u - q.spring_rest) - contact
    supply = 0.0
    if mode.relay:
        supply = q.supply_speed * q.voltage * math.cos(q.supply_speed * t + q.supply_phase)
    dy[DISPLACEMENT] = v
    dy[VELOCITY] = mode.response.a * total + mode.response.b
    dy[MOLE_VELOCITY] = mode.response.d * total + mode.response.e
    dy[CURRENT] = (p - (q.resistance + now.slope * v) * i) / now.inductance
    dy[VOLTAGE] = supply - q.elastance * i
    dy[MOLE_DISPLACEMENT] = x
    dy[IMPACT_WORK] = contact * x
    dy[ELECTRICAL_WORK] = q.resistance * i * i + magnetic * v
    dy[MAGNETIC_WORK] = magnetic * v
    dy[FRICTION_LOSS] = q.bar_limit * mode.bar * v + q.mole_limit * mode.mole * x
    dy[VISCOUS_LOSS] = q.damping * v * v
    dy[IMPULSE] = contact


@kernel
def limit_of_soil(q, base):
    """Return the force F_y at which the soil gives way with its base at b [N]."""
    return q.soil_limit + q.soil_limit_gradient * base


@kernel
def pushed(y, mode):
    """Return the force F_s of the soil on the mole [N]."""
    base = y[SOIL_BASE]
    limit = limit_of_soil(mode.q, base)
    return soil_force(mode.q, mode.soil, y[SOIL_FRONT] - base, limit, y[MOLE_VELOCITY])


@kernel
def _creep(q, stretch):
    """Return the velocity at which the soil's dashpot lets its spring relax [m s-1].

    A stretch below rounding errors does not relax: else steps would never grow again.
    """
    is_relaxing = q.soil_damping > 0 and abs(stretch) > RELAXED
    return q.soil_stiffness * stretch / q.soil_damping if is_relaxing else 0.0


@kernel
def relaxation_step(y, mode):
    """Return the time in which the spring of soil that relaxes does so by a factor of e [s]."""
    q, stretch = mode.q, 0.0
    if mode.soil == APART:
        stretch = y[SOIL_FRONT] - y[SOIL_BASE]
    elif mode.soil == SLIDING:
        limit = limit_of_soil(q, y[SOIL_BASE])
        stretch = limit / q.soil_stiffness - y[SOIL_FRONT] + y[SOIL_BASE]
    is_relaxing = _creep(q, stretch) != 0
    return q.soil_damping / q.soil_stiffness if is_relaxing else math.inf


@kernel
def rates_in_soil(t, y, mode, dy):
    """Set dy to the time derivative of the state y, of size 15, of a mole with soil ahead."""
    rates(t, y, mode, dy)
    q, x = mode.q, y[MOLE_VELOCITY]
    dent = y[SOIL_FRONT] - y[SOIL_BASE]
    force = pushed(y, mode)
    dy[VELOCITY] += mode.push.on_bar * force
    dy[MOLE_VELOCITY] += mode.push.on_mole * force
    front, base = x, 0.0
    if mode.soil == APART:
        front = -_creep(q, dent)
    elif mode.soil == SLIDING and q.soil_damping > 0:
        base = x - _creep(q, force / q.soil_stiffness - dent)
    elif mode.soil == SLIDING:
        base = q.soil_stiffness * x / (q.soil_stiffness + q.soil_limit_gradient)
    dy[SOIL_FRONT], dy[SOIL_BASE] = front, base
    dy[SOIL_LOSS] = force * x - q.soil_stiffness * dent * (front - base)
