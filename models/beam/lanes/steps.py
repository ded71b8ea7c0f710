"""The hot loop: sixteen beams at a time, fixed steps, exact between the samples of the force.

Each mode is propagated exactly under a contact force that is linear within a step; the harmonic
force enters through the exact steady response, so modes carry only the effect of contact, and so
does a random force, see `models.beam.lanes.random_motion`. A damped mode under a sampled force
obeys a two-term recurrence, here in transposed direct form:

    y_i <- t_i y_i + r_i + alpha_i p,    r_i <- beta_i p - d_i y_i,

where t_i and d_i are trace and determinant of its propagator. The new penetration acts within the
same step (sigma = sum of the modes' share of it), so x = X + sigma p(x) is solved for x, without
iteration because p is piecewise linear. There are no branches, so lanes never diverge, and a row's
bits do not depend on its neighbours.

The sum X is formed without the last penetration, whose share is added at the end: its calculation
and that of the modes' motion then overlap.

A force that is linear within a step misses part of the impulse where it is curved, and at its kinks
at the beginning and the end of a contact. Both parts are known to leading order and are added to
the sampled penetration; this reduces the measured error of a work-rate by a factor of four to ten.
"""

import numpy as np

from models.beam.lanes.layout import CLOCK, UNROLL, X1, X2, P, modes_of, padded
from models.beam.lanes.random_motion import add_motion, begin_motion
from models.beam.structure.modal import Array
from models.numerics.blocks import LANES, aligned, copy
from models.numerics.fma import fma
from models.numerics.jit import inlined, kernel, lean

_NOTHING = 1e-150  # of the gap
_MODE = 6  # slots of a mode: y, r, t, d, alpha, beta
# slots of a lane besides its modes, after those of a state
_RIGHT, _LEFT, _RE, _IM, _GAIN, _STIFF, _SIGMA = range(3, 10)
_WORK_R, _WORK_L, _PEAK_R, _PEAK_L, _SUM, _HEAD = range(10, 16)


def room(modes: int, steps: int) -> tuple[Array, Array, Array]:
    """Return room for a block of lanes: modes, other slots, and the tip's motion without contact.

    The latter at each step of a period.
    """
    of_modes, of_lanes = padded(modes) * _MODE * LANES, _HEAD * LANES
    whole = aligned(of_modes + of_lanes + steps * LANES)
    return (
        whole[:of_modes],
        whole[of_modes : of_modes + of_lanes],
        whole[of_modes + of_lanes :],
    )


@kernel
def _load(system_modes, sigma, response, state, gaps, first, w, head):
    """Load up to LANES rows from `first` on into lanes; spare lanes repeat the last row."""
    last = state.shape[0] - 1
    m = system_modes.shape[2]
    w[:] = 0.0
    head[:] = 0.0
    for lane in range(LANES):
        n = min(first + lane, last)
        for i in range(m):
            k = i * _MODE * LANES + lane
            w[k] = state[n, i]
            w[k + LANES] = state[n, m + i]
            for c in range(4):
                w[k + (2 + c) * LANES] = system_modes[n, c, i]
        for slot in (P, X1, X2):
            head[slot * LANES + lane] = state[n, 2 * m + slot]
        head[_RIGHT * LANES + lane] = gaps[n, 0]
        head[_LEFT * LANES + lane] = gaps[n, 1]
        head[_RE * LANES + lane] = response[n].real
        head[_IM * LANES + lane] = response[n].imag
        for i in range(m):
            head[_GAIN * LANES + lane] += system_modes[n, 2, i]
        head[_SIGMA * LANES + lane] = sigma[n]
        head[_STIFF * LANES + lane] = 1 / (1 - sigma[n])


