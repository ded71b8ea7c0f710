"""Dry friction at two interfaces: which of them slip or stick, and the resulting forces.

The bar slips within the mole with relative velocity v, limit f1; the mole slips on the ground with
velocity x, limit f2. F is the force on the bar without friction. With friction forces T1, T2,

    v' = (F - T1)/m + T2/m2,    x' = (-F + T1 - T2)/m2    (17)

In a mode, in which each interface slips forwards (1), slips backwards (-1) or sticks (0), both are
linear in F: v' = a F + b, x' = d F + e. As printed, (20) lacks the term T2/m2.
"""

from typing import NamedTuple

from models.mole.parameters import AS_PRINTED
from models.numerics.jit import kernel


class Response(NamedTuple):
    """Accelerations in a mode: v' = a F + b, x' = d F + e.

    Attributes
    ----------
    a, d : float
        [kg-1]
    b, e : float
        [m s-2]
    """

    a: float
    b: float
    d: float
    e: float


class Hold(NamedTuple):
    """The sticking condition of an interface: |gain F + offset| <= limit.

    Attributes
    ----------
    gain : float
        1 or -1.
    offset, limit : float
        [N]
    """

    gain: float
    offset: float
    limit: float


@kernel
def response(q, bar, mole):
    """Return the `Response` of a mole q with the bar and the mole in these modes."""
    if bar == 0 and mole == 0:
        return Response(0.0, 0.0, 0.0, 0.0)
    if bar == 0:
        carried = q.mole_mass if q.formulation == AS_PRINTED else q.bar_mass + q.mole_mass
        return Response(0.0, 0.0, 0.0, -q.mole_limit * mole / carried)
    t_1, t_2 = q.bar_limit * bar, q.mole_limit * mole
    if q.formulation == AS_PRINTED:
        a, b = 1 / q.mass, -t_1 / q.mass
    elif mole == 0:
        a, b = 1 / q.bar_mass, -t_1 / q.bar_mass
    else:
        a, b = 1 / q.mass, -t_1 / q.mass + t_2 / q.mole_mass
    if mole == 0:
        return Response(a, b, 0.0, 0.0)
    return Response(a, b, -1 / q.mole_mass, (t_1 - t_2) / q.mole_mass)


@kernel
def bar_hold(q, mole):
    """Return the `Hold` of the bar for this mode of the mole."""
    coupled = mole != 0 and q.formulation != AS_PRINTED
    offset = q.mole_limit * mole * q.mass / q.mole_mass if coupled else 0.0
    return Hold(1.0, offset, q.bar_limit)


@kernel
def mole_hold(q, bar):
    """Return the `Hold` of the mole for this direction of the bar's slip."""
    return Hold(-1.0, q.bar_limit * bar, q.mole_limit)


@kernel
def _direction(force, limit):
    return 0 if abs(force) <= limit else (1 if force > 0 else -1)


@kernel
def decide(q, v, x, force):
    """Return the modes of bar and mole at velocities v and x under a force F.

    An interface at exactly zero velocity sticks, or slips as it is driven; the result is unique.

    Parameters
    ----------
    q : Mole
    v, x : float
        [m s-1]
    force : float
        F [N]

    Returns
    -------
    bar, mole : int
        -1, 0 or 1.
    """
    bar = 1 if v > 0 else -1
    mole = 1 if x > 0 else -1
    if v == 0 and x != 0:
        hold = bar_hold(q, mole)
        bar = _direction(force + hold.offset, hold.limit)
    elif v == 0:
        bar = _direction(force, q.bar_limit)
    if x == 0 and bar == 0:
        mole = 0
    elif x == 0:
        hold = mole_hold(q, bar)
        mole = _direction(-force + hold.offset, hold.limit)
    return bar, mole
