"""Soil ahead of the mole: the visco-elastic slider of Pavlovskaia and Wiercigroch.

E. Pavlovskaia, M. Wiercigroch, C. Grebogi, "Modeling of an impact system with a drift", Phys. Rev.
E 64 (2001) 056224. The slider has a front z and a base b, joined by a spring k and a dashpot c; its
base slides where it is pushed by the limit F_y = F_0 + F' b, and never back. The mole's front is at
w and moves at x = w'. Three modes:

    apart      w < z:  F_s = 0,  c z' = -k (z - b),  b' = 0
    elastic    z = w:  F_s = k (w - b) + c x,  b' = 0,  while 0 <= F_s <= F_y
    sliding    z = w:  F_s = F_y,  b' = x - (F_y - k (w - b))/c >= 0

Without damping the front returns at once, z = b, and a base that slides keeps its distance to the
force: b' = k x/(k + F'). While the base slides the mole moves forwards, and k (w - b) <= F_y.

F_s acts on the mole alone, backwards. With it (17) becomes

    v' = (F - T1)/m + (T2 + F_s)/m2,    x' = (-F + T1 - T2 - F_s)/m2

Both propagators measure from the base: the dent w - b, and the front z - b.
"""

from typing import NamedTuple

from models.mole.theory.friction import Hold, bar_hold, decide, mole_hold
from models.numerics.jit import kernel

APART, ELASTIC, SLIDING = range(3)
"""Modes of the soil."""

RELAXED = 1e-15
"""Stretch of the soil's spring [m] below which it has relaxed."""

_ROUNDING = 1e-12  # of the limit of the force


class Push(NamedTuple):
    """Accelerations by the force of the soil: v' += on_bar F_s, x' += on_mole F_s.

    Attributes
    ----------
    on_bar, on_mole : float
        [kg-1]
    """

    on_bar: float
    on_mole: float


@kernel
def push(q, bar, mole):
    """Return the `Push` of a mole q with the bar and the mole in these modes of friction."""
    on_bar = on_mole = 0.0
    if mole != 0 and bar != 0:
        on_bar, on_mole = 1 / q.mole_mass, -1 / q.mole_mass
    elif mole != 0:
        on_mole = -1 / (q.bar_mass + q.mole_mass)
    return Push(on_bar, on_mole)


@kernel
def soil_force(q, soil, dent, limit, x):
    """Return F_s [N] in a mode of the soil whose base slides at `limit`."""
    force = 0.0
    if soil == ELASTIC:
        force = q.soil_stiffness * dent + q.soil_damping * x
    elif soil == SLIDING:
        force = limit
    return force


@kernel
def touched(q, dent, limit, x):
    """Return the mode of soil that the mole touches, with its front at `dent` and velocity x."""
    force = q.soil_stiffness * dent + q.soil_damping * x
    mode = ELASTIC
    if force < 0 or (force == 0 and x < 0):
        mode = APART
    elif x > 0 and force >= limit:
        mode = SLIDING
    return mode


@kernel
def started(q, soil, front, dent, limit, mole):
    """Return the mode of the soil when the mole, at rest, begins to slip or stays.

    Parameters
    ----------
    q : Mole
    soil : int
        The mode before.
    front, dent : float
        z - b, w - b [m]
    limit : float
        F_y [N]
    mole : int
        Direction in which the mole begins to slip, 0 if it sticks.
    """
    force = q.soil_stiffness * dent
    mode = soil
    if mole > 0 and (soil != APART or dent >= front):
        # Rounding errors must not let soil at its limit stiffen again.
        mode = SLIDING if force >= limit * (1 - _ROUNDING) else ELASTIC
    elif mole < 0 and force <= 0:
        mode = APART
    elif soil == SLIDING:
        mode = ELASTIC
    return mode


@kernel
def bar_hold_in_soil(q, mole, force):
    """Return the `Hold` of the bar where the soil pushes the mole with F_s [N]."""
    hold = bar_hold(q, mole)
    pushed = force * q.mass / q.mole_mass if mole != 0 else 0.0
    return Hold(hold.gain, hold.offset + pushed, hold.limit)


@kernel
def mole_hold_in_soil(q, bar, force):
    """Return the `Hold` of the mole where the soil pushes it with F_s [N]."""
    hold = mole_hold(q, bar)
    return Hold(hold.gain, hold.offset - force, hold.limit)


@kernel
def _direction(force, limit):
    return 0 if abs(force) <= limit else (1 if force > 0 else -1)


@kernel
def decide_in_soil(q, v, x, force, pushed):
    """Return the modes of bar and mole, as `decide` does, where the soil pushes with F_s [N].

    If both are at rest, the accelerations minimise a strictly convex function (Gauss's principle of
    least constraint): a mode that contradicts nothing is the only one.

    Parameters
    ----------
    q : Mole
    v, x : float
        [m s-1]
    force, pushed : float
        F, F_s [N]

    Returns
    -------
    bar, mole : int
        -1, 0 or 1.
    """
    bar, mole = decide(q, v, x, force)
    if pushed != 0 and v == 0 and x != 0:
        hold = bar_hold_in_soil(q, mole, pushed)
        bar = _direction(force + hold.offset, hold.limit)
    elif pushed != 0 and v != 0 and x == 0:
        hold = mole_hold_in_soil(q, bar, pushed)
        mole = _direction(hold.offset - force, hold.limit)
    elif pushed != 0 and v == 0 and x == 0:
        bar, mole = _decide_at_rest(q, force, pushed)
    return bar, mole


@kernel
def _decide_at_rest(q, force, pushed):
    share, limit = q.mass / q.mole_mass, q.mole_limit
    bar = _direction(force, q.bar_limit)  # if the mole sticks
    load = q.bar_limit * bar - force - pushed if bar != 0 else -pushed
    mole = 0
    if abs(load) > limit:
        bar = _direction(force + (pushed - limit) * share, q.bar_limit)  # if it slips backwards
        load = q.bar_limit * bar - force - pushed if bar != 0 else -pushed
        mole = -1
        if load >= -limit:
            bar = _direction(force + (pushed + limit) * share, q.bar_limit)
            mole = 1
    return bar, mole
