"""The tangent flow of the fast propagator: the evolution of small changes of the state.

The scheme of `models.beam.lanes` is linear except for its contact force, a function of the newest
three displacements of the tip. Its linearisation along a known trace of the tip is

    dx = reply dX,    dp = now dX + then_1 dx_1 + then_2 dx_2,    X = sum y_i,

with coefficients shared by all columns of a tangent. So the lanes here are columns, of one row at a
time.
"""

import numpy as np

from models.beam.lanes.layout import SHARED, UNROLL, X1, X2, P, padded
from models.beam.lanes.steps import within
from models.beam.lanes.systems import System
from models.beam.structure.modal import Array
from models.numerics.blocks import LANES, aligned
from models.numerics.fma import fma
from models.numerics.jit import kernel

_SUM, _HEAD = 3, 4  # slots of a block besides its modes, after those of a state


@kernel
def _linearise(x, x1, right, left, sigma):
    """Return reply, now, then_1 and then_2 of the step from x1 to x, as in `steps`."""
    d, d1 = x - within(x, -left, right), x1 - within(x1, -left, right)
    is_in, was_in = d != 0.0, d1 != 0.0
    stiff = 1 / (1 - sigma)
    reply, now, then_1, then_2 = 1.0, 0.0, 0.0, 0.0
    if is_in:
        reply, now = stiff, stiff
        now -= reply / 12
        then_1, then_2 = 2 / 12, -1 / 12
    if is_in != was_in:
        share = (d + d1) / (x - x1)
        if is_in:
            now -= reply * 0.5 * (1 - share) ** 2
            then_1 += 0.5 * share**2
        else:
            now += 0.5 * share**2
            then_1 -= 0.5 * (1 + share) ** 2
    return reply, now, then_1, then_2


@kernel
def _step(modes, w, head, coefficients):
    """Take all columns through one step: the hot loop."""
    reply, now, then_1, then_2 = coefficients
    groups = modes.shape[0] // (4 * UNROLL)
    for block in range(w.shape[0]):
        column, top = w[block], head[block]
        for lane in range(LANES):
            top[_SUM * LANES + lane] = 0.0
        for g in range(groups):
            c = 4 * UNROLL * g
            t0, d0, a0, b0 = modes[c], modes[c + 1], modes[c + 2], modes[c + 3]
            t1, d1, a1, b1 = modes[c + 4], modes[c + 5], modes[c + 6], modes[c + 7]
            for lane in range(LANES):
                p = top[P * LANES + lane]
                k = g * (2 * UNROLL * LANES) + lane
                y = column[k]
                y0 = fma(a0, p, fma(t0, y, column[k + LANES]))
                column[k + LANES] = fma(b0, p, -d0 * y)
                column[k] = y0
                y = column[k + 2 * LANES]
                y1 = fma(a1, p, fma(t1, y, column[k + 3 * LANES]))
                column[k + 3 * LANES] = fma(b1, p, -d1 * y)
                column[k + 2 * LANES] = y1
                top[_SUM * LANES + lane] += y0 + y1
        for lane in range(LANES):
            free, x1 = top[_SUM * LANES + lane], top[X1 * LANES + lane]
            p = fma(then_2, top[X2 * LANES + lane], fma(now, free, then_1 * x1))
            top[P * LANES + lane] = p
            top[X2 * LANES + lane] = x1
            top[X1 * LANES + lane] = reply * free


@kernel
def _load(tangents, w, head):
    """Load the columns (k, c) of one row into lanes; spare lanes and modes are zero."""
    m = (tangents.shape[0] + 1 - SHARED) // 2
    w[:] = 0.0
    head[:] = 0.0
    for c in range(tangents.shape[1]):
        block, lane = c // LANES, c % LANES
        for i in range(m):
            w[block, 2 * i * LANES + lane] = tangents[i, c]
            w[block, (2 * i + 1) * LANES + lane] = tangents[m + i, c]
        for slot in (P, X1, X2):
            head[block, slot * LANES + lane] = tangents[2 * m + slot, c]


@kernel
def _store(w, head, tangents):
    """Store lanes back into their columns."""
    m = (tangents.shape[0] + 1 - SHARED) // 2
    for c in range(tangents.shape[1]):
        block, lane = c // LANES, c % LANES
        for i in range(m):
            tangents[i, c] = w[block, 2 * i * LANES + lane]
            tangents[m + i, c] = w[block, (2 * i + 1) * LANES + lane]
        for slot in (P, X1, X2):
            tangents[2 * m + slot, c] = head[block, slot * LANES + lane]


@kernel
def _carry(modes, sigma, state, gaps, trace, tangents, packed, w, head):
    m = modes.shape[2]
    for row in range(trace.shape[0]):
        for i in range(m):
            for j in range(4):
                packed[4 * i + j] = modes[row, j, i]
        _load(tangents[row], w, head)
        x1 = state[row, 2 * m + X1]
        for s in range(trace.shape[1]):
            x = trace[row, s]
            _step(packed, w, head, _linearise(x, x1, gaps[row, 0], gaps[row, 1], sigma[row]))
            x1 = x
        _store(w, head, tangents[row])


def carry(system: System, state: Array, gaps: Array, trace: Array, tangents: Array) -> None:
    """Carry tangents of n beams along known traces of their tips.

    Parameters
    ----------
    system : System
    state : ndarray, shape (n, 2 m + 4)
        At the start of the traces.
    gaps : ndarray, shape (n, 2)
        Constant.
    trace : ndarray, shape (n, steps)
        Tip displacement at every step, as recorded by `models.beam.lanes.advance`.
    tangents : ndarray, shape (n, 2 m + 3, c)
        c changes of the state without its clock; updated in place.
    """
    m = system.modes.shape[2]
    blocks = -(-tangents.shape[2] // LANES)
    modes = padded(m)
    _carry(
        system.modes,
        system.sigma,
        state,
        gaps,
        trace,
        tangents,
        np.zeros(4 * modes),
        aligned(blocks * modes * 2 * LANES).reshape(blocks, -1),
        aligned(blocks * _HEAD * LANES).reshape(blocks, -1),
    )