@kernel
def _store(w, head, first, state, gaps, peak):
    """Store lanes back into their rows."""
    m = modes_of(state)
    for n in range(first, min(first + LANES, state.shape[0])):
        lane = n - first
        for i in range(m):
            k = i * _MODE * LANES + lane
            state[n, i] = w[k]
            state[n, m + i] = w[k + LANES]
        for slot in (P, X1, X2):
            state[n, 2 * m + slot] = head[slot * LANES + lane]
        gaps[n, 0] = head[_RIGHT * LANES + lane]
        gaps[n, 1] = head[_LEFT * LANES + lane]
        peak[n, 0] = head[_PEAK_R * LANES + lane]
        peak[n, 1] = -head[_PEAK_L * LANES + lane]


@inlined
def _move(w, head, groups):
    """Advance the modes; sum their displacements without the share of the last penetration."""
    for lane in range(LANES):
        head[_SUM * LANES + lane] = 0.0
    for g in range(groups):
        for lane in range(LANES):
            p = head[P * LANES + lane]
            k = g * (UNROLL * _MODE * LANES) + lane
            y = w[k]
            y0 = fma(w[k + 2 * LANES], y, w[k + LANES])
            w[k + LANES] = fma(w[k + 5 * LANES], p, -w[k + 3 * LANES] * y)
            w[k] = fma(w[k + 4 * LANES], p, y0)
            k += _MODE * LANES
            y = w[k]
            y1 = fma(w[k + 2 * LANES], y, w[k + LANES])
            w[k + LANES] = fma(w[k + 5 * LANES], p, -w[k + 3 * LANES] * y)
            w[k] = fma(w[k + 4 * LANES], p, y1)
            head[_SUM * LANES + lane] += y0 + y1


@inlined
def within(x, low, high):
    """Return the nearest point between two stops."""
    x = x if x < high else high
    return x if x > low else low


@inlined
def _meet(head, drive, s):
    """Find the penetration at the end of step s, and book the work of the turning points."""
    for lane in range(LANES):
        right, left = head[_RIGHT * LANES + lane], -head[_LEFT * LANES + lane]
        free = head[_SUM * LANES + lane] + drive[s * LANES + lane]
        free = fma(head[_GAIN * LANES + lane], head[P * LANES + lane], free)
        # The contact force over the stop's stiffness: penetration to the right less to the left.
        p = (free - within(free, left, right)) * head[_STIFF * LANES + lane]
        x, x1 = fma(head[_SIGMA * LANES + lane], p, free), head[X1 * LANES + lane]
        # The corrections below make p non-zero just after contact: p does not indicate contact.
        d1 = x1 - within(x1, left, right)
        before, after = x1 - head[X2 * LANES + lane], x - x1
        bend = after - before
        was_in, is_in = d1 != 0.0, p != 0.0
        turned, crossed = was_in & (before * after < 0.0), was_in ^ is_in
        # Two divisions in one: for the parabola at the turning point, and for the crossing's
        # position.
        curvature, travel = bend if turned else 1.0, after if crossed else 1.0
        inverse = 1 / (curvature * travel)
        # Work (eq 8) is the sum of d^2 over the extrema of the penetration d, signed outward.
        swing = before + after
        depth = fma(-0.125 * swing * swing, inverse * travel, d1) if turned else 0.0
        work = depth * depth
        work = work if before * d1 > 0.0 else -work
        head[_WORK_R * LANES + lane] += work if d1 > 0.0 else 0.0
        head[_WORK_L * LANES + lane] += work if d1 < 0.0 else 0.0
        deepest_r, deepest_l = head[_PEAK_R * LANES + lane], head[_PEAK_L * LANES + lane]
        head[_PEAK_R * LANES + lane] = depth if depth > deepest_r else deepest_r
        head[_PEAK_L * LANES + lane] = depth if depth < deepest_l else deepest_l
        # The missed impulse of a curved force, and of one with a kink inside the step: the contact
        # then takes the share |d/after| of it, with d the penetration at the one end or the other.
        d = d1 + p
        p -= bend * (1 / 12) if is_in else 0.0
        p -= 0.5 * d * (1.0 - abs(d * (inverse * curvature))) if crossed else 0.0
        head[X2 * LANES + lane] = x1
        head[X1 * LANES + lane] = x
        head[P * LANES + lane] = p


