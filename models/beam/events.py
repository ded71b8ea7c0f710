"""Events of the exact propagator: where contacts begin, turn and end.

Between events the beam is linear and the tip a sum of exponentials, none of which grows:

    x(s) = Re sum_k a_k exp(r_k s),    |d^p x/ds^p (s')| <= sum_k |a_k| |r_k|^p |exp(r_k s)|

for all s' >= s. These bounds of the second and third derivative say how long the next event is
certain to stay away, and each step of the search goes just that far. So it misses no event,
however brief the contact, and close to one it converges like Newton's method. Just after leaving
a site the distance is zero to rounding, but it is opening, and the same bounds carry the search
beyond the turning point, or to it.
"""

import math
from typing import NamedTuple

import numpy as np

from models.beam.phases import exponentials, join, split
from models.numerics.jit import kernel

EVALUATIONS_PER_PERIOD = 100_000
_ROUNDING = 16 * float(np.finfo(float).eps)
_SHORTEST = 1e-14  # no step of the search is shorter: time must pass
_FADED = 1e-18  # a velocity too small to matter
_NOWHERE, _RIGHT, _LEFT = -1, 0, 1


class Tip(NamedTuple):
    """The tip at one instant, and what bounds it ever after.

    Attributes
    ----------
    x, v, a : float
        Displacement and its first two derivatives.
    bound_a, bound_j : float
        No later acceleration or jerk is larger.
    live : int
        Number of terms that have not faded.
    """

    x: float
    v: float
    a: float
    bound_a: float
    bound_j: float
    live: int


@kernel
def _weigh(phase, coefficient, weight):
    """Set weight (9, T) to what each term brings to the tip; return the sizes of x and v.

    Rows: real and imaginary part for x, v, a, then the moduli for v, a and the jerk.
    """
    near = slow = 0.0
    for k in range(len(phase.speed)):
        c, e = coefficient[0, k], coefficient[1, k]
        u, v = phase.tip[0, k], phase.tip[1, k]
        re, im = c * u - e * v, c * v + e * u
        size = math.sqrt(re * re + im * im)
        near += size
        slow += size * phase.speed[k]
        for p in range(3):
            weight[2 * p, k], weight[2 * p + 1, k] = re, im
            size *= phase.speed[k]
            weight[6 + p, k] = size
            u, v = phase.rate[0, k], phase.rate[1, k]
            re, im = re * u - im * v, re * v + im * u
    return near, slow


@kernel
def _tip(phase, weight, live, s, power):
    exponentials(phase, live, s, power)
    x = v = a = bound_a = bound_j = 0.0
    for k in range(live):
        p, q = 1 + power[0, k], power[1, k]
        x += weight[0, k] * p - weight[1, k] * q
        v += weight[2, k] * p - weight[3, k] * q
        a += weight[4, k] * p - weight[5, k] * q
        bound_a += weight[7, k] * power[2, k]
        bound_j += weight[8, k] * power[2, k]
    while live > 2 and weight[6, live - 1] * power[2, live - 1] < _FADED:
        live -= 1
    return Tip(x, v, a, bound_a, bound_j, live)


@kernel
def _parabola(distance, closing, bound):
    """First time at which distance - closing h - bound h^2/2 is zero."""
    square = closing * closing + 2 * bound * distance
    if square < 0 or (closing <= 0 and bound <= 0):
        return math.inf
    if closing > 0:
        return 2 * distance / (closing + math.sqrt(square))
    return (math.sqrt(square) - closing) / bound


@kernel
def _reach(distance, closing, gathering, bound, bound_next):
    """Time for which a distance is certain to stay positive.

    It closes with the given speed, gathering speed at a rate that never exceeds `bound` and
    itself grows at most by `bound_next` in unit time.
    """
    distance = max(distance, 0.0)
    sure = _parabola(distance, closing, bound)
    trial = max(2 * sure, -0.5 * gathering / bound_next)
    for _ in range(4):
        over_trial = gathering + bound_next * trial
        if not over_trial < bound:
            break
        sure = max(sure, min(trial, _parabola(distance, closing, over_trial)))
        trial *= 2
    return sure


@kernel
def _is_here(distance, closing, gathering, rounding):
    """Whether a distance is zero to rounding and not opening."""
    return distance <= rounding and (closing > 0 or (closing == 0 and gathering > 0))


