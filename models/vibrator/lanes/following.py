"""The motion of n rigid machines at equal steps."""

import numpy as np

from models.numerics.blocks import LANES, aligned
from models.numerics.jit import kernel
from models.vibrator.lanes.packed import CONSTANTS, STATE, Array, load, store
from models.vibrator.lanes.steps import AT, SIZE, prepare, step_5

_PSI_1, _PSI_2 = (AT.position + i * LANES for i in (3, 4))


@kernel
def _follow(constants, start, h, trace, work):
    c, w, step_size = work
    y = w[AT.position : AT.position + STATE * LANES]
    for first in range(0, start.shape[0], LANES):
        load(constants, first, c)
        load(h, first, step_size)
        load(start, first, y)
        prepare(c, step_size, w)
        for step in range(trace.shape[1]):
            step_5(w)
            store(y, first, trace[:, step])


def follow(constants: Array, state: Array, time: Array, steps: int) -> Array:
    """Return the states of n machines after each of some equal steps.

    Parameters
    ----------
    constants : ndarray, shape (n, CONSTANTS)
    state : ndarray, shape (n, 10)
    time : ndarray, shape (n,)
        Of all steps [s].
    steps : int

    Returns
    -------
    ndarray, shape (n, steps, 10)
    """
    trace = np.empty((len(state), steps, STATE))
    work = aligned(CONSTANTS * LANES), aligned(SIZE), aligned(LANES)
    _follow(constants, state, (time / steps)[:, None], trace, work)
    return trace


@kernel
def _measure(constants, start, h, steps, mean, ripple, work):
    c, w, step_size, total, low, high = work
    y = w[AT.position : AT.position + STATE * LANES]
    for first in range(0, start.shape[0], LANES):
        load(constants, first, c)
        load(h, first, step_size)
        load(start, first, y)
        prepare(c, step_size, w)
        total[:], low[:], high[:] = 0.0, np.inf, -np.inf
        for _ in range(steps):
            step_5(w)
            for lane in range(LANES):
                angle = w[_PSI_1 + lane] - w[_PSI_2 + lane]
                total[lane] += angle
                low[lane] = angle if angle < low[lane] else low[lane]
                high[lane] = angle if angle > high[lane] else high[lane]
        for n in range(first, min(first + LANES, start.shape[0])):
            lane = n - first
            mean[n] = total[lane] / steps
            ripple[n] = max(high[lane] - mean[n], mean[n] - low[lane])


def disphasing(constants: Array, state: Array, time: Array, steps: int) -> tuple[Array, Array]:
    """Return the disphasing angles of n machines as means over some time.

    Parameters
    ----------
    constants, state, time, steps
        As in `follow`.

    Returns
    -------
    mean, ripple : ndarray, shape (n,)
        Mean over the steps, and the largest deviation from it [rad].
    """
    mean, ripple = np.empty((2, len(state)))
    work = (
        aligned(CONSTANTS * LANES),
        aligned(SIZE),
        aligned(LANES),
        aligned(LANES),
        aligned(LANES),
        aligned(LANES),
    )
    _measure(constants, state, (time / steps)[:, None], steps, mean, ripple, work)
    return mean, ripple
