"""The motion of n rigid machines at equal steps."""

import numpy as np

from models.numerics.blocks import LANES, aligned, copy
from models.numerics.jit import kernel, spliced
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


@spliced
def disphasing(c, at, time, steps, mean, ripple, work):
    """Find the disphasing angles of all lanes as means over some time.

    Parameters
    ----------
    c : ndarray
        Constants of the machines, in lanes.
    at : ndarray, shape (STATE * LANES,)
    time : ndarray, shape (LANES,)
        [s]
    steps : int
        In that time.
    mean, ripple : ndarray, shape (LANES,)
        Set to the means over the steps, and the largest deviations from them [rad].
    work : tuple of ndarray
        Rooms for motion, steps, and the smallest and largest angles.
    """
    w, h, low, high = work
    for lane in range(LANES):
        h[lane] = time[lane] / steps
    prepare(c, h, w)
    copy(at, w[AT.position : AT.position + STATE * LANES])
    mean[:], low[:], high[:] = 0.0, np.inf, -np.inf
    for _ in range(steps):
        step_5(w)
        for lane in range(LANES):
            angle = w[_PSI_1 + lane] - w[_PSI_2 + lane]
            mean[lane] += angle
            low[lane] = angle if angle < low[lane] else low[lane]
            high[lane] = angle if angle > high[lane] else high[lane]
    for lane in range(LANES):
        mean[lane] /= steps
        over, under = high[lane] - mean[lane], mean[lane] - low[lane]
        ripple[lane] = over if over > under else under