@kernel
def _fly(phase, weight, power, gaps, near, to_end):
    """Fly until a site is met or the time is up; return the time, the site and the effort."""
    s = 0.0
    evaluations = 1
    tip = _tip(phase, weight, len(phase.speed), s, power)
    while evaluations < EVALUATIONS_PER_PERIOD:
        to_right, to_left = gaps[_RIGHT] - tip.x, gaps[_LEFT] + tip.x
        if _is_here(to_right, tip.v, tip.a, near):
            return s, _RIGHT, evaluations
        if _is_here(to_left, -tip.v, -tip.a, near):
            return s, _LEFT, evaluations
        if s == to_end:
            break
        h = min(
            _reach(to_right, tip.v, tip.a, tip.bound_a, tip.bound_j),
            _reach(to_left, -tip.v, -tip.a, tip.bound_a, tip.bound_j),
        )
        s = min(s + max(h, _SHORTEST), to_end)
        evaluations += 1
        tip = _tip(phase, weight, tip.live, s, power)
    return s, _NOWHERE, evaluations


@kernel
def _touch(phase, weight, power, side, gap, near, slow, to_end):
    """Stay in contact until it ends or the time is up.

    Return the time, whether contact has ended, the work, the deepest penetration and the effort.
    The work between two extrema of the penetration d is half the change of d^2.
    """
    s = 0.0
    evaluations = 1
    tip = _tip(phase, weight, len(phase.speed), s, power)
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
            h = _parabola(max(speed, 0.0), -gathering, tip.bound_j)
        else:
            h = min(
                _parabola(max(-speed, 0.0), gathering, tip.bound_j),
                _reach(depth, -speed, -gathering, tip.bound_a, tip.bound_j),
            )
        s = min(s + max(h, _SHORTEST), to_end)
        evaluations += 1
        tip = _tip(phase, weight, tip.live, s, power)
    return s, False, work, deepest, evaluations


@kernel
def _sample(phase, weight, power, theta, until, trace):
    """Set what of a period's trace falls after theta, up to `until`."""
    step = 2 * math.pi / len(trace)
    for k in range(len(trace)):
        at = min((k + 1) * step, 2 * math.pi)
        if theta < at <= until:
            trace[k] = _tip(phase, weight, len(phase.speed), at - theta, power).x


@kernel
def run(free, contact, state, gaps, growth, record):
    """Advance one beam over the periods of its record."""
    work, strobe, peak, trace = record
    size = len(state) - 3
    m = size // 2
    y, owed = state[:size], state[size + 1 :]
    terms = max(len(free.speed), len(contact.speed))
    coefficient, weight, power = np.empty((2, terms)), np.empty((9, terms)), np.empty((3, terms))
    steps = len(trace) // len(work)
    for period in range(len(work)):
        x = y[:m].sum()
        site = _RIGHT if x > gaps[_RIGHT] else _LEFT if x < -gaps[_LEFT] else _NOWHERE
        theta = 0.0
        evaluations = 0
        while theta < 2 * math.pi:
            to_end = 2 * math.pi - theta
            phase = free if site == _NOWHERE else contact
            side = -1.0 if site == _LEFT else 1.0
            gap = 0.0 if site == _NOWHERE else gaps[site]
            split(phase, y, side * gap, theta, coefficient)
            near, slow = _weigh(phase, coefficient, weight)
            near, slow = _ROUNDING * (near + gaps[_RIGHT] + gaps[_LEFT]), _ROUNDING * slow
            if site == _NOWHERE:
                s, site, effort = _fly(phase, weight, power, gaps, near, to_end)
            else:
                s, ended, piece, deepest, effort = _touch(
                    phase, weight, power, side, gap, near, slow, to_end
                )
                work[period, site] += piece
                owed[site] += piece
                peak[site] = max(peak[site], deepest)
                if ended:
                    gaps[site] += growth[site] * owed[site]
                    owed[site] = 0.0
                    site = _NOWHERE
            evaluations += effort
            if evaluations >= EVALUATIONS_PER_PERIOD:
                state[:] = work[period:] = strobe[period:] = trace[period * steps :] = math.nan
                return
            until = theta + s if s < to_end else 2 * math.pi
            if steps:
                _sample(phase, weight, power, theta, until, trace[period * steps :][:steps])
            join(phase, coefficient, s, power, y)
            theta = until
        strobe[period, 0], strobe[period, 1] = y[:m].sum(), y[m:].sum()
        state[size] += 1
