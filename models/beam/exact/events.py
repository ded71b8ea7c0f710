"""Events of the exact propagator: where contacts begin, turn and end.

Each step of the search goes only as far as the bounds of `models.beam.exact.tip_bounds` exclude an
event. So it misses no event, however brief the contact, and close to one it converges like Newton's
method. Just after leaving a site the distance is zero to rounding, but it is opening, and the same
bounds carry the search beyond the turning point, or to it.
"""

import math
from typing import NamedTuple

import numpy as np

from models.beam.exact.tip_bounds import clear_time, parabola, tip_after, weigh
from models.beam.exact.within_phase import split
from models.beam.structure.modal import Array
from models.numerics.jit import kernel

EVALUATIONS_PER_PERIOD = 100_000
NOWHERE, RIGHT, LEFT = -1, 0, 1
_ROUNDING = 16 * float(np.finfo(float).eps)
_SHORTEST = 1e-14  # no step of the search is shorter, so that it proceeds


@kernel
def _is_here(distance, closing, gathering, rounding):
    """Whether a distance is zero to rounding and not opening."""
    return distance <= rounding and (closing > 0 or (closing == 0 and gathering > 0))


@kernel
def _fly(phase, weight, power, gaps, near, to_end):
    """Fly until a site is met or the time ends; return the time, the site and the effort."""
    s = 0.0
    evaluations = 1
    tip = tip_after(phase, weight, len(phase.speed), s, power)
    while evaluations < EVALUATIONS_PER_PERIOD:
        to_right, to_left = gaps[RIGHT] - tip.x, gaps[LEFT] + tip.x
        if _is_here(to_right, tip.v, tip.a, near):
            return s, RIGHT, evaluations
        if _is_here(to_left, -tip.v, -tip.a, near):
            return s, LEFT, evaluations
        if s == to_end:
            break
        h = min(
            clear_time(to_right, tip.v, tip.a, tip.bound_a, tip.bound_j),
            clear_time(to_left, -tip.v, -tip.a, tip.bound_a, tip.bound_j),
        )
        s = min(s + max(h, _SHORTEST), to_end)
        evaluations += 1
        tip = tip_after(phase, weight, tip.live, s, power)
    return s, NOWHERE, evaluations


@kernel
def _touch(phase, weight, power, side, gap, near, slow, to_end):
    """Stay in contact until it or the time ends.

    Return the time, whether contact has ended, the work, the deepest penetration and the effort.
    The work between two extrema of the penetration d is half the change of d^2.
    """
    s = 0.0
    evaluations = 1
    tip = tip_after(phase, weight, len(phase.speed), s, power)
    last = deepest = max(side * tip.x - gap, 0.0)
    inward = side * tip.v > 0 or (tip.v == 0 and side * tip.a > 0)
    work = 0.0
    while evaluations < EVALUATIONS_PER_PERIOD:
        depth, speed, gathering = side * tip.x - gap, side * tip.v, side * tip.a
        if not inward and _is_here(depth, -speed, -gathering, near):
            return s, True, work + 0.5 * last * last, deepest, evaluations
        is_turning = (
            _is_here(speed, -gathering, 0.0, slow)
            if inward
            else _is_here(-speed, gathering, 0.0, slow)
        )
        if is_turning or s == to_end:
            depth = max(depth, 0.0)
            work += 0.5 * abs(depth * depth - last * last)
            deepest = max(deepest, depth)
            last = depth
        if s == to_end:
            break
        if is_turning:
            inward = not inward
        if inward:
            h = parabola(max(speed, 0.0), -gathering, tip.bound_j)
        else:
            h = min(
                parabola(max(-speed, 0.0), gathering, tip.bound_j),
                clear_time(depth, -speed, -gathering, tip.bound_a, tip.bound_j),
            )
        s = min(s + max(h, _SHORTEST), to_end)
        evaluations += 1
        tip = tip_after(phase, weight, tip.live, s, power)
    return s, False, work, deepest, evaluations


class Scratch(NamedTuple):
    """Room for the terms of one phase, filled by `split`, `weigh` and `exponentials`.

    Attributes
    ----------
    coefficient, weight, power : ndarray, shapes (2, T), (9, T), (3, T)
    """

    coefficient: Array
    weight: Array
    power: Array


class Event(NamedTuple):
    """The end of a phase.

    Attributes
    ----------
    after : float
        Time since the phase began.
    site : int
        In contact from then on: `RIGHT`, `LEFT` or `NOWHERE`.
    has_left : bool
        Whether the event is the end of a contact.
    work, deepest : float
        Of the contact, if the phase is one.
    effort : int
        Evaluations of the tip.
    """

    after: float
    site: int
    has_left: bool
    work: float
    deepest: float
    effort: int


@kernel
def scratch(free, contact):
    """Return room for the terms of either phase."""
    terms = max(len(free.speed), len(contact.speed))
    return Scratch(np.empty((2, terms)), np.empty((9, terms)), np.empty((3, terms)))


@kernel
def site_of(x, gaps):
    """Return the site that a tip at x is in contact with."""
    return RIGHT if x > gaps[RIGHT] else LEFT if x < -gaps[LEFT] else NOWHERE


@kernel
def next_event(phase, y, gaps, site, theta, to_end, room):
    """Find the end of the phase that begins with y at force phase theta, within `to_end`."""
    coefficient, weight, power = room
    side = -1.0 if site == LEFT else 1.0
    gap = 0.0 if site == NOWHERE else gaps[site]
    split(phase, y, side * gap, theta, coefficient)
    near, slow = weigh(phase, coefficient, weight)
    near, slow = _ROUNDING * (near + gaps[RIGHT] + gaps[LEFT]), _ROUNDING * slow
    if site == NOWHERE:
        s, site, effort = _fly(phase, weight, power, gaps, near, to_end)
        return Event(s, site, False, 0.0, 0.0, effort)
    s, has_left, work, deepest, effort = _touch(phase, weight, power, side, gap, near, slow, to_end)
    return Event(s, NOWHERE if has_left else site, has_left, work, deepest, effort)


@kernel
def nearest_turn(phase, gaps, until, room):
    """Return the smallest distance from a stop's face at which the tip turns before `until`.

    `room` is as left by `next_event`.
    """
    slow = 0.0
    for k in range(len(phase.speed)):
        slow += room.weight[6, k]
    slow *= _ROUNDING
    s = 0.0
    nearest = math.inf
    tip = tip_after(phase, room.weight, len(phase.speed), s, room.power)
    way = 1.0 if tip.v > 0 or (tip.v == 0 and tip.a > 0) else -1.0
    for _ in range(EVALUATIONS_PER_PERIOD):
        speed, braking = way * tip.v, -way * tip.a
        if _is_here(speed, braking, 0.0, slow):
            nearest = min(nearest, abs(gaps[RIGHT] - tip.x), abs(gaps[LEFT] + tip.x))
            way, speed, braking = -way, -speed, -braking
        if s == until:
            break
        h = parabola(max(speed, 0.0), braking, tip.bound_j)
        s = min(s + max(h, _SHORTEST), until)
        tip = tip_after(phase, room.weight, tip.live, s, room.power)
    return nearest
