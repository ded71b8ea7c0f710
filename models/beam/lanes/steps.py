"""The hot loop: sixteen beams at a time, fixed steps, exact between the samples of the force.

Each mode is propagated exactly under a contact force that is linear within a step; the harmonic
force enters through the exact steady response, so modes carry only the effect of contact, and so
does a random force, see `models.beam.lanes.lines`. A damped mode under a sampled force obeys a
two-term recurrence, here in transposed direct form:

    y_i <- t_i y_i + r_i + alpha_i p,    r_i <- beta_i p - d_i y_i,

where t_i and d_i are trace and determinant of its propagator. The new penetration acts within the
same step (sigma = sum of the modes' share of it), so x = X + sigma p(x) is solved for x, without
iteration because p is piecewise linear. There are no branches, so lanes never diverge, and a row's
bits do not depend on its neighbours.

A force that is linear within a step misses part of the impulse where it is curved, and at its kinks
at the beginning and the end of a contact. Both parts are known to leading order and are added to
the sampled penetration; this reduces the measured error of a work-rate by a factor of four to ten.
"""

import numpy as np

from models.beam.lanes.layout import CLOCK, UNROLL, X1, X2, P, modes_of, padded
from models.beam.lanes.lines import draw_lines, redraw_lines, sum_lines
from models.beam.structure.modal import Array
from models.numerics.blocks import LANES, aligned
from models.numerics.fma import fma
from models.numerics.jit import kernel

_NOTHING = 1e-150  # of the gap
_MODE = 6  # slots of a mode: y, r, t, d, alpha, beta
# slots of a lane besides its modes, after those of a state
_RIGHT, _LEFT, _RE, _IM, _STIFF, _SIGMA = range(3, 9)
_WORK_R, _WORK_L, _PEAK_R, _PEAK_L, _SUM, _RANDOM, _HEAD = range(9, 16)


def room(modes: int) -> tuple[Array, Array]:
    """Return room for the modes of a block of lanes, and for its other slots."""
    return aligned(padded(modes) * _MODE * LANES), aligned(_HEAD * LANES)


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
        peak[n, 1] = head[_PEAK_L * LANES + lane]


@kernel
def _step(w, head, groups, cosine, sine):
    """Advance all lanes by one step: the hot loop."""
    for lane in range(LANES):
        head[_SUM * LANES + lane] = 0.0
    for g in range(groups):
        for lane in range(LANES):
            p = head[P * LANES + lane]
            k = g * (UNROLL * _MODE * LANES) + lane
            y = w[k]
            y0 = fma(w[k + 4 * LANES], p, fma(w[k + 2 * LANES], y, w[k + LANES]))
            w[k + LANES] = fma(w[k + 5 * LANES], p, -w[k + 3 * LANES] * y)
            w[k] = y0
            k += _MODE * LANES
            y = w[k]
            y1 = fma(w[k + 4 * LANES], p, fma(w[k + 2 * LANES], y, w[k + LANES]))
            w[k + LANES] = fma(w[k + 5 * LANES], p, -w[k + 3 * LANES] * y)
            w[k] = y1
            k += _MODE * LANES
            y = w[k]
            y2 = fma(w[k + 4 * LANES], p, fma(w[k + 2 * LANES], y, w[k + LANES]))
            w[k + LANES] = fma(w[k + 5 * LANES], p, -w[k + 3 * LANES] * y)
            w[k] = y2
            k += _MODE * LANES
            y = w[k]
            y3 = fma(w[k + 4 * LANES], p, fma(w[k + 2 * LANES], y, w[k + LANES]))
            w[k + LANES] = fma(w[k + 5 * LANES], p, -w[k + 3 * LANES] * y)
            w[k] = y3
            head[_SUM * LANES + lane] += (y0 + y1) + (y2 + y3)
    for lane in range(LANES):
        right, left = head[_RIGHT * LANES + lane], head[_LEFT * LANES + lane]
        free = fma(head[_RE * LANES + lane], cosine, head[_SUM * LANES + lane])
        free = fma(-head[_IM * LANES + lane], sine, free) + head[_RANDOM * LANES + lane]
        # The contact force over the stop's stiffness: penetration to the right less to the left.
        over, under = free - right, -free - left
        p = ((over if over > 0.0 else 0.0) - (under if under > 0.0 else 0.0)) * head[
            _STIFF * LANES + lane
        ]
        x = fma(head[_SIGMA * LANES + lane], p, free)
        x1 = head[X1 * LANES + lane]
        before, after = x1 - head[X2 * LANES + lane], x - x1
        # The corrections below make p non-zero just after contact: p does not indicate contact.
        in_right, in_left = x1 > right, x1 < -left
        # Two divisions in one: for the parabola at the turning point, and for the crossing's
        # position.
        turned = (before * after < 0.0) & (in_right | in_left)
        side, gap = (1.0, right) if x > 0.0 else (-1.0, left)
        d0, d = fma(side, x1, -gap), fma(side, x, -gap)
        crossed = d0 * d < 0.0
        curvature = after - before if turned else 1.0
        travel = abs(d - d0) if crossed else 1.0
        inverse = 1 / (curvature * travel)
        # Work (eq 8) is the sum of d^2 over the extrema of the penetration d, signed outward.
        swing = before + after
        vertex = fma(-0.125 * swing * swing, inverse * travel, x1)
        d_right = vertex - right if turned & in_right else 0.0
        d_left = -vertex - left if turned & in_left else 0.0
        outward = 1.0 if before > 0.0 else -1.0
        head[_WORK_R * LANES + lane] = fma(outward * d_right, d_right, head[_WORK_R * LANES + lane])
        head[_WORK_L * LANES + lane] = fma(-outward * d_left, d_left, head[_WORK_L * LANES + lane])
        peak_r, peak_l = head[_PEAK_R * LANES + lane], head[_PEAK_L * LANES + lane]
        head[_PEAK_R * LANES + lane] = d_right if d_right > peak_r else peak_r
        head[_PEAK_L * LANES + lane] = d_left if d_left > peak_l else peak_l
        # The missed impulse of a force with a kink inside the step, and of a curved one.
        p += 0.5 * side * d0 * d * (inverse * curvature) if crossed else 0.0
        p -= (after - before) / 12 if d > 0.0 else 0.0
        head[X2 * LANES + lane] = x1
        head[X1 * LANES + lane] = x
        head[P * LANES + lane] = p