@lean
def _take_steps(w, head, groups, drive, begin, end, path):
    """Advance all lanes from step `begin` to step `end` of a period: the hot loop."""
    for s in range(begin, end):
        _move(w, head, groups)
        _meet(head, drive, s)
        for lane in range(path.shape[0]):
            path[lane, s] = head[X1 * LANES + lane]


@kernel
def _forget(w):
    """Set motion that has died out to zero: numbers near underflow are slow."""
    for k in range(0, w.size, _MODE * LANES):
        for slot in range(2 * LANES):
            w[k + slot] = 0.0 if abs(w[k + slot]) <= _NOTHING else w[k + slot]


@kernel
def _swing(head, cosine, sine, drive):
    """Set the tip's motion without contact to that under the harmonic force."""
    for s in range(cosine.size):
        c, minus = cosine[s], -sine[s]
        for lane in range(LANES):
            im = head[_IM * LANES + lane] * minus
            drive[s * LANES + lane] = fma(head[_RE * LANES + lane], c, im)


@kernel
def _take_period(w, head, drive, steps, before, growth, first, period, record):
    """Advance a block by one period, and let its gaps grow; `before` is room for a lane each."""
    work, strobe, _, trace = record
    groups = w.size // (UNROLL * _MODE * LANES)
    rows = min(LANES, len(work) - first)
    for lane in range(LANES):
        head[_WORK_R * LANES + lane] = 0.0
        head[_WORK_L * LANES + lane] = 0.0
    traced = rows if trace.size else 0
    path = trace[first : first + traced, period * steps : (period + 1) * steps]
    _take_steps(w, head, groups, drive, 0, steps - 1, path)
    copy(head[X2 * LANES : (X2 + 1) * LANES], before)
    _take_steps(w, head, groups, drive, steps - 1, steps, path)
    _forget(w)
    for lane in range(rows):
        row = first + lane
        work[row, period, 0] = head[_WORK_R * LANES + lane]
        work[row, period, 1] = head[_WORK_L * LANES + lane]
        x = head[X1 * LANES + lane]
        strobe[row, period, 0] = x
        strobe[row, period, 1] = (
            (3 * x - 4 * head[X2 * LANES + lane] + before[lane]) * steps / (4 * np.pi)
        )
        head[_RIGHT * LANES + lane] += growth[row, 0] * work[row, period, 0]
        head[_LEFT * LANES + lane] += growth[row, 1] * work[row, period, 1]


@kernel
def advance_blocks(system_modes, sigma, response, state, gaps, growth, cosine, sine, room, record):
    """Advance all beams over the periods of their record, a block of lanes at a time."""
    w, head, drive = room
    n, periods, _ = record[0].shape
    before = np.empty(LANES)
    for first in range(0, n, LANES):
        _load(system_modes, sigma, response, state, gaps, first, w, head)
        _swing(head, cosine, sine, drive)
        for period in range(periods):
            _take_period(w, head, drive, cosine.size, before, growth, first, period, record)
        _store(w, head, first, state, gaps, record[2])
    for row in range(n):
        state[row, CLOCK] += periods


@kernel
def advance_loaded_blocks(
    system_modes, sigma, response, state, gaps, growth, cosine, sine, room, record, motion
):
    """Do the same where some beams have a random load."""
    w, head, drive = room
    n, periods, _ = record[0].shape
    before = np.empty(LANES)
    for first in range(0, n, LANES):
        _load(system_modes, sigma, response, state, gaps, first, w, head)
        _swing(head, cosine, sine, drive)
        is_random = begin_motion(motion, state, first)
        for period in range(periods):
            if is_random:
                _swing(head, cosine, sine, drive)
                add_motion(motion, state, first, period, drive)
            _take_period(w, head, drive, cosine.size, before, growth, first, period, record)
        _store(w, head, first, state, gaps, record[2])
    for row in range(n):
        state[row, CLOCK] += periods
