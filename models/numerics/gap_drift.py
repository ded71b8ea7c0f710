"""Growth of a gap by itself, without wear: creep-down, relaxation, swelling, a tabulated history.

    C(t) = C_c [1 - exp(-t/tau_c)] + C_r [1 - exp(-t/tau_r)] - s max(0, t - t_s) + f H(t)

The cladding creeps down by C_c in the end. A support spring preloaded by delta_0, at a gap of
-delta_0, relaxes to the share phi: C_r = (1 - phi) delta_0. Swelling closes the gap at the rate s
from t_s on. H(t) is piecewise linear between given points, and constant after the last.
"""

import math

import numpy as np

from models.numerics.jit import kernel

CREEP, CREEP_TIME, RELAXATION, RELAXATION_TIME, SWELLING, SWELLING_START, HISTORY_FACTOR = range(7)
"""Entries of the array c, shape (7,), of a row: C_c, tau_c, C_r, tau_r, s, t_s, f.

The history is an array of shape (2, k): times [s], ascending from 0, and changes of the gap [m];
k = 0 without one.
"""

_SETTLED = 40.0  # time constants after which a process has ended
_ITERATIONS = 100
_CONVERGED = 1e-15


@kernel
def _following(t, times):
    """Return the index of the first of ascending times that is later, or their number."""
    low, high = 0, len(times)
    while low < high:
        middle = (low + high) // 2
        if times[middle] > t:
            high = middle
        else:
            low = middle + 1
    return low


@kernel
def _history(t, history):
    """Return the change of the gap at a time, and its speed."""
    times, changes = history[0], history[1]
    if len(times) == 0:
        return 0.0, 0.0
    after = _following(t, times)
    if after == 0:
        return changes[0], 0.0
    if after == len(times):
        return changes[after - 1], 0.0
    speed = (changes[after] - changes[after - 1]) / (times[after] - times[after - 1])
    return changes[after - 1] + (t - times[after - 1]) * speed, speed


@kernel
def drift(t, c, history):
    """Return the growth of the gap by itself [m]; at t = inf its limit."""
    growth = -c[CREEP] * math.expm1(-t / c[CREEP_TIME])
    growth -= c[RELAXATION] * math.expm1(-t / c[RELAXATION_TIME])
    if c[SWELLING] > 0 and t > c[SWELLING_START]:
        growth -= c[SWELLING] * (t - c[SWELLING_START])
    return growth + c[HISTORY_FACTOR] * _history(t, history)[0]


@kernel
def _speed(t, c, history):
    """Return the derivative of `drift` from the right [m/s]."""
    speed = c[CREEP] / c[CREEP_TIME] * math.exp(-t / c[CREEP_TIME])
    speed += c[RELAXATION] / c[RELAXATION_TIME] * math.exp(-t / c[RELAXATION_TIME])
    if t >= c[SWELLING_START]:
        speed -= c[SWELLING]
    return speed + c[HISTORY_FACTOR] * _history(t, history)[1]


@kernel
def drift_clock(t, c):
    """Return the time in which the speed of the drift changes [s]; inf if it does not."""
    tau = np.inf
    if c[CREEP] > 0 and t < _SETTLED * c[CREEP_TIME]:
        tau = c[CREEP_TIME]
    if c[RELAXATION] > 0 and t < _SETTLED * c[RELAXATION_TIME]:
        tau = min(tau, c[RELAXATION_TIME])
    return tau


@kernel
def next_kink(t, c, history):
    """Return the next time at which the speed of the drift jumps [s]; inf if there is none."""
    kink = np.inf
    if c[SWELLING] > 0 and t < c[SWELLING_START]:
        kink = c[SWELLING_START]
    after = _following(t, history[0])
    if after < history.shape[1]:
        kink = min(kink, history[0, after])
    return kink


@kernel
def drift_passes(t, level, c, history):
    """Return the earliest time from t on at which the drift exceeds a level [s]; inf for never.

    Between kinks the drift is concave, so Newton's method approaches the time from earlier ones; a
    step beyond the next kink, or to where the gap no longer grows, shows that there is none before.
    """
    if drift(t, c, history) > level:
        return t
    while True:
        kink = next_kink(t, c, history)
        is_last = kink == np.inf
        if is_last and not drift(kink, c, history) > level and c[SWELLING] == 0:
            return np.inf
        at = t
        for _ in range(_ITERATIONS):
            speed = _speed(at, c, history)
            step = (level - drift(at, c, history)) / speed if speed > 0 else np.inf
            if not at + step <= kink or step == np.inf:
                at = np.inf
                break
            at += step
            if not step > _CONVERGED * at:
                break
        if at < np.inf:
            return at
        if is_last:
            return np.inf
        t = kink
        if drift(t, c, history) > level:
            return t


@kernel
def drift_falls(t, level, c, history):
    """Return the earliest time from t on at which the drift is at most a level [s]; inf for never.

    Between kinks the drift is concave: it falls to a level once at most, where it began above it.
    """
    if drift(t, c, history) <= level:
        return t
    while True:
        kink = next_kink(t, c, history)
        if drift(kink, c, history) <= level:
            break
        if kink == np.inf:
            return np.inf
        t = kink
    low, high = t, kink
    if high == np.inf:  # swelling closes the gap
        length = (drift(t, c, history) - level) / c[SWELLING]
        high = t + length
        while drift(high, c, history) > level:
            length *= 2
            high = t + length
    for _ in range(_ITERATIONS):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        if drift(middle, c, history) > level:
            low = middle
        else:
            high = middle
    return high
