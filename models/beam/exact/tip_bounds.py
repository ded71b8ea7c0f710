"""Bounds of the tip within a phase: a time during which it cannot reach a stop.

Between events the beam is linear and the tip a sum of exponentials, none of which grows:

    x(s) = Re sum_k a_k exp(r_k s),    |d^p x/ds^p (s')| <= sum_k |a_k| |r_k|^p |exp(r_k s)|

for all s' >= s. These bounds of the second and third derivatives give a time before which no event
can occur.
"""

import math
from typing import NamedTuple

from models.beam.exact.within_phase import exponentials
from models.numerics.jit import kernel

_FADED = 1e-18  # a negligible velocity


class Tip(NamedTuple):
    """The tip at one instant, and bounds of its motion from then on.

    Attributes
    ----------
    x, v, a : float
        Displacement and its first two derivatives.
    bound_a, bound_j : float
        No later acceleration or jerk is larger.
    live : int
        Number of terms that have not faded yet.
    """

    x: float
    v: float
    a: float
    bound_a: float
    bound_j: float
    live: int


@kernel
def weigh(phase, coefficient, weight):
    """Set `weight` (9, T) to the terms' contributions to the tip; return the sizes of x and v.

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
def tip_after(phase, weight, live, s, power):
    """Return the tip after the time s, from the first `live` terms."""
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
def parabola(distance, closing, bound):
    """Return the first time h at which distance - closing h - bound h^2/2 is zero."""
    square = closing * closing + 2 * bound * distance
    if square < 0 or (closing <= 0 and bound <= 0):
        return math.inf
    if closing > 0:
        return 2 * distance / (closing + math.sqrt(square))
    return (math.sqrt(square) - closing) / bound


@kernel
def clear_time(distance, closing, gathering, bound, bound_next):
    """Return a time for which a distance is certain to stay positive.

    It closes at the speed `closing`, with an acceleration `gathering` that never exceeds `bound`
    and grows by at most `bound_next` per unit time.
    """
    distance = max(distance, 0.0)
    sure = parabola(distance, closing, bound)
    trial = max(2 * sure, -0.5 * gathering / bound_next)
    for _ in range(4):
        over_trial = gathering + bound_next * trial
        if not over_trial < bound:
            break
        sure = max(sure, min(trial, parabola(distance, closing, over_trial)))
        trial *= 2
    return sure