@kernel
def _forget(w):
    """Set motion that has died out to zero: numbers near underflow are slow."""
    for k in range(0, w.size, _MODE * LANES):
        for slot in range(2 * LANES):
            w[k + slot] = 0.0 if abs(w[k + slot]) <= _NOTHING else w[k + slot]


@kernel
def advance_blocks(
    system_modes, sigma, response, load, state, gaps, growth, cosine, sine, w, head, lines, record
):
    """Advance all beams over the periods of their record, a block of lanes at a time."""
    work, strobe, peak, trace = record
    n, periods, _ = work.shape
    steps = cosine.size
    groups = w.size // (UNROLL * _MODE * LANES)
    for first in range(0, n, LANES):
        _load(system_modes, sigma, response, state, gaps, first, w, head)
        rows = min(LANES, n - first)
        is_random = draw_lines(load, state, first, steps, lines)
        for period in range(periods):
            for lane in range(LANES):
                head[_WORK_R * LANES + lane] = 0.0
                head[_WORK_L * LANES + lane] = 0.0
            if is_random:
                redraw_lines(load, state, first, period, steps, lines, w, _MODE * LANES)
                sum_lines(load, state, first, period, lines)
            last_but_two = np.zeros(LANES)
            for s in range(steps):
                if s == steps - 1:
                    for lane in range(LANES):
                        last_but_two[lane] = head[X2 * LANES + lane]
                if is_random:
                    for lane in range(LANES):
                        head[_RANDOM * LANES + lane] = lines.total[s * LANES + lane]
                _step(w, head, groups, cosine[s], sine[s])
                if trace.size:
                    for lane in range(rows):
                        trace[first + lane, period * steps + s] = head[X1 * LANES + lane]
            _forget(w)
            for lane in range(rows):
                row = first + lane
                work[row, period, 0] = head[_WORK_R * LANES + lane]
                work[row, period, 1] = head[_WORK_L * LANES + lane]
                x = head[X1 * LANES + lane]
                strobe[row, period, 0] = x
                strobe[row, period, 1] = (
                    (3 * x - 4 * head[X2 * LANES + lane] + last_but_two[lane]) * steps / (4 * np.pi)
                )
                head[_RIGHT * LANES + lane] += growth[row, 0] * work[row, period, 0]
                head[_LEFT * LANES + lane] += growth[row, 1] * work[row, period, 1]
        _store(w, head, first, state, gaps, peak)
    state[:, CLOCK] += periods
